"""Joints of a drawing's lines: laps where strokes go on beside each other, and gaps between them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import resample
from maulstick.style.arrangement.joints import laps_of
from maulstick.style.hand import Hand
from tests.support.drawn import as_strokes, hatching

LENGTH = 0.02  # metres


def level(start: float, length: float = 1.0, *, aside: float = 0.0, turn: float = 0.0) -> Floats:
    """A stroke from the left to the right, in lengths."""
    along = np.linspace(0, length, 32)
    path = np.stack([start + np.cos(turn) * along, aside + np.sin(turn) * along], axis=1)
    return LENGTH * path


def chain(step: float, count: int = 6, aside: float = 0.0) -> Floats:
    """Strokes of one line, each so far beyond the one before."""
    return np.stack([level(step * i, aside=aside * (i % 2)) for i in range(count)])


@pytest.mark.parametrize("lap", [0.05, 0.3, 0.45, -0.1, -0.35])
def test_strokes_of_a_line_lap_or_leave_gaps_as_they_were_drawn(lap: float) -> None:
    laps = laps_of(chain(1 - lap))
    assert laps == pytest.approx(np.full(10, lap), abs=0.01), "ten ends of six strokes: the first and the last are free"


def test_a_stroke_that_lies_beside_a_longer_one_laps_most_of_it_and_once() -> None:
    two_in_one = np.stack([level(0.3), level(1.7), level(0, 3, aside=0.03)])
    assert laps_of(two_in_one) == pytest.approx([0.8, 0.8])


def test_what_comes_in_from_the_side_laps_as_far_as_it_lies_along_the_other() -> None:
    bend = resample(LENGTH * np.array([[0, 0.75], [0, 0], [0.25, 0]]), 32)
    drawn = np.stack([bend, bend + LENGTH * np.array([1.0, 0]), level(-0.5, 3)])
    assert laps_of(drawn) == pytest.approx([0.3, 0.3], abs=0.07)


def test_gaps_are_as_wide_beside_a_short_stroke_as_beside_a_long_one() -> None:
    drawn = np.stack([level(0), level(1.25, 0.3), level(1.8), level(3.05, 0.3), level(3.6)])
    assert laps_of(drawn) == pytest.approx(np.full(8, -0.25), abs=1e-6)


def test_few_joints_among_many_strokes_say_nothing() -> None:
    apart = np.stack([level(0, aside=3.0 + i) for i in range(14)])
    assert len(laps_of(np.concatenate([chain(0.7), apart[:10]]))) == 10
    assert len(laps_of(np.concatenate([chain(0.7), apart]))) == 0


def test_strokes_that_end_together_go_on_nowhere() -> None:
    assert laps_of(np.stack([level(0), level(0, aside=0.03)])).size == 0


@pytest.mark.parametrize(
    "other",
    [level(1, turn=np.pi / 2), level(1.01, turn=0.7), level(0.5, aside=0.2), level(1.7), level(2, aside=1)],
    ids=["square to it", "oblique", "beside it, apart", "far ahead", "elsewhere"],
)
def test_what_is_another_line_has_no_joint(other: Floats) -> None:
    assert laps_of(np.stack([level(0), other])).size == 0


def test_of_several_that_go_on_the_nearest_counts() -> None:
    both = np.stack([level(0), level(0.6, aside=0.02), level(0.9, aside=-0.06)])
    assert laps_of(both)[:1] == pytest.approx([0.4], abs=0.01)


@given(st.floats(-3, 3), st.floats(0.05, 20), st.lists(st.booleans(), min_size=6, max_size=6))
def test_laps_are_the_same_turned_enlarged_and_drawn_backwards(angle: float, times: float, back: list[bool]) -> None:
    drawn = chain(0.7, aside=0.02)
    turned = np.stack([path[::-1] if flip else path for path, flip in zip(drawn, back, strict=True)])
    x, y = times * np.moveaxis(turned, 2, 0)
    turned = np.stack([np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y], axis=-1)
    assert np.sort(laps_of(turned)) == pytest.approx(np.sort(laps_of(drawn)), abs=1e-6)


def test_strokes_of_a_bent_line_lap_along_the_bend() -> None:
    angles = 0.35 * np.arange(6)[:, None] + np.linspace(0, 0.5, 32)
    ring = LENGTH * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    assert laps_of(ring) == pytest.approx(np.full(10, 0.3), abs=0.02)


def test_dots_have_no_joints_and_neither_has_hatching() -> None:
    dots = np.repeat(LENGTH * np.random.default_rng(0).random((40, 1, 2)), 32, axis=1)
    assert laps_of(dots).size == 0
    assert laps_of(np.concatenate([chain(0.8), dots[:4]])) == pytest.approx(np.full(10, 0.2), abs=0.01)
    arrangement = Hand.of(as_strokes(hatching(6, seed=0))).arrangement
    assert arrangement is not None
    assert arrangement.laps.size == 0
