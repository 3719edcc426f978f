import numpy as np
import pytest
import shapely
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from maulstick.drawing.lines import cut, lengths
from maulstick.drawing.regions import hatched, region_of, rows_through
from maulstick.errors import InputError
from maulstick.storage.arrays import Floats

places = st.tuples(st.integers(0, 20), st.integers(0, 20))
rings = st.lists(st.lists(places, min_size=3, max_size=8), min_size=1, max_size=3)


def turns_about(x: float, y: float, ring: Floats) -> int:
    """How often a ring goes around a place, by the angle it sweeps."""
    away = np.concatenate([ring, ring[:1]]) - (x, y)
    angles = np.arctan2(away[:, 1], away[:, 0])
    return round(float(np.angle(np.exp(1j * np.diff(angles))).sum() / (2 * np.pi)))


@settings(max_examples=60, deadline=None)
@given(rings, st.sampled_from(["nonzero", "evenodd"]))
def test_a_region_has_the_places_that_its_rule_says(corners: list[list[tuple[int, int]]], rule: str) -> None:
    closed = [np.array(ring, dtype=np.float64) for ring in corners]
    region = region_of(closed, rule)
    for x, y in np.random.default_rng(0).uniform(0, 20, (20, 2)):
        turns = [turns_about(x, y, ring) for ring in closed]
        inside = sum(turns) % 2 != 0 if rule == "evenodd" else sum(turns) != 0
        assert shapely.covers(region, shapely.Point(x, y)) == inside


@settings(max_examples=60, deadline=None)
@given(st.lists(places, min_size=2, max_size=12), rings)
@example(
    [(12, 2), (20, 9)],
    [[(1, 2), (13, 1), (11, 7), (0, 2), (1, 1), (0, 0), (1, 0)], [(0, 2), (0, 4), (1, 0), (0, 3), (12, 2), (20, 9)]],
)
def test_what_is_cut_out_of_a_line_is_all_that_lies_in_the_region(
    line: list[tuple[int, int]], corners: list[list[tuple[int, int]]]
) -> None:
    region = region_of([np.array(ring, dtype=np.float64) for ring in corners], "nonzero")
    path = np.array(line, dtype=np.float64)
    (pieces,) = cut([path], region)
    steps = shapely.linestrings(np.stack([path[:-1], path[1:]], axis=1))
    inside = shapely.intersection(steps, shapely.buffer(region, 1e-10))  # where an edge has a corner, rounding parts it
    assert lengths(pieces).sum() == pytest.approx(shapely.length(inside).sum(), abs=1e-6)
    grown = shapely.buffer(region, 1e-6)
    assert all(shapely.covers(grown, shapely.MultiPoint(piece)) for piece in pieces)


@settings(max_examples=60, deadline=None)
@given(rings, st.sampled_from(["nonzero", "evenodd"]), st.floats(-4, 4), st.floats(0.3, 3))
@example([[(0, 0), (0, 1), (1, 0)]], "nonzero", 0.0, 1.6)
def test_rows_are_what_of_parallel_lines_lies_in_the_region(
    corners: list[list[tuple[int, int]]], rule: str, angle: float, spacing: float
) -> None:
    region = region_of([np.array(ring, dtype=np.float64) for ring in corners], rule)
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    corner_rows = np.concatenate([np.array(ring, dtype=np.float64) for ring in corners]) @ across / spacing - 0.5
    assume(np.abs(corner_rows - np.round(corner_rows)).min() > 1e-6)  # a row along an edge is in the region or not
    numbers = np.arange(-np.ceil(60 / spacing), np.ceil(60 / spacing))
    offsets = (spacing * (numbers + 0.5))[:, None, None] * across
    lines = shapely.linestrings(np.array([[-60.0], [60.0]]) * along + offsets)
    rows = rows_through(region, spacing, angle)
    met = shapely.length(shapely.intersection(lines, shapely.buffer(region, 1e-9)))
    assert lengths(rows).sum() == pytest.approx(met.sum(), abs=1e-3)
    for row in rows:
        assert shapely.covers(shapely.buffer(region, 1e-6), shapely.LineString(row))
        assert np.abs((row @ across) / spacing - 0.5 - np.round((row @ across) / spacing - 0.5)).max() < 1e-9
        assert (row[1] - row[0]) @ along > 0


def test_the_edges_of_many_shapes_in_one_path_are_each_crossed_once() -> None:
    squares = [np.array([(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)], dtype=float) for x in (0, 2) for y in (0, 2)]
    rows = rows_through(region_of(squares, "nonzero"), 0.5, 0.0)
    assert [row.tolist() for row in rows[:2]] == [[[0, 0.25], [1, 0.25]], [[2, 0.25], [3, 0.25]]]
    assert len(rows) == 8


def test_a_shape_between_two_rows_has_none() -> None:
    assert rows_through(shapely.box(0, 0.3, 1, 0.7), 1.0, 0.0) != []
    assert rows_through(shapely.box(0, 0.6, 1, 0.9), 1.0, 0.0) == []


def test_nothing_fills_nothing() -> None:
    assert region_of([], "nonzero").is_empty
    assert region_of([np.array([[0.0, 0.0], [1.0, 1.0]])], "evenodd").is_empty
    assert region_of([np.zeros((5, 2)), np.zeros((4, 2))], "evenodd").is_empty
    assert hatched(shapely.Polygon(), 1.0, 0.0) == []


def test_too_many_lines_are_refused() -> None:
    with pytest.raises(InputError, match="its hatching takes over 100000 lines in one shape; hatch wider"):
        hatched(shapely.box(0, 0, 20, 20), 5e-5, 0.0)
