import re
from collections.abc import Mapping

import numpy as np
import pytest
import torch

from maulstick.errors import InputError
from maulstick.planning.features.network import Network
from maulstick.planning.losses import LossOptions, Reference, losses_of
from maulstick.planning.weights import STRENGTHS
from tests.support.planning.tiny_network import TinyNetwork, noise

PAPER = torch.ones(3)
PICTURE = np.full((20, 30, 3), 0.5, dtype=np.float32)
WITH_PICTURE = Reference(noise(0, 3, 30, 40).float(), torch.ones(30, 40), PAPER, spacing=None)
WITHOUT_PICTURE = Reference(None, torch.ones(30, 40), PAPER, spacing=None)


class SeeingNetwork(Network):
    """A network that cannot read."""

    name, side = "seeing", 24

    def features(self, images: torch.Tensor) -> tuple[list[torch.Tensor], torch.Tensor]:
        return [images], images.mean(dim=(2, 3))


def never() -> Network:
    raise AssertionError("nothing here needs a network")


def names(loss_options: LossOptions, reference: Reference = WITH_PICTURE) -> tuple[list[str], list[str]]:
    objectives, network_losses = losses_of(loss_options, reference, TinyNetwork)
    return [each.term.name for each in objectives], [each.term.name for each in network_losses]


def refused(text: str) -> pytest.RaisesExc[InputError]:
    return pytest.raises(InputError, match=f"^{re.escape(text)}$")


def test_a_picture_alone_is_compared_in_tone_alone() -> None:
    assert LossOptions().weights_of_terms(has_picture=True) == {"tone": 1}
    assert names(LossOptions()) == (["tone"], [])


def test_a_text_or_a_look_beside_a_picture_adds_to_it() -> None:
    assert names(LossOptions("a boat", PICTURE)) == (["tone"], ["text", "look"])


def test_a_text_and_a_look_without_a_picture_are_all_there_is() -> None:
    assert names(LossOptions("a boat"), WITHOUT_PICTURE) == ([], ["text"])
    assert names(LossOptions(look=PICTURE), WITHOUT_PICTURE) == ([], ["look"])


def test_what_weighs_nothing_is_left_out_and_what_weighs_more_counts_more() -> None:
    loss_options = LossOptions(weights={"text": 0, "edges": 3, "sketch": 0.5, "likeness": 0})
    objectives, network_losses = losses_of(loss_options, WITH_PICTURE, TinyNetwork)
    weights = {each.term.name: each.weight for each in (*objectives, *network_losses)}
    assert weights == {
        "tone": STRENGTHS["tone"],
        "edges": 3 * STRENGTHS["edges"],
        "sketch": 0.5 * STRENGTHS["sketch"],
    }


def test_faces_are_a_modifier_and_no_term() -> None:
    assert LossOptions().faces == 1
    without = LossOptions(weights={"faces": 0, "edges": 2})
    assert without.faces == 0
    assert without.weights_of_terms(has_picture=True) == {"tone": 1, "edges": 2}
    assert names(without) == (["tone", "edges"], [])
    assert without.weights_to_keep(has_picture=True) == {"tone": 1, "edges": 2, "faces": 0}
    assert LossOptions().weights_to_keep(has_picture=True) == {"tone": 1}
    with refused("nothing is weighed, so any painting would do; give one of the terms a weight above 0"):
        LossOptions(weights={"faces": 2, "tone": 0}).weights_of_terms(has_picture=True)
    with refused("faces compares with a picture; name one, or leave that weight out"):
        LossOptions("a boat", weights={"faces": 2}).weights_of_terms(has_picture=False)
    with refused("the weight of faces is -1; it must be from 0 to 1000"):
        LossOptions(weights={"faces": -1})


def test_every_term_can_be_asked_for_by_its_name() -> None:
    loss_options = LossOptions("a boat", PICTURE, dict.fromkeys(STRENGTHS, 1.0))
    objectives, network_losses = names(loss_options)
    assert sorted(objectives + network_losses) == sorted(STRENGTHS)


