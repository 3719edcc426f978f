from dataclasses import replace

import numpy as np
import pytest
import torch

from maulstick.errors import InputError
from maulstick.strokes.strokes import Strokes
from maulstick.style.hand import Hand, by_length
from tests.support.style.synthetic_hands import arc, drawn, strokes_of
from tests.support.tolerances import FLOAT32_VALUE, FLOAT64_ROUND_TRIP

PATHS = drawn(arc, 8)
ROWS = torch.arange(8)


def straight(length: float, n: int = 32) -> np.ndarray:
    """(1, n, 2)."""
    return np.stack([np.linspace(0, length, n), np.zeros(n)], axis=1)[None]


def timed(lengths: list[float], times: np.ndarray) -> Hand:
    """Straight strokes with these times (N, 32)."""
    strokes = strokes_of(np.concatenate([straight(length) for length in lengths]))
    return Hand.of(Strokes(strokes.trajectories, times, strokes.poses))


def test_a_hand_keeps_its_strokes_without_the_dots() -> None:
    paths = np.concatenate([straight(0.0), PATHS[:4], straight(0.9e-3), straight(1.1e-3)])
    hand = Hand.of(strokes_of(paths))
    assert len(hand) == 5
    assert np.array_equal(hand.paths, strokes_of(paths).trajectories[[1, 2, 3, 4, 6], :, :2])
    assert hand.pressure.shape == (5, 4)
    assert hand.speeds.shape == (5, 32)


def test_fewer_than_five_strokes_are_refused() -> None:
    paths = np.concatenate([PATHS[:4], straight(0.9e-3)])
    with pytest.raises(InputError) as caught:
        Hand.of(strokes_of(paths))
    assert str(caught.value) == (
        "the number of strokes of a millimetre or more is 4; it must be at least 5, and 20 make a good style; draw more"
    )


def test_more_strokes_than_a_computer_can_weigh_are_refused() -> None:
    with pytest.raises(InputError, match=r"^the number of strokes is 20001; it must be at most 20000; learn from"):
        Hand.of(strokes_of(np.repeat(straight(0.02), 20_001, axis=0)))


def test_strokes_of_other_than_32_points_are_refused() -> None:
    with pytest.raises(InputError) as caught:
        Hand.of(strokes_of(np.repeat(straight(0.02, 16), 5, axis=0)))
    assert str(caught.value) == "the points of a stroke is 16; it must be 32"


@pytest.mark.parametrize(
    ("length", "place", "text"),
    [
        (101.0, 0.0, "the longest stroke is 101 m; it must be at most 100 m; check the recording's unit"),
        (0.1, 101.0, "how far strokes lie is 101 m; it must be at most 100 m, recordings side by side; learn from"),
    ],
)
def test_a_hand_that_no_file_may_hold_is_refused_before_it_is_learned(length: float, place: float, text: str) -> None:
    strokes = strokes_of(np.repeat(straight(length), 5, axis=0))
    with pytest.raises(InputError, match=text):
        Hand.of(replace(strokes, poses=strokes.poses + np.array([place, 0.0, 0.0])))


def test_speeds_are_lengths_over_times() -> None:
    lengths = [0.02, 0.03, 0.04, 0.05, 0.06]
    hand = timed(lengths, np.broadcast_to(np.linspace(0, 0.5, 32), (5, 32)))
    assert hand.speeds == pytest.approx(np.repeat(np.array(lengths)[:, None] / 0.5, 32, axis=1), rel=1e-9)


def test_a_stroke_that_speeds_up_is_fast_at_its_end() -> None:
    along = np.linspace(0, 1, 32)
    hand = timed([0.05] * 5, np.broadcast_to(np.sqrt(along), (5, 32)))  # a constant acceleration of 0.1 m/s²
    assert hand.speeds[0, 3:-1] == pytest.approx(0.1 * np.sqrt(along)[3:-1], rel=0.01)


