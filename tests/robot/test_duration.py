"""Tests of the durations of actions: many at once take what each takes by its profile."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from maulstick.robot.duration import drawn_metres, seconds_of, timed
from maulstick.robot.limits import Limits
from maulstick.robot.routine import Action, Draw, Motion, Prompt
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats
from tests.support.tolerances import PROFILE_SECONDS

PRESSES = Limits(
    lower=(0, 0, -0.01),
    upper=(0.3, 0.3, 0.1),
    speed=0.2,
    climb=0.05,
    acceleration=2.0,
    deviation=1e-5,
    varies_pressure=True,
    settling=0.01,
)
LIFTS = PRESSES.model_copy(update={"varies_pressure": False, "lifting": 0.15})
AXES = PRESSES.model_copy(update={"axes": (2.0, 1.0, 0.3)})


def one_by_one(actions: list[Action], limits: Limits, place: Floats) -> list[float]:
    """Return the seconds of each action by a profile of each of its motions."""

    def straight(start: Floats, end: Floats) -> float:
        return Profile.of(np.stack([start, end]), np.full(2, limits.speed), limits).seconds

    found = []
    for action in actions:
        flat = np.array([1, 1, 1 if limits.varies_pressure else 0])
        if isinstance(action, Prompt):
            goes = action.aside is not None
            aside = np.array(action.aside if goes else place)
            found.append(limits.settling + straight(place * flat, aside * flat) if goes else 0.0)
            place = aside
            continue
        motion = action.motion
        seconds = straight(place * flat, motion.start * flat) + Profile.of(motion.path, motion.speed, limits).seconds
        seconds += 2 * (limits.lifting + limits.settling)
        if limits.varies_pressure:
            seconds += straight(motion.start, motion.path[0]) + straight(motion.path[-1], motion.end) + limits.settling
        found.append(seconds)
        place = motion.end
    return found


@some.composite
def any_actions(draw: some.DrawFn) -> list[Action]:
    """Return strokes of 1 to 9 points, some of them repeated, and prompts between them, some of them aside."""
    rng = np.random.default_rng(draw(some.integers(0, 2**32 - 1)))
    actions: list[Action] = []
    for points in draw(some.lists(some.integers(0, 9), max_size=12)):
        if points == 0:
            actions.append(Prompt("wait", 0, aside=(0.3, 0.0, 0.03) if rng.random() < 0.5 else None))
            continue
        path = rng.uniform((0, 0, -0.002), (0.2, 0.2, 0), (points, 3))
        path[rng.random(points) < 0.2] = path[0]
        actions.append(Draw(points, 0, Motion(path, rng.uniform(0.01, 0.3, points), 0.01, 0.02)))
    return actions


@pytest.mark.parametrize("limits", [PRESSES, LIFTS, AXES], ids=["presses", "lifts", "axes"])
@given(actions=any_actions())
def test_actions_timed_together_take_what_each_takes_alone(actions: list[Action], limits: Limits) -> None:
    place = np.array([0.1, 0.05, 0.03])
    expected = one_by_one(actions, limits, place)
    assert seconds_of(actions, limits, place) == pytest.approx(expected, rel=PROFILE_SECONDS)


def test_no_actions_take_no_time_and_draw_nothing() -> None:
    assert seconds_of([], PRESSES, np.zeros(3)).tolist() == []
    assert seconds_of([Prompt("wait", 0)], PRESSES, np.zeros(3)).tolist() == [0.0]
    assert drawn_metres([Prompt("wait", 0)]) == 0.0


@given(any_actions())
def test_prompts_for_a_tool_know_all_seconds_until_the_next_one(actions: list[Action]) -> None:
    place = np.array([0.05, 0.05, 0.02])
    known = timed(actions, LIFTS, place)
    seconds = seconds_of(actions, LIFTS, place)
    asked = [index for index, action in enumerate(known) if isinstance(action, Prompt)]
    for index, after in zip(asked, [*asked, len(actions)][1:], strict=True):
        prompt = known[index]
        assert isinstance(prompt, Prompt)
        assert (prompt.seconds or 0.0) == pytest.approx(seconds[index + 1 : after].sum())
    assert [action for action in known if not isinstance(action, Prompt)] == [
        action for action in actions if not isinstance(action, Prompt)
    ]


def test_a_pause_counts_neither_as_a_new_pen_nor_as_its_end() -> None:
    path = np.array([[0.0, 0, 0], [0.1, 0, 0]])
    stroke = Draw(0, 0, Motion(path, np.full(2, 0.1), 0.01, 0.01))
    pen, pause, _, _ = timed([Prompt("pen", 0), Prompt("wait", 0, renews=False), stroke, stroke], LIFTS, np.zeros(3))
    assert isinstance(pen, Prompt)
    assert isinstance(pause, Prompt)
    assert pen.seconds is not None
    assert pen.seconds > 2.0
    assert pause.seconds is None
