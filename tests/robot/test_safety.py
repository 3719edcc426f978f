from collections.abc import Sequence
from itertools import pairwise
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.painting.painting import Painting
from maulstick.robot.easel import Easel
from maulstick.robot.execute import execute
from maulstick.robot.journal import Journal
from maulstick.robot.limits import SLACK, Limits
from maulstick.robot.routine import Action, Draw, Prompt, TrayVisit, routine
from maulstick.robot.tray import Tray, Well
from tests.robot.test_easel import easels
from tests.support.nominal import nominal
from tests.support.robot.recorder import LIMITS, Recorder
from tests.support.robot.small_paintings import line, painting_of
from tests.support.robot.trays import TRAY

ROUND = nominal("round")
HARD = ROUND.model_copy(update={"depth": (0.001, 0.009)})

# Nothing ever leaves the limits, and between strokes nothing touches the paper.

places = st.tuples(st.floats(0, 0.06), st.floats(0, 0.04), st.floats(0, 1))
trajectories = st.lists(places, min_size=1, max_size=4)
near = st.floats(-0.05, 0.15)


@st.composite
def paintings(draw: st.DrawFn) -> Painting:
    strokes = [
        line(i, paint=draw(st.integers(0, 1))).model_copy(update={"trajectory": tuple(path)})
        for i, path in enumerate(draw(st.lists(trajectories, min_size=1, max_size=5)))
    ]
    return painting_of(strokes, [draw(st.sampled_from([nominal("marker"), ROUND, HARD, nominal("fineliner")]))])


@st.composite
def trays(draw: st.DrawFn) -> Tray:
    well = st.builds(Well, x=near, y=near, height=st.floats(-0.01, 0.02), turns=st.integers(1, 2))
    paints = {"#cc1a1a": draw(well), "#1a33b2": draw(well)}
    clearance = draw(st.floats(0.021, 0.06))
    return TRAY.model_copy(
        update={
            "paints": paints, "water": draw(well), "cloth": draw(well), "clearance": clearance,
            "reach": draw(st.floats(1e-3, 0.1)),
        }
    )  # fmt: skip


@st.composite
def lying(draw: st.DrawFn) -> Easel:
    easel = draw(easels(st.floats(-0.08, 0.08)))
    corner = draw(st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(-0.005, 0.02)))
    return easel.model_copy(
        update={"corner": corner, "deepest": draw(st.floats(0, 0.01)), "travel": draw(st.floats(1e-3, 0.02))}
    )


rooms = st.builds(
    lambda size, height, speed, varies: LIMITS.model_copy(
        update={
            "lower": (-size, -size, -0.02), "upper": (size, size, height), "speed": speed, "varies_pressure": varies,
        }
    ),
    st.floats(0.02, 0.5), st.floats(0.03, 0.2), st.floats(0.05, 0.5), st.booleans(),
)  # fmt: skip


@settings(max_examples=150, deadline=None)
@given(paintings(), lying(), rooms, st.none() | trays(), st.none() | st.floats(0.01, 0.3))
def test_a_plan_is_refused_before_anything_moves_or_all_of_it_stays_inside(
    tmp_path_factory: pytest.TempPathFactory,
    painting: Painting,
    easel: Easel,
    limits: Limits,
    tray: Tray | None,
    speed: float | None,
) -> None:
    try:
        actions = routine(painting, easel, limits, tray, speed=speed)
    except InputError:
        return
    robot, path = Recorder(limits), tmp_path_factory.getbasetemp() / "inside.log.jsonl"
    with patch("os.fsync"), robot, Journal.open(path) as journal:
        execute(actions, robot, journal, lambda ask: None)  # the guard of the machine refuses nothing
    path.unlink(missing_ok=True)
    commanded = np.concatenate([path for _, path in robot.commands])
    assert np.all(commanded >= np.array(limits.lower) - SLACK)
    assert np.all(commanded <= np.array(limits.upper) + SLACK)
    strokes = [path for what, path in robot.commands if what == "stroke"]
    drawn = [path for path, action in zip(strokes, moving(actions), strict=True) if isinstance(action, Draw)]
    height = min(easel.machine_to_canvas(path)[:, 2].min() for path in drawn)
    assert height >= -(easel.deepest if limits.varies_pressure else 0) - SLACK


def moving(actions: Sequence[Action]) -> list[Draw | TrayVisit]:
    return [action for action in actions if not isinstance(action, Prompt)]


@settings(max_examples=100, deadline=None)
@given(paintings(), lying(), st.none() | trays())
def test_between_strokes_the_tip_keeps_its_height_above_the_paper(
    painting: Painting, easel: Easel, tray: Tray | None
) -> None:
    roomy = LIMITS.model_copy(update={"lower": (-2, -2, -2), "upper": (2, 2, 2)})
    try:
        actions = moving(routine(painting, easel, roomy, tray))
    except InputError:
        assume(False)
    for action, following in pairwise(actions):
        end = np.array([*action.motion.path[-1, :2], action.motion.after])
        way = easel.machine_to_canvas(np.linspace(end, following.motion.start, 9))
        least = easel.travel
        if isinstance(action, TrayVisit) or isinstance(following, TrayVisit):
            assert tray is not None
            least = tray.clearance
        assert way[:, 2].min() >= least - SLACK
