from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.painting.painting_file import write_painting
from maulstick.robot.duration import seconds_of
from maulstick.robot.execute import execute
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.routine import NOTHING, Action, Draw, PaintLoad, Prompt, routine
from maulstick.robot.stops import UNKNOWN, Stops
from tests.support.robot.recorder import EASEL, LIMITS, Recorder
from tests.support.robot.small_paintings import SIX, line, painting_of

REFILL = "refill or clean the marker with the paint #cc1a1a"
TEN = painting_of(line(i, (0.01, 0.003 * i), (0.03, 0.003 * i)) for i in range(1, 11))
"""Ten strokes of 20 mm of one paint."""
start = np.array([0.05, -0.05, 0.05])


def stopped(stops: Stops, load: PaintLoad = NOTHING) -> list[Action]:
    return stops.put_into(routine(TEN, EASEL, LIMITS, load=load), TEN, EASEL, LIMITS, load)


def said(actions: list[Action]) -> list[int | str]:
    return [action.message if isinstance(action, Prompt) else action.stroke for action in actions]  # type: ignore[union-attr]


def test_without_stops_a_routine_is_as_it_was() -> None:
    assert said(stopped(Stops())) == list(range(1, 11))


def test_a_pen_is_refilled_before_the_stroke_that_would_be_too_much() -> None:
    assert said(stopped(Stops(metres=0.07))) == [1, 2, 3, REFILL, 4, 5, 6, REFILL, 7, 8, 9, REFILL, 10]


def test_what_a_pen_has_drawn_before_counts_and_where_nobody_knows_it_is_refilled_first() -> None:
    assert said(stopped(Stops(metres=0.07), PaintLoad(0, 0.06)))[:3] == [REFILL, 1, 2]
    assert said(stopped(Stops(metres=0.07), UNKNOWN))[:3] == [REFILL, 1, 2]
    assert said(stopped(Stops(seconds=1e6), UNKNOWN))[:3] == [REFILL, 1, 2]
    assert said(stopped(Stops(), UNKNOWN)) == list(range(1, 11))


def test_a_stroke_longer_than_a_filling_is_drawn_after_a_refill_and_none_twice() -> None:
    assert said(stopped(Stops(metres=0.001)))[:5] == [1, REFILL, 2, REFILL, 3]


@given(st.floats(0.1, 20.0))
def test_no_pen_draws_longer_than_it_may(seconds: float) -> None:
    actions = stopped(Stops(seconds=seconds))
    took = seconds_of(actions, LIMITS, start)
    runs: list[list[float]] = [[]]
    for action, each in zip(actions, took.tolist(), strict=True):
        if isinstance(action, Prompt):
            runs.append([])
        else:
            runs[-1].append(each)
    assert sum(map(len, runs)) == 10
    assert all(len(run) == 1 or sum(run) <= seconds + took.max() for run in runs)
    assert all(runs[1:])


def test_a_pen_that_is_put_in_is_full() -> None:
    actions = Stops(metres=0.03).put_into(routine(SIX, EASEL, LIMITS), SIX, EASEL, LIMITS)
    order = [0 if isinstance(a, Draw) else 1 if "put in" in a.message else 2 for a in actions if not hasattr(a, "what")]
    assert order == [1, 0, 0, 0, 1, 0, 2, 0, 2, 0]


def test_a_pause_is_before_its_stroke_and_fills_nothing(tmp_path: Path) -> None:
    write_painting(TEN, tmp_path / "painting.json")
    actions = stopped(Stops(pauses={1: 1, 4: 4}))
    assert said(actions)[:6] == [
        "do what the pause before stroke 1 is for", 1, 2, 3, "do what the pause before stroke 4 is for", 4,
    ]  # fmt: skip
    with Journal.open(journal_of(tmp_path / "painting.json")) as journal, Recorder() as robot:
        lifted: list[bool] = []
        load = execute(actions, robot, journal, lambda ask: lifted.append(robot.lifted))
    assert lifted == [True, True]
    assert load == PaintLoad(0, pytest.approx(0.2))
    assert load.seconds == pytest.approx(seconds_of(actions, LIMITS, start).sum(), rel=0.2)


def test_the_lifted_pen_waits_aside_while_it_is_refilled(tmp_path: Path) -> None:
    write_painting(TEN, tmp_path / "painting.json")
    with Journal.open(journal_of(tmp_path / "painting.json")) as journal, Recorder() as robot:
        places: list[list[float]] = []
        actions = stopped(Stops(metres=0.07, aside=(-0.03, 0.02)))
        execute(actions, robot, journal, lambda ask: places.append([*robot.place.tolist(), robot.lifted]))
    assert len(places) == 3
    for x, y, z, lifted in places:
        assert (x, y, lifted) == (pytest.approx(-0.03), pytest.approx(-0.02), True)
        assert z >= EASEL.travel - 1e-9


def test_a_place_aside_that_is_outside_the_limits_is_refused_before_anything_moves() -> None:
    with pytest.raises(InputError, match=r"refill.at is where the machine does not go: the machine's x is -500 mm"):
        stopped(Stops(metres=0.07, aside=(-0.5, 0.02)))
