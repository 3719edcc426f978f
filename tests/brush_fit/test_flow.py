import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from maulstick.brush_fit.flow import fit_flow
from maulstick.storage.arrays import Floats
from tests.support.tolerances import FLOAT64_ROUND_TRIP, FLOW_NOISY

COUNT = 60


def pressures(seed: int) -> Floats:
    return np.random.default_rng(seed).uniform(0, 1, COUNT)


def opacities(pressure: Floats, opacity: float, faint: float, solid: float) -> Floats:
    return opacity * (faint + (1 - faint) * np.minimum(pressure / solid, 1))


def noisy(opacity: Floats, seed: int) -> Floats:
    return (opacity * (1 + 0.05 * np.random.default_rng(seed + 100).normal(size=COUNT))).clip(0, 1)


def test_strokes_that_are_all_alike_flow_evenly() -> None:
    flow = fit_flow(pressures(0), np.full(COUNT, 0.8), pales=True)
    assert (flow.opacity, flow.faint, flow.scatter) == pytest.approx((0.8, 1, 0), abs=FLOAT64_ROUND_TRIP)


@pytest.mark.parametrize(("opacity", "faint", "solid"), [(0.9, 0.4, 0.6), (1.0, 0.2, 1.0), (0.7, 0.5, 0.3)])
def test_strokes_that_pale_at_a_light_pressure_are_found_to(opacity: float, faint: float, solid: float) -> None:
    pressure = pressures(1)
    flow = fit_flow(pressure, noisy(opacities(pressure, opacity, faint, solid), 1), pales=True)
    assert flow.faint < 1
    light_and_deep = np.array([0.1, 0.9])
    truth = opacities(light_and_deep, opacity, faint, solid)
    assert flow.at(light_and_deep) == pytest.approx(truth, abs=FLOW_NOISY)


def test_strokes_flow_evenly_unless_they_may_pale() -> None:
    pressure = pressures(2)
    flow = fit_flow(pressure, noisy(np.full(COUNT, 0.8), 2), pales=False)
    assert (flow.faint, flow.solid) == (1, 1)
    assert flow.scatter == pytest.approx(0.05, rel=0.4)
    opacity = opacities(pressure, 0.9, 0.3, 0.8)
    assert fit_flow(pressure, opacity, pales=False).faint == 1
    assert fit_flow(pressure, opacity, pales=True).faint == pytest.approx(0.3, abs=FLOW_NOISY)


def test_a_stray_stroke_does_not_change_what_the_others_say() -> None:
    opacity = np.full(COUNT, 0.8)
    opacity[::10] = 0.1
    flow = fit_flow(pressures(3), opacity, pales=True)
    assert flow.at(np.array([0.2, 0.9])) == pytest.approx([0.8, 0.8], abs=FLOW_NOISY)


@settings(max_examples=6, deadline=None)
@given(
    pressure=arrays(np.float64, 24, elements=st.floats(0, 1)),
    opacity=arrays(np.float64, 24, elements=st.floats(1e-3, 1)),
)
def test_a_flow_is_always_one_that_a_brush_can_have(pressure: Floats, opacity: Floats) -> None:
    flow = fit_flow(pressure, opacity, pales=True)
    assert 0 < flow.opacity <= 1
    assert 0 < flow.faint <= 1
    assert 0 < flow.solid <= 1
    assert flow.scatter >= 0
    at = flow.at(np.linspace(0, 1, 9))
    assert np.all((at > 0) & (at <= 1))
    assert np.all(np.diff(at) >= 0)
