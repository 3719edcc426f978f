import pytest
import torch
from skimage.data import astronaut, chelsea
from torch import Generator, Tensor
from torch.nn.functional import avg_pool2d, cosine_similarity, interpolate

from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.views import random_views, through, whole
from maulstick.planning.objectives import Likeness, sketch
from tests.support.planning.tiny_network import TinyNetwork, check_gradient, noise
from tests.support.tolerances import FLOAT32_VALUE

PAPER = torch.ones(3)
VIEWS = torch.cat([whole(30, 40), random_views(5, 30, 40, Generator().manual_seed(0))])
TARGET, CANVAS = noise(0, 3, 30, 40), noise(1, 3, 30, 40)


def tiny(target: Tensor = TARGET, **options: object) -> Likeness:
    return Likeness(TinyNetwork(), target, VIEWS, PAPER, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("grey", [False, True])
def test_the_picture_itself_costs_nothing_in_any_view(grey: bool) -> None:
    network_loss = tiny(grey=grey)
    assert (network_loss.name, network_loss.views) == ("likeness", 6)
    assert network_loss.losses(TARGET.clone(), range(6)).tolist() == pytest.approx([0] * 6, abs=FLOAT32_VALUE)
    assert (network_loss.losses(CANVAS, range(6)) > 0.01).all()


def test_it_is_one_minus_the_cosine_of_every_place_and_of_the_embedding() -> None:
    network = TinyNetwork()
    seen, wanted = (network.features(through(x, VIEWS[[3]], network.side, PAPER)) for x in (CANVAS, TARGET))
    places = [1 - cosine_similarity(a, b).mean().item() for a, b in zip(seen[0], wanted[0], strict=True)]
    meaning = 1 - cosine_similarity(seen[1], wanted[1]).item()
    assert tiny().losses(CANVAS, [3]).item() == pytest.approx(sum(places) / 2 + 0.1 * meaning)
    assert tiny(layers=[1], semantics=0.0).losses(CANVAS, [3]).item() == pytest.approx(places[1])
    assert tiny(layers=[-2], semantics=2.0).losses(CANVAS, [3]).item() == pytest.approx(places[0] + 2 * meaning)
    assert tiny(layers=[], semantics=1.0).losses(CANVAS, [3]).item() == pytest.approx(meaning)


def test_each_view_has_a_loss_of_its_own_whatever_it_is_asked_with() -> None:
    network_loss = tiny()
    together = network_loss.losses(CANVAS, range(6))
    assert together.unique().numel() == 6
    for view in range(6):
        assert torch.allclose(network_loss.losses(CANVAS, [view])[0], together[view])
    assert torch.allclose(network_loss.losses(CANVAS, [4, 1, 4]), together[[4, 1, 4]])


def test_the_target_is_looked_at_once_a_view_and_only_when_asked() -> None:
    network = TinyNetwork()
    network_loss = Likeness(network, TARGET, VIEWS, PAPER)
    assert network.shown == 0
    network_loss.losses(CANVAS, [0, 2])
    assert network.shown == 4
    network_loss.losses(CANVAS, [2, 0])
    assert network.shown == 6
    network_loss.losses(CANVAS, [2, 5])
    assert network.shown == 9


def test_nothing_but_the_canvas_is_differentiated() -> None:
    network_loss = tiny(TARGET.clone().requires_grad_())
    assert not network_loss.losses(CANVAS, [0, 1]).requires_grad
    canvas = CANVAS.clone().requires_grad_()
    network_loss.losses(canvas, [0, 1]).sum().backward()
    assert canvas.grad is not None
    assert (canvas.grad != 0).float().mean() > 0.9


@pytest.mark.parametrize("grey", [False, True])
def test_gradients_are_those_of_finite_differences(grey: bool) -> None:
    network_loss = tiny(grey=grey)
    check_gradient(lambda canvas: network_loss.losses(canvas, [0, 3]).sum(), CANVAS)


def test_seen_in_grey_colour_does_not_matter() -> None:
    grey = torch.einsum("chw,c->hw", TARGET, torch.tensor([0.2126, 0.7152, 0.0722]).double()).expand(3, -1, -1)
    assert (tiny(grey=True).losses(grey, range(6)) < 1e-6).all()
    assert (tiny(grey=False).losses(grey, range(6)) > 1e-3).all()


def test_features_that_are_all_0_have_a_gradient() -> None:
    network = TinyNetwork()
    for parameter in network._layers.parameters():
        parameter.data.zero_()
    canvas = CANVAS.clone().requires_grad_()
    loss = Likeness(network, TARGET, VIEWS, PAPER).losses(canvas, [0])
    loss.sum().backward()
    assert loss.item() == 0
    assert canvas.grad is not None
    assert torch.isfinite(canvas.grad).all()


def test_a_sketch_asks_deep_layers_and_the_embedding() -> None:
    network = TinyNetwork()
    network_loss = sketch(network, TARGET, VIEWS, PAPER)
    assert network_loss.name == "sketch"
    assert torch.equal(network_loss.losses(CANVAS, [1]), tiny(layers=[0, 1], semantics=1.0).losses(CANVAS, [1]))
    assert network_loss.losses(TARGET, [1, 2]).max().item() < 1e-12


def square(photograph: Tensor) -> Tensor:
    """Return a photograph scaled to (3, 128, 128)."""
    return interpolate(photograph[None], size=(128, 128), mode="bilinear", antialias=True)[0]


def test_a_real_network_ranks_canvases_as_a_person_would() -> None:
    target = square(torch.from_numpy(astronaut()).permute(2, 0, 1) / 255)
    cat = square(torch.from_numpy(chelsea()).permute(2, 0, 1) / 255)
    tiles = target.unfold(1, 16, 16).unfold(2, 16, 16).flatten(1, 2)[:, torch.randperm(64, generator=Generator())]
    shuffled = tiles.unflatten(1, (8, 8)).permute(0, 1, 3, 2, 4).reshape(3, 128, 128)
    rough = interpolate(avg_pool2d(target[None], 4), scale_factor=4.0, mode="bilinear")[0]
    views = torch.cat([whole(128, 128), random_views(1, 128, 128, Generator().manual_seed(0))])
    network = EfficientNetLite0()
    for network_loss in (Likeness(network, target, views, PAPER), sketch(network, target, views, PAPER)):
        same, near, mixed, other, blank = (
            network_loss.losses(canvas, [0, 1]).mean().item()
            for canvas in (target, rough, shuffled, cat, torch.ones_like(target))
        )
        assert same == pytest.approx(0, abs=FLOAT32_VALUE)
        assert near < 0.8 * mixed
        assert mixed < blank
        assert near < 0.8 * other
        assert other < blank
