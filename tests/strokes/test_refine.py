from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.interpolate import CubicHermiteSpline

from maulstick.painting.raster import Canvas
from maulstick.storage.arrays import Floats
from maulstick.strokes.refine import SAGITTA, refine
from maulstick.strokes.strokes import path_lengths
from maulstick.style import load_style
from maulstick.style.cards import BUILT_IN
from maulstick.style.pressure import pressure_along

STYLES = sorted(card.stem for card in BUILT_IN.glob("*.json"))
ROUNDING = 1e-9  # metres
COORDINATES = st.floats(0, 0.5, allow_nan=False, width=32)
STROKES = st.lists(
    st.integers(1, 12).flatmap(lambda n: arrays(np.float64, (n, 4), elements=COORDINATES)), min_size=1, max_size=4
)


def strokes_of(style: str, longest: float = 0.5) -> list[Floats]:
    """Strokes of a built-in style (32, 3), scaled to lengths up to half a metre."""
    drawn = load_style(style, Canvas(0.24, 0.16, 1.0))
    codes, knots = drawn.sample(20, torch.Generator().manual_seed(1))
    paths = drawn.decode(codes).detach().double().numpy()
    pressure = pressure_along(knots).double().numpy()
    lengths = np.random.default_rng(2).uniform(0.05, longest, len(paths))
    paths = paths * (lengths / np.maximum(path_lengths(paths), 1e-6))[:, None, None]
    return list(np.concatenate([paths, pressure[..., None]], axis=2))


def spline_of(stroke: Floats) -> CubicHermiteSpline:
    """The centripetal Catmull-Rom spline through distinct points (n, 2), n of at least 3, as docs/equations.md says."""
    spans = np.sqrt(np.hypot(*np.diff(stroke, axis=0).T))
    speeds = np.diff(stroke, axis=0) / spans[:, None]
    shares = (spans[1:] / (spans[1:] + spans[:-1]))[:, None]
    inner = shares * speeds[:-1] + (1 - shares) * speeds[1:]
    slopes = np.concatenate([[(3 * speeds[0] - inner[0]) / 2], inner, [(3 * speeds[-1] - inner[-1]) / 2]])
    return CubicHermiteSpline(np.concatenate([[0], np.cumsum(spans)]), stroke, slopes)


def furthest(points: Floats, path: Floats) -> float:
    """Largest distance of points (k, 2) from a polyline (n, 2)."""
    starts, steps = path[:-1], np.diff(path, axis=0)
    squared = np.maximum((steps**2).sum(axis=1), 1e-30)
    worst = 0.0
    for chunk in np.array_split(points, len(points) // 500 + 1):
        along = (((chunk[:, None] - starts) * steps).sum(axis=2) / squared).clip(0, 1)
        away = chunk[:, None] - starts - along[..., None] * steps
        worst = max(worst, float(np.sqrt((away**2).sum(axis=2)).min(axis=1).max()))
    return worst


def rows_in(stroke: Floats, finer: Floats) -> Sequence[int]:
    """Indices at which the points of a stroke follow one another in the finer one."""
    found, at = [], 0
    for point in stroke:
        while not (finer[at] == point).all():
            at += 1
        found.append(at)
        at += 1
    return found


@given(STROKES)
def test_a_refined_stroke_has_all_points_that_were_given_in_their_order(strokes: list[Floats]) -> None:
    for stroke, finer in zip(strokes, refine(strokes), strict=True):
        rows = rows_in(stroke, finer)
        assert (rows[0], rows[-1]) == (0, len(finer) - 1)


@given(STROKES)
def test_pressure_and_speed_change_evenly_and_never_leave_the_range_of_those_given(strokes: list[Floats]) -> None:
    for stroke, finer in zip(strokes, refine(strokes), strict=True):
        rows = rows_in(stroke, finer)
        expected = [np.interp(np.arange(len(finer)), rows, column) for column in stroke[:, 2:].T]
        assert finer[:, 2:] == pytest.approx(np.stack(expected, axis=1), abs=ROUNDING)
        assert (finer[:, 2:] >= stroke[:, 2:].min(axis=0)).all()
        assert (finer[:, 2:] <= stroke[:, 2:].max(axis=0)).all()


@given(STROKES)
def test_between_two_points_a_refined_stroke_stays_beside_the_straight_step(strokes: list[Floats]) -> None:
    for stroke, finer in zip(strokes, refine(strokes), strict=True):
        for begin, end in pairwise(rows_in(stroke, finer)):
            step, path = finer[end, :2] - finer[begin, :2], finer[begin : end + 1, :2] - finer[begin, :2]
            length = max(float(np.hypot(*step)), 1e-30)
            along, across = path @ step / length, path @ (-step[1], step[0]) / length
            assert -ROUNDING <= along.min() <= along.max() <= length + ROUNDING
            assert np.abs(across).max() <= length / 4 + ROUNDING


@pytest.mark.parametrize("style", STYLES)
def test_strokes_of_half_a_metre_depart_from_their_spline_by_a_tenth_of_a_millimetre_at_most(style: str) -> None:
    strokes = strokes_of(style)
    for stroke, finer in zip(strokes, refine(strokes), strict=True):
        spline = spline_of(stroke[:, :2])
        between = np.linspace(spline.x[:-1], spline.x[1:], 20).ravel("F")
        assert furthest(spline(between), finer[:, :2]) <= SAGITTA + ROUNDING


@pytest.mark.parametrize("style", STYLES)
def test_strokes_are_refined_alike_alone_and_among_others(style: str) -> None:
    strokes = strokes_of(style)
    for stroke, finer in zip(strokes, refine(strokes), strict=True):
        np.testing.assert_array_equal(refine([stroke])[0], finer)


def test_a_stroke_gets_no_more_points_than_its_curves_need() -> None:
    angles = np.linspace(0, 2 * np.pi, 32)
    circle = 0.1 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    longest = np.sqrt(8 * 0.1 * SAGITTA)  # a chord of that sagitta
    needed = np.ceil(0.1 * (angles[1] - angles[0]) / longest)
    assert [len(finer) for finer in refine([circle, circle / 100])] == [31 * needed + 1, 32]


@given(st.integers(1, 32), st.floats(0, 6.3), st.integers(0, 2**32 - 1))
def test_straight_strokes_and_dots_stay_as_they_are(points: int, angle: float, seed: int) -> None:
    along = np.sort(np.random.default_rng(seed).uniform(0, 0.5, points))[:, None]
    straight = np.concatenate([along * np.cos(angle), along * np.sin(angle), along], axis=1)
    dot = np.concatenate([np.full((points, 2), 0.1), along], axis=1)
    for finer, stroke in zip(refine([straight, dot]), (straight, dot), strict=True):
        np.testing.assert_array_equal(finer, stroke)


def test_a_point_that_is_given_twice_is_a_corner() -> None:
    corners = np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1], [0.0, 0.0]])
    square = corners.repeat([1, 2, 2, 2, 1], axis=0)
    once, twice = refine([corners, square])
    np.testing.assert_array_equal(twice, square)
    assert len(once) > len(corners)


def test_a_closed_stroke_and_no_stroke_at_all_are_refined() -> None:
    angles = np.linspace(0, 2 * np.pi, 13)
    closed = 0.05 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    closed[-1] = closed[0]
    (finer,) = refine([closed])
    assert np.hypot(*finer.T) == pytest.approx(0.05, abs=1e-3)
    np.testing.assert_array_equal(finer[[0, -1]], closed[[0, -1]])
    assert refine([]) == []
    np.testing.assert_array_equal(refine([closed[:1]])[0], closed[:1])
