"""Separation of images into inks."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import nnls

from maulstick.planning.problem import Colour
from maulstick.planning.separation import separated
from maulstick.storage.arrays import Floats

BLACK, RED, BLUE, YELLOW = (0.0, 0.0, 0.0), (0.8, 0.1, 0.1), (0.1, 0.2, 0.7), (0.95, 0.85, 0.2)
SHARES = st.floats(0, 1)


def image_of(*colours: Colour) -> torch.Tensor:
    """One row of pixels of these colours, (3, 1, n)."""
    return torch.tensor(colours, dtype=torch.float64).T[:, None]


def shares(colour: Colour, inks: tuple[Colour, ...], paper: Colour = (1.0, 1.0, 1.0)) -> Floats:
    found: Floats = separated(image_of(colour), image_of(paper), inks)[:, 0, 0].numpy()
    return found


def mixed(amounts: Floats, inks: tuple[Colour, ...], paper: Colour = (1.0, 1.0, 1.0)) -> Colour:
    red, green, blue = (np.array(paper) + amounts @ (np.array(inks) - np.array(paper))).tolist()
    return red, green, blue


def test_one_ink_is_asked_for_by_how_far_a_tone_lies_from_paper_to_ink() -> None:
    paper, image = torch.full((3, 1, 5), 0.9), torch.tensor([0.9, 0.5, 0.1, 0.0, 1.0]).expand(3, 1, 5)
    assert separated(image, paper, [(0.1, 0.1, 0.1)])[0, 0].tolist() == pytest.approx([0, 0.5, 1, 1, 0], abs=1e-6)
    red = (0.9, 0.1, 0.1)
    assert not separated(paper, paper, [red]).any()
    assert separated(torch.tensor(red)[:, None, None].expand(3, 1, 5), paper, [red]).numpy() == pytest.approx(1)
    assert not separated(image, paper, [(0.9, 0.9, 0.9)]).any(), "an ink like the paper"


@given(st.tuples(SHARES, SHARES, SHARES), st.sampled_from([(1.0, 1.0, 1.0), (0.9, 0.85, 0.7)]))
def test_what_three_inks_mixed_is_found_in_them_again(amounts: tuple[float, float, float], paper: Colour) -> None:
    drawn, inks = np.array(amounts) / max(1.0, sum(amounts)), (BLACK, RED, BLUE)
    assert shares(mixed(drawn, inks, paper), inks, paper) == pytest.approx(drawn, abs=0.03)


@given(st.tuples(SHARES, SHARES, SHARES))
def test_colours_that_inks_cannot_mix_are_as_near_as_they_can_be(colour: Colour) -> None:
    inks = (BLACK, RED, YELLOW)
    towards = np.array(inks).T - 1
    heavy = 1e3 * np.ones((1, 4))  # of a last ink that is the paper's: all shares are 1 together
    nearest, _ = nnls(np.vstack([np.column_stack([towards, np.zeros(3)]), heavy]), [*(np.array(colour) - 1), 1e3])
    found = shares(colour, inks)
    assert found.min() >= 0
    assert found.sum() <= 1 + 1e-9
    off, least = (np.linalg.norm(towards @ amounts - np.array(colour) + 1) for amounts in (found, nearest[:3]))
    assert off <= least + 0.01


def test_of_all_ways_to_mix_a_grey_the_one_of_few_lines_is_found() -> None:
    cyan, magenta = (0.0, 0.6, 0.8), (0.8, 0.1, 0.5)
    found = shares((0.5, 0.5, 0.5), (cyan, magenta, YELLOW, BLACK))
    assert found[3] > 0.4
    assert found.sum() < 0.6


@pytest.mark.parametrize("inks", [(RED, BLUE, BLACK), (BLACK, BLUE, RED)], ids=["dark last", "dark first"])
def test_the_order_in_which_inks_are_said_does_not_matter(inks: tuple[Colour, ...]) -> None:
    colour = (0.6, 0.4, 0.5)
    by_ink = dict(zip(inks, shares(colour, inks), strict=True))
    assert [by_ink[ink] for ink in (BLACK, BLUE, RED)] == pytest.approx(shares(colour, (BLACK, BLUE, RED)))


def test_on_a_sheet_that_is_painted_on_only_what_is_missing_is_asked_for() -> None:
    image, paper = image_of(RED, RED, BLUE), image_of((1.0, 1.0, 1.0), RED, RED)
    found = separated(image, paper, (RED, BLUE))
    assert found[:, 0].T.tolist() == [pytest.approx(row, abs=0.02) for row in ([1, 0], [0, 0], [0, 1])]


def test_an_image_keeps_its_shape_and_its_kind_of_numbers() -> None:
    image = torch.rand(3, 5, 7)
    found = separated(image, torch.ones(3, 5, 7), (BLACK, RED))
    assert found.shape == (2, 5, 7)
    assert found.dtype == image.dtype
