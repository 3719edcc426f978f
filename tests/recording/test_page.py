import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from maulstick.errors import InputError
from maulstick.recording.files.page import Page, on_sheet
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import Strokes
from maulstick.style.hand import Hand

LINE = np.array([[10.0, 100.0, 50.0, 0.5], [11.0, 300.0, 150.0, 0.75]])  # 200 by 100 units


def page(unit: float | None = None, size: tuple[float, float] | None = None, line: NDArray[np.float64] = LINE) -> Page:
    return Page([line], unit, size, "test")


def ends(page: Page, size: tuple[float, float] | None = None, longest: float | None = None) -> list[list[float]]:
    """The sheet and the two ends of the line in millimetres."""
    ink = on_sheet(page, size, longest, "a test")
    assert ink.source == "a test"
    mm = np.round(1e3 * np.vstack([ink.size, ink.samples[:, 1:3]]), 6)
    return [list(row) for row in mm.tolist()]


def test_a_drawing_of_unknown_scale_is_150_mm_on_its_longer_side_with_a_twentieth_as_margin() -> None:
    assert ends(page()) == [[165, 90], [7.5, 7.5], [157.5, 82.5]]


def test_a_drawing_of_known_scale_keeps_its_size() -> None:
    assert ends(page(unit=1e-4)) == [[22, 12], [1, 1], [21, 11]]


def test_a_page_that_the_file_has_is_the_sheet() -> None:
    assert ends(page(unit=1e-4, size=(400, 300))) == [[40, 30], [10, 5], [30, 15]]
    assert ends(page(size=(400, 300))) == [[300, 225], [75, 37.5], [225, 112.5]]


@pytest.mark.parametrize("unit", [None, 1e-4])
def test_the_longer_side_of_the_drawing_is_as_long_as_asked_for(unit: float | None) -> None:
    assert ends(page(unit), longest=0.1) == [[110, 60], [5, 5], [105, 55]]
    assert ends(page(unit, size=(400, 300)), longest=0.1) == [[200, 150], [50, 25], [150, 75]]


@pytest.mark.parametrize("unit", [None, 1e-4])
def test_a_page_fills_the_sheet_asked_for_without_being_distorted(unit: float | None) -> None:
    assert ends(page(unit), size=(0.22, 0.2)) == [[220, 200], [10, 50], [210, 150]]
    assert ends(page(unit, size=(400, 300)), size=(0.08, 0.03)) == [[80, 30], [30, 5], [50, 15]]


@pytest.mark.parametrize("unit", [None, 1e-4])
def test_a_single_dot_lies_in_the_middle_of_a_small_sheet(unit: float | None) -> None:
    dot = page(unit, line=LINE[:1])
    assert ends(dot) == ends(dot, longest=0.1) == [[10, 10], [5, 5]]
    assert ends(dot, size=(0.2, 0.1)) == [[200, 100], [100, 50]]


def test_a_single_dot_on_a_known_page_keeps_its_place_whatever_length_is_asked_for() -> None:
    dot = page(1e-4, size=(400, 300), line=LINE[:1])
    assert ends(dot) == ends(dot, longest=0.1) == [[40, 30], [10, 5]]


def test_times_begin_at_zero_and_empty_strokes_are_none() -> None:
    strokes = [LINE, np.zeros((0, 4)), LINE - [4, 0, 0, 0], LINE * [np.nan, 1, 1, np.nan]]
    ink = on_sheet(Page(strokes, None, None, "test"), None, None, "")
    assert ink.lengths.tolist() == [2, 2, 2]
    assert np.array_equal(ink.samples[:, 0], [4, 5, 0, 1, np.nan, np.nan], equal_nan=True)


def test_times_of_a_clock_that_stands_still_within_every_stroke_are_none() -> None:
    still, later = (np.column_stack([np.full(2, t), LINE[:, 1:]]) for t in (0.0, 3.0))
    ink = on_sheet(Page([still, later, later[:1]], 1e-4, None, "test"), None, None, "a test")
    assert np.isnan(ink.samples[:, 0]).all()
    assert on_sheet(Page([still, LINE], 1e-4, None, "test"), None, None, "").samples[:, 0].tolist() == [0, 0.5, 10, 11]


