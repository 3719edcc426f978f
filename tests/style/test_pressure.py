import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from maulstick.style.pressure import KNOTS, fit_knots, pressure_along
from tests.support.tolerances import FLOAT32_VALUE, FLOAT64_ROUND_TRIP

shares = st.floats(0, 1, width=32)
knots_of_strokes = st.integers(0, 4).flatmap(lambda n: arrays(np.float64, (n, KNOTS), elements=shares))


def test_pressure_is_a_line_between_equally_spaced_knots() -> None:
    knots = torch.tensor([[0.0, 1.0, 0.25, 0.5], [0.3, 0.3, 0.3, 0.3]])
    expected = np.stack([np.interp(np.linspace(0, 3, 32), range(4), row) for row in knots.numpy()])
    assert pressure_along(knots).numpy() == pytest.approx(expected, abs=FLOAT32_VALUE)


@given(st.lists(shares, min_size=4, max_size=4))
def test_pressure_stays_between_its_knots(knots: list[float]) -> None:
    pressure = pressure_along(torch.tensor([knots]))
    assert pressure.min() >= min(knots) - FLOAT32_VALUE
    assert pressure.max() <= max(knots) + FLOAT32_VALUE
    assert pressure[0, [0, -1]].tolist() == [knots[0], knots[-1]]


@given(knots_of_strokes)
def test_knots_are_found_again_in_the_pressure_that_they_make(knots: np.ndarray) -> None:
    pressure = pressure_along(torch.from_numpy(knots)).numpy()
    assert fit_knots(pressure) == pytest.approx(knots, abs=FLOAT64_ROUND_TRIP)


def test_knots_are_the_nearest_in_least_squares() -> None:
    pressure = np.random.default_rng(0).uniform(0.3, 0.7, (6, 32))
    hats = pressure_along(torch.eye(KNOTS, dtype=torch.float64)).numpy()
    expected = np.linalg.lstsq(hats.T, pressure.T, rcond=None)[0].T
    assert expected.min() > 0
    assert fit_knots(pressure) == pytest.approx(expected, abs=FLOAT64_ROUND_TRIP)


def test_knots_stay_within_what_a_pressure_can_be() -> None:
    sudden = np.repeat([0.0, 1.0], 16)  # a line through these overshoots on both sides
    assert fit_knots(sudden[None])[0, 1:3].tolist() == [0, 1]


def test_a_pressure_that_was_not_recorded_has_no_knots_and_leaves_others_theirs() -> None:
    pressure = np.full((3, 32), 0.5)
    pressure[1] = np.nan
    knots = fit_knots(pressure)
    assert np.isnan(knots[1]).all()
    assert knots[[0, 2]] == pytest.approx(0.5)
