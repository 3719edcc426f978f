import pytest
import torch
from skimage.data import astronaut, brick, grass
from torch import Generator, Tensor

from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.views import random_views, whole
from maulstick.planning.objectives import Look
from maulstick.planning.objectives.look import _chosen
from tests.support.planning.tiny_network import TinyNetwork, check_gradient, noise

PAPER = torch.ones(3)
VIEWS = torch.cat([whole(40, 40), random_views(4, 40, 40, Generator().manual_seed(0))])
PICTURE, CANVAS = noise(0, 3, 40, 40), noise(1, 3, 40, 40)


def tiny(picture: Tensor = PICTURE, network: TinyNetwork | None = None, seed: int = 0) -> Look:
    return Look(network or TinyNetwork(), picture, VIEWS, PAPER, Generator().manual_seed(seed))


def test_the_picture_itself_costs_nothing() -> None:
    network_loss = tiny()
    assert (network_loss.name, network_loss.views) == ("look", 5)
    assert network_loss.losses(PICTURE.clone(), [0]).item() == pytest.approx(0, abs=1e-12)
    assert network_loss.losses(CANVAS, [0]).item() > 0.01


def test_where_things_are_does_not_matter() -> None:
    """Turned by a quarter, places change and features of a network that knows no direction do not."""
    network = TinyNetwork()
    for layer in network._layers.children():
        layer.weight.data = layer.weight.data.mean(dim=(2, 3), keepdim=True).expand_as(layer.weight).clone()
    network_loss = tiny(network=network)
    turned = PICTURE.rot90(1, (1, 2))
    assert network_loss.losses(turned, [0]).item() < 0.1 * network_loss.losses(1 - PICTURE, [0]).item()


def test_the_distance_of_two_crowds_is_what_the_paper_says() -> None:
    """Constant canvases: every place has the same features, so all distances are plain."""
    network = TinyNetwork()
    black, white = torch.zeros(3, 48, 48).double(), torch.ones(3, 48, 48).double()
    loss = Look(network, black, VIEWS, PAPER, Generator()).losses(white, [0]).item()
    (maps, _), (wanted_maps, _) = (network.features(x[None, :, :24, :24]) for x in (white, black))
    wanted = 0.0
    for layer, wanted_layer in zip(maps, wanted_maps, strict=True):
        a, b = layer[0, :, 1, 1], wanted_layer[0, :, 1, 1]
        scale = b.square().mean().sqrt()
        wanted += 1 - torch.cosine_similarity(a, b, dim=0).item() + ((a - b) / scale).abs().mean().item()
    assert loss == pytest.approx(wanted / 2)


def test_it_counts_what_is_missing_and_what_is_too_much() -> None:
    half = torch.ones(3, 40, 40).double()
    half[:, :20] = 0
    white, black = torch.ones_like(half), torch.zeros_like(half)
    for canvas in (white, black):
        assert tiny(half).losses(canvas, [0]).item() > 0.1
        assert tiny(canvas).losses(half, [0]).item() > 0.1


def test_the_picture_is_looked_at_once_and_only_when_asked() -> None:
    network = TinyNetwork()
    network_loss = tiny(noise(0, 3, 40, 70), network)
    assert network.shown == 0
    network_loss.losses(CANVAS, [0, 1])
    assert network.shown == 4, "two squares of the picture, two views of the canvas"
    network_loss.losses(CANVAS, [2, 3])
    assert network.shown == 6


def test_the_same_places_are_looked_at_for_good_whatever_is_asked_before() -> None:
    first, second = tiny(), tiny()
    second.losses(CANVAS, [4, 3])
    assert torch.equal(first.losses(CANVAS, [1, 2]), second.losses(CANVAS, [1, 2]))
    assert torch.equal(first.losses(CANVAS, [1, 2]), second.losses(CANVAS, [1, 2]))


def test_at_most_512_places_are_chosen_at_random_and_all_are_on_the_canvas() -> None:
    view = whole(50, 100)
    numbers = torch.arange(64.0 * 64).reshape(1, 1, 64, 64)
    chosen = _chosen(numbers, view, 0)[:, 0]
    assert len(chosen) == chosen.unique().numel() == 512
    rows = chosen // 64
    assert (rows >= 16).all()
    assert (rows < 48).all()
    assert torch.equal(chosen, _chosen(numbers, view, 0)[:, 0])
    assert not torch.equal(chosen, _chosen(numbers, view, 1)[:, 0])


def test_of_a_canvas_that_is_narrower_than_any_place_the_nearest_are_looked_at() -> None:
    chosen = _chosen(torch.arange(16.0).reshape(1, 1, 4, 4), whole(1, 1000), 0)[:, 0]
    assert set(chosen.tolist()) == {4.0, 5, 6, 7, 8, 9, 10, 11}


def test_nothing_but_the_canvas_is_differentiated() -> None:
    network_loss = tiny(PICTURE.clone().requires_grad_())
    assert not network_loss.losses(CANVAS, [0, 1]).requires_grad
    check_gradient(lambda canvas: network_loss.losses(canvas, [0, 3]).sum(), CANVAS, step=1e-6)


def test_a_real_network_tells_the_look_of_grass_from_that_of_bricks() -> None:
    textures = [torch.from_numpy(x()).expand(3, -1, -1) / 255 for x in (grass, brick)]
    face = torch.from_numpy(astronaut()).permute(2, 0, 1) / 255
    network, view = EfficientNetLite0(), whole(256, 256)
    for kind, (picture, other) in enumerate([textures, textures[::-1]]):
        network_loss = Look(
            network, picture[:, :256, :256], view, PAPER, Generator().manual_seed(kind), layers=[1, 2, 3]
        )
        same, different, portrait, blank = (
            network_loss.losses(canvas[:, -256:, -256:], [0]).item()
            for canvas in (picture, other, face, torch.ones_like(picture))
        )
        assert same < 0.8 * different
        assert same < 0.8 * portrait
        assert portrait < blank
