import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.drawing.lines import cut, lengths
from maulstick.drawing.regions import hatched, region_of
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
def test_what_is_cut_out_of_a_line_is_all_that_lies_in_the_region(
    line: list[tuple[int, int]], corners: list[list[tuple[int, int]]]
) -> None:
    region = region_of([np.array(ring, dtype=np.float64) for ring in corners], "nonzero")
    path = np.array(line, dtype=np.float64)
    (pieces,) = cut([path], region)
    steps = shapely.linestrings(np.stack([path[:-1], path[1:]], axis=1))
    assert lengths(pieces).sum() == pytest.approx(shapely.length(shapely.intersection(steps, region)).sum(), abs=1e-6)
    grown = shapely.buffer(region, 1e-6)
    assert all(shapely.covers(grown, shapely.MultiPoint(piece)) for piece in pieces)


def test_nothing_fills_nothing() -> None:
    assert region_of([], "nonzero").is_empty
    assert region_of([np.array([[0.0, 0.0], [1.0, 1.0]])], "evenodd").is_empty
    assert region_of([np.zeros((5, 2)), np.zeros((4, 2))], "evenodd").is_empty
    assert hatched(shapely.Polygon(), 1.0, 0.0) == []


def test_too_many_lines_are_refused() -> None:
    with pytest.raises(InputError, match="its hatching takes over 100000 lines in one shape; hatch wider"):
        hatched(shapely.box(0, 0, 20, 20), 5e-5, 0.0)
