"""Bare paper: no ink on it, ends and widths of marks included."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from maulstick.painting.brush import Brush, load_brush
from maulstick.painting.raster import Canvas
from maulstick.planning.bare_paper import BarePaper
from maulstick.storage.arrays import Bools, Floats
from maulstick.strokes.refine import refine

SIDE, PX = 0.06, 30


def with_bare(bare: Bools) -> BarePaper:
    """Return a sheet of which those pixels (n, n) are bare."""
    return BarePaper(bare, Canvas(SIDE, SIDE, len(bare) / SIDE))


def band(left: int, right: int, px: int = PX) -> Bools:
    """Return where a band of those columns is, from the upper edge to the lower."""
    bare = np.zeros((px, px), dtype=bool)
    bare[:, left:right] = True
    return bare


def across(begin: float, end: float, points: int = 32) -> Floats:
    """Return a stroke from left to right in the middle of the sheet, between these shares of its width."""
    x = np.linspace(begin, end, points) * SIDE
    return np.stack([x, np.full(points, SIDE / 2), np.full(points, 0.5)], axis=1)


@settings(deadline=None)
@given(st.sampled_from(["fineliner", "marker"]), st.floats(0, 0.3), st.floats(0.7, 1))
@example("fineliner", 0.26, 0.74)
@example("fineliner", 0.2, 0.77)
@example("fineliner", 0.29, 0.83)
def test_a_stroke_across_bare_paper_is_on_it(name: str, begin: float, end: float) -> None:
    assert not with_bare(band(12, 18)).is_off(across(begin, end), load_brush(name))


def test_the_middle_of_bare_paper_is_on_it_though_no_side_is_nearer() -> None:
    paper = with_bare(band(1001, 1002, px=2000))
    assert not paper.is_off(across(1001 / 2000, 1002 / 2000), load_brush("fineliner"))


@pytest.mark.parametrize("name", ["fineliner", "marker"])
def test_a_stroke_that_reaches_onto_bare_paper_is_moved_off_it(name: str) -> None:
    paper, brush = with_bare(band(15, 30)), load_brush(name)
    stroke = across(0.1, 0.55)
    assert not paper.is_off(stroke, brush)
    (kept,) = paper.kept_off(stroke[None], brush)
    assert paper.is_off(kept, brush)
    assert np.ptp(kept[:, :2] - stroke[:, :2], axis=0) == pytest.approx([0, 0], abs=1e-9)


@pytest.mark.parametrize("points", [2, 4, 32])
def test_a_thin_stroke_does_not_jump_bare_paper_between_its_points(points: int) -> None:
    paper, brush = with_bare(band(100, 101, px=200)), load_brush("fineliner")
    stroke = across(0.02, 0.985, points)
    assert (np.abs(stroke[:, 0] - SIDE * 100.5 / 200) > 2 * brush.widest).all()
    assert not paper.is_off(stroke, brush)
    assert paper.is_off(across(0.02, 0.48, points), brush)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["fineliner", "marker"]), st.integers(2, 6))
def test_what_is_off_bare_paper_has_no_dot_on_it(seed: int, name: str, points: int) -> None:
    rng, brush = np.random.default_rng(seed), load_brush(name)
    bare = rng.random((PX, PX)) < rng.uniform(0, 0.1)
    bare[0, 0] = False
    paper = with_bare(bare)
    strokes = rng.uniform(0, 1, (8, 1, 3)) * (SIDE, SIDE, 1) + rng.normal(0, 0.003, (8, points, 3)) * (1, 1, 0)
    for stroke in paper.kept_off(strokes, brush):
        if paper.is_off(stroke, brush):
            assert _gap(stroke, brush, bare) >= 0


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["fineliner", "marker"]), st.integers(1, 6))
def test_a_line_is_cut_at_bare_paper_and_no_part_of_it_lies_there(seed: int, name: str, points: int) -> None:
    rng, brush = np.random.default_rng(seed), load_brush(name)
    bare = rng.random((PX, PX)) < rng.uniform(0, 0.1)
    paper, line = with_bare(bare), rng.uniform(0, 1, (points, 3)) * (SIDE, SIDE, 0) + (0, 0, 0.5)
    for part in paper.parts_off(line, brush):
        assert paper.is_off(part, brush)
        assert _gap(part, brush, bare) >= 0


def test_a_line_across_a_band_of_bare_paper_is_drawn_to_its_edges() -> None:
    brush, edges = load_brush("fineliner"), np.array([12, 18]) * SIDE / PX
    parts = with_bare(band(12, 18)).parts_off(across(0.1, 0.9, 2), brush)
    assert [part[[0, -1], 0].tolist() for part in parts] == [
        pytest.approx([0.1 * SIDE, edges[0] - brush.widest], abs=1.5e-3),
        pytest.approx([edges[1] + brush.widest, 0.9 * SIDE], abs=1.5e-3),
    ]
    assert [len(part) for part in parts] == [2, 2]


def _gap(stroke: Floats, brush: Brush, bare: Bools) -> float:
    """Return how far the nearest edge of a stroke's dots, which lie closely, is from bare pixels, metres."""
    path, half_widths, _ = brush.bare_mark(refine([stroke])[0])
    places = np.linspace(0, len(path) - 1, 40 * len(path))
    x, y, half = (np.interp(places, np.arange(len(path)), line)[:, None] for line in (*path.T, half_widths))
    rows, columns = np.nonzero(bare)
    side = SIDE / PX
    across, down = (np.abs(dot / side - at - 0.5).clip(min=0.5) - 0.5 for dot, at in ((x, columns), (y, rows)))
    return float((np.hypot(across, down) * side - half).min(initial=SIDE))
