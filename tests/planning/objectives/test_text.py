import pytest
import torch
from torch import Generator
from torch.nn.functional import cosine_similarity

from maulstick.errors import InputError
from maulstick.planning.features.views import random_views, through
from maulstick.planning.objectives import TextMatch
from tests.support.planning.tiny_network import TinyNetwork, check_gradient, noise
from tests.support.tolerances import FLOAT32_VALUE

PAPER = torch.ones(3)
VIEWS = random_views(4, 30, 40, Generator().manual_seed(0))
CANVAS = noise(1, 3, 30, 40)


def test_it_is_one_minus_the_cosine_of_what_is_seen_and_said() -> None:
    network = TinyNetwork()
    network_loss = TextMatch(network, "a cat", VIEWS, PAPER)
    assert (network_loss.name, network_loss.views) == ("text", 4)
    _, seen = network.features(through(CANVAS, VIEWS[[3, 1]], network.side, PAPER))
    wanted = 1 - cosine_similarity(seen, network.embed_text(["a cat"]))
    assert torch.allclose(network_loss.losses(CANVAS, [3, 1]), wanted, atol=FLOAT32_VALUE)
    other = TextMatch(network, "a sailing boat", VIEWS, PAPER)
    assert not torch.allclose(other.losses(CANVAS, [3, 1]), wanted, atol=0.01)


def test_going_down_its_gradient_brings_the_canvas_nearer_to_the_words() -> None:
    network_loss, canvas = TextMatch(TinyNetwork(), "a cat", VIEWS, PAPER), CANVAS.clone()
    losses = []
    for _ in range(20):
        canvas.requires_grad_()
        loss = network_loss.losses(canvas, range(4)).mean()
        (gradient,) = torch.autograd.grad(loss, canvas)
        canvas = (canvas.detach() - 0.02 * gradient.sign()).clamp(0, 1)
        losses.append(loss.item())
    assert losses[-1] < losses[0] - 0.1


def test_only_the_canvas_is_looked_at_and_differentiated() -> None:
    network = TinyNetwork()
    network_loss = TextMatch(network, "a cat", VIEWS, PAPER)
    assert not network_loss.losses(CANVAS, [0, 1]).requires_grad
    assert network.shown == 2
    check_gradient(lambda canvas: network_loss.losses(canvas, [2, 0]).sum(), CANVAS)


@pytest.mark.parametrize("text", ["", " \n"])
def test_an_empty_text_is_refused(text: str) -> None:
    with pytest.raises(
        InputError, match=r"^the text is empty; say what the painting should show, as in 'a sailing boat'$"
    ):
        TextMatch(TinyNetwork(), text, VIEWS, PAPER)