@pytest.mark.parametrize("times", [[0, np.nan], [np.nan, 2]])
def test_times_that_are_known_of_some_samples_are_refused_also_of_a_lone_stroke(times: list[float]) -> None:
    with pytest.raises(InputError, match="the times of a stroke must be"):
        on_sheet(Page([np.column_stack([times, LINE[:, 1:]])], 1e-4, None, "test"), None, None, "")


@pytest.mark.parametrize("tick", [0.016, 0.1, 0.5])
def test_a_coarse_clock_hardly_changes_how_fast_a_hand_is(tick: float) -> None:
    rng = np.random.default_rng(0)

    def drawn(tick: float) -> Floats:
        """The speeds of strokes of half a second at 0.1 m/s, seen every 8 ms."""
        rests, along = np.cumsum(rng.uniform(0.6, 1.0, 20)), np.arange(64) * 8e-3
        strokes = [np.column_stack([t + along, 0.1 * along, along, np.full(64, np.nan)]) for t in rests]
        for i, stroke in enumerate(strokes):
            stroke[:, 0] = np.floor(stroke[:, 0] / tick) * tick
            stroke[:, 2] = 0.01 * i
        speeds = Hand.of(Strokes.of(on_sheet(Page(strokes, 1.0, None, "test"), None, None, ""))).speeds
        assert np.isfinite(speeds).all()
        return speeds

    assert np.exp(np.log(drawn(tick)).mean()) == pytest.approx(0.1, rel=0.2)
    assert drawn(tick).max() < 0.5


def test_samples_of_one_time_are_spread_up_to_the_next_and_falling_times_are_refused() -> None:
    def times(*strokes: list[float]) -> list[float]:
        made = [np.column_stack([t, np.arange(len(t)), np.arange(len(t)), np.full(len(t), np.nan)]) for t in strokes]
        spread: list[float] = on_sheet(Page(made, 1e-3, None, "test"), None, None, "").samples[:, 0].tolist()
        return spread

    assert times([0, 0, 2, 2, 4]) == [0, 1, 2, 3, 4]
    assert times([1, 2, 3, 3, 3]) == pytest.approx([0, 0.5, 1.5, 2, 2.5])
    assert times([0, 1, 2], [5, 5]) == pytest.approx([0, 1, 2, 5, 5 + 2 / 3])
    assert times([0, 1, 2, 3, 4, 5, 5]) == [0, 1, 2, 3, 4, 5, 5], "a fine clock may tell a time twice"
    with pytest.raises(InputError, match="the times of a stroke run backwards"):
        times([0, 0, 2, 1])


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e3))
def test_neither_where_a_drawing_lay_nor_its_unit_matters_where_no_scale_is_known(offset: float, scale: float) -> None:
    moved = LINE * [1, scale, scale, 1] + [0, offset * scale, -offset * scale, 0]
    assert on_sheet(page(line=moved), None, None, "").samples == pytest.approx(
        on_sheet(page(), None, None, "").samples, abs=1e-9
    )


@pytest.mark.parametrize("place", [np.nan, np.inf, -np.inf, 1e13])
def test_a_sample_at_no_place_is_refused(place: float) -> None:
    with pytest.raises(InputError, match="a sample has no place: its x or y is no number, or too large"):
        on_sheet(page(line=LINE + np.array([0, 0, place, 0])), None, None, "")


def test_nothing_and_too_much_are_refused() -> None:
    with pytest.raises(InputError, match="there are no strokes in it"):
        on_sheet(Page([], None, None, "test"), None, None, "")
    endless = np.broadcast_to(LINE[:1], (5_000_001, 4))
    with pytest.raises(InputError, match="it has 5000001 samples; 5000000 are the most that a drawing may have"):
        on_sheet(page(line=endless), None, None, "")


def test_a_drawing_larger_than_any_sheet_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"the sheet of the ink is \(220\.0, 120\.0\) m; it must be between 0 and 100 m"
    ):
        on_sheet(page(unit=1.0), None, None, "")