def test_a_network_is_only_called_for_where_a_network_loss_needs_one() -> None:
    objectives, network_losses = losses_of(LossOptions(weights={"likeness": 0, "edges": 1}), WITH_PICTURE, never)
    assert (len(objectives), network_losses) == (2, ())


def test_network_losses_have_the_same_views_whenever_they_are_made() -> None:
    (one,), (two,) = (losses_of(LossOptions("a boat"), WITHOUT_PICTURE, TinyNetwork)[1] for _ in range(2))
    canvas = noise(1, 3, 30, 40).float()
    assert torch.equal(one.term.losses(canvas, range(8)), two.term.losses(canvas, range(8)))
    assert one.term.losses(canvas, range(8)).std() > 0


def test_with_one_ink_colours_are_not_compared() -> None:
    grey = torch.full((3, 30, 40), 0.5)
    shades = grey + torch.tensor([0.2, 0.0, -0.2 * 0.2126 / 0.0722])[:, None, None]  # of the same luma
    for one_ink in (True, False):
        _, (network_loss,) = losses_of(
            LossOptions(weights={"tone": 0, "likeness": 1}),
            Reference(grey, torch.ones(30, 40), PAPER, 2.0, grey=one_ink),
            TinyNetwork,
        )
        assert (network_loss.term.losses(shades, [0]).item() < 1e-6) is one_ink


@pytest.mark.parametrize(
    ("weights", "text"),
    [
        (
            {"beauty": 1.0},
            "there is no term to weigh 'beauty'; there are: edges, faces, likeness, look, sketch, text, tone",
        ),
        ({"": 1.0}, "there is no term to weigh ''; there are: edges, faces, likeness, look, sketch, text, tone"),
        ({"tone": -1.0}, "the weight of tone is -1.0; it must be from 0 to 1000"),
        ({"tone": float("nan")}, "the weight of tone is nan; it must be from 0 to 1000"),
        ({"tone": float("inf")}, "the weight of tone is inf; it must be from 0 to 1000"),
        ({"tone": 1e9}, "the weight of tone is 1000000000.0; it must be from 0 to 1000"),
        ({"text": 2.0}, "text weighs a text, and there is none; give it, or leave the weight out"),
        ({"look": 2.0}, "look weighs the look of a picture, and there is none; give it, or leave the weight out"),
    ],
)
def test_weights_that_cannot_be_used_are_refused(weights: Mapping[str, float], text: str) -> None:
    with refused(text):
        LossOptions(weights=weights)


def test_a_weight_of_nothing_needs_nothing() -> None:
    assert names(LossOptions(weights={"text": 0, "look": 0})) == (["tone"], [])


def test_a_painting_of_which_nothing_is_asked_is_refused() -> None:
    text = "nothing is weighed, so any painting would do; give one of the terms a weight above 0"
    with refused(text):
        LossOptions(weights={"tone": 0, "likeness": 0}).weights_of_terms(has_picture=True)
    with refused(text):
        LossOptions().weights_of_terms(has_picture=False)
    with refused("text=0 leaves a text out, and there is one; leave one of the two out"):
        LossOptions("a boat", weights={"text": 0})
    with refused("look=0 leaves the look of a picture out, and there is one; leave one of the two out"):
        LossOptions(look=PICTURE, weights={"look": 0})


@pytest.mark.parametrize("name", ["tone", "edges", "likeness", "sketch"])
def test_what_compares_with_a_picture_is_refused_without_one(name: str) -> None:
    with refused(f"{name} compares with a picture; name one, or leave that weight out"):
        losses_of(LossOptions("a boat", weights={name: 1}), WITHOUT_PICTURE, TinyNetwork)


def test_a_network_that_cannot_read_is_refused_a_text() -> None:
    with refused("seeing cannot read; a text needs CLIP: name a model with clip"):
        losses_of(LossOptions("a boat"), WITHOUT_PICTURE, SeeingNetwork)