def test_pauses_and_jumps_in_time_are_slow_and_quick_but_not_without_limit() -> None:
    times = np.tile(np.linspace(0, 1, 32), (5, 1))
    times[1, 16:] += 3600
    times[2] = 0.0
    hand = timed([0.05] * 5, times)
    assert hand.speeds[1].min() == pytest.approx((0.05 + 1e-3) / 2), "on one side of the pause as before"
    assert (hand.speeds[2] == 2.0).all()


def test_strokes_without_times_have_the_speed_of_the_others_on_average() -> None:
    times = np.tile(np.linspace(0, 1, 32), (5, 1))
    times[1] /= 4
    times[2:] = np.nan
    hand = timed([0.05] * 5, times)
    assert np.isnan(hand.speeds[2:]).all()
    speeds = hand.speeds_of(torch.tensor([3, 1, 0]))
    assert speeds is not None
    expected = np.array([0.1, 0.2, 0.05])[:, None].repeat(32, axis=1)  # the mean is of logarithms
    assert speeds.numpy() == pytest.approx(expected, rel=1e-9)


def test_a_hand_without_times_has_no_speeds() -> None:
    assert Hand.of(strokes_of(PATHS)).speeds_of(ROWS) is None


def test_pressure_is_sampled_as_it_was_recorded() -> None:
    pressed = np.linspace(0.1, 0.9, 8)[:, None] * np.linspace(1, 0.5, 32)
    pressed[3] = np.nan
    hand = Hand.of(strokes_of(PATHS, pressed))
    sampled = hand.sample_pressure(ROWS, torch.Generator().manual_seed(0))
    seen = ROWS != 3
    assert sampled[seen].numpy() == pytest.approx(hand.pressure[seen.numpy()], abs=FLOAT32_VALUE)
    assert hand.pressure[0] == pytest.approx(0.1 * np.linspace(1, 0.5, 4), abs=FLOAT64_ROUND_TRIP)
    assert (sampled[3] == sampled[3, 0]).all(), "an even one"
    assert torch.equal(hand.sample_pressure(ROWS, torch.Generator().manual_seed(0)), sampled)


def test_pressure_that_was_never_recorded_is_sampled_evenly_and_of_any_depth() -> None:
    rows = torch.zeros(2000, dtype=torch.long)
    sampled = Hand.of(strokes_of(PATHS)).sample_pressure(rows, torch.Generator().manual_seed(0))
    assert torch.equal(sampled, sampled[:, :1].expand(-1, 4))
    counts = np.histogram(sampled[:, 0].numpy(), bins=4, range=(0, 1))[0]
    assert counts.min() > 430


def test_pressure_costs_by_how_it_rises_and_falls_and_not_by_its_depth() -> None:
    falling = np.broadcast_to(np.linspace(0.6, 0.3, 32), (8, 32))
    hand, unknown = Hand.of(strokes_of(PATHS, falling)), Hand.of(strokes_of(PATHS))
    rows = torch.zeros(4, dtype=torch.long)
    pressure = torch.tensor([[0.6, 0.5, 0.4, 0.3], [0.9, 0.8, 0.7, 0.6], [0.5] * 4, [0.3, 0.4, 0.5, 0.6]])
    costs = hand.pressure_cost(pressure, rows)
    assert costs[:2].tolist() == pytest.approx([0, 0], abs=FLOAT32_VALUE)
    assert costs[3] == pytest.approx(4 * costs[2].item(), rel=1e-4), "twice as far off"
    assert costs[2] > 0.5
    assert unknown.pressure_cost(pressure, rows)[2] == 0
    assert 0 < unknown.pressure_cost(pressure, rows)[3] < costs[3], "where nobody knows, any pressure is cheaper"


def test_the_longest_stroke_goes_where_there_is_most_room() -> None:
    lengths, rooms = torch.tensor([0.5, 0.1, 0.9, 0.3]), torch.tensor([7.0, 30.0, 2.0, 8.0])
    chosen = by_length(lengths, rooms)
    assert chosen.tolist() == [3, 2, 1, 0]
    assert by_length(torch.ones(5), torch.ones(5)).tolist() == [0, 1, 2, 3, 4], "equal ones keep their order"
    assert by_length(torch.zeros(0), torch.zeros(0)).shape == (0,)
