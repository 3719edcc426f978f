import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from maulstick.errors import InputError
from maulstick.recording.files.curves import catmull_rom, polylines
from maulstick.storage.arrays import Floats

points = st.floats(-1, 1, allow_subnormal=False)
cubics = arrays(np.float64, (1, 4, 2), elements=points)


def bezier(cubic: Floats, t: Floats) -> Floats:
    """De Casteljau's points (k, 2) of one cubic (4, 2)."""
    level = np.repeat(cubic[None], len(t), axis=0)
    while level.shape[1] > 1:
        level = level[:, :-1] * (1 - t[:, None, None]) + level[:, 1:] * t[:, None, None]
    return level[:, 0]


def distances(curve: Floats, polyline: Floats) -> Floats:
    """How far each point of a curve (k, 2) is from a polyline (m, 2)."""
    u, v = polyline[:-1], polyline[1:]
    squared = ((v - u) ** 2).sum(1)
    t = ((curve[:, None] - u) * (v - u)).sum(2) / np.where(squared > 0, squared, 1)
    nearest = u + np.clip(t, 0, 1)[..., None] * (v - u)
    return np.linalg.norm(nearest - curve[:, None], axis=2).min(axis=1)


@given(cubics)
def test_a_polyline_is_nowhere_farther_from_its_curve_than_a_ten_thousandth_of_the_drawing(cubic: Floats) -> None:
    (polyline,) = polylines([cubic])
    tolerance = 1e-4 * np.ptp(cubic[0], axis=0).max()
    assert distances(bezier(cubic[0], np.linspace(0, 1, 300)), polyline).max() <= tolerance + 1e-15
    assert np.array_equal(polyline[0], cubic[0, 0])
    assert polyline[-1] == pytest.approx(cubic[0, 3], abs=1e-15)


def test_a_straight_line_is_two_points_and_a_chain_passes_through_its_joints() -> None:
    u, v, w = np.array([0.0, 0.0]), np.array([1.0, 2.0]), np.array([3.0, 0.0])
    chain = np.array([[a + (b - a) * k / 3 for k in range(4)] for a, b in ((u, v), (v, w))])
    assert polylines([chain])[0] == pytest.approx(np.array([u, v, w]), abs=1e-15)


def test_a_small_curve_in_a_large_drawing_has_fewer_points_than_alone() -> None:
    curve = np.array([[[0, 0], [1, 1], [2, -1], [3, 0]]], dtype=float)
    together = polylines([curve, curve * 100])
    assert len(together[0]) < len(polylines([curve])[0]) == len(together[1])


def test_curves_with_too_many_points_or_at_no_place_are_refused() -> None:
    with pytest.raises(InputError, match="its curves come to over 5000000 samples; that is more than a drawing may"):
        polylines([np.random.default_rng(0).random((100_000, 4, 2))])
    for place in (np.nan, np.inf, 1e13):
        with pytest.raises(InputError, match="a point of a curve has no place: it is no number, or too large"):
            polylines([np.full((1, 4, 2), place)])


@given(arrays(np.float64, st.tuples(st.integers(4, 9), st.just(2)), elements=points))
def test_a_catmull_rom_spline_passes_through_all_its_points_but_the_first_and_last_without_a_corner(p: Floats) -> None:
    spline = catmull_rom(p)
    assert np.array_equal(spline[:, 0], p[1:-2])
    assert np.array_equal(spline[:, 3], p[2:-1])
    assert spline[1:, 1] - spline[1:, 0] == pytest.approx(spline[:-1, 3] - spline[:-1, 2], abs=1e-15)
    assert 6 * (spline[:, 1] - spline[:, 0]) == pytest.approx(p[2:-1] - p[:-3], abs=1e-14)
