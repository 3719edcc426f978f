"""Whether an arm gets everywhere that a painting sends it, before anything moves."""

import re
from collections.abc import Callable, Collection
from contextlib import AbstractContextManager
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.jobs.paint.estimate import Estimate
from maulstick.jobs.paint.operator import Operator
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.request import PaintRequest
from maulstick.jobs.paint.session import paint, rehearse
from maulstick.jobs.paint.setup import PaintSetup
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import write_painting
from maulstick.robot.adapters.reaches import UFACTORY_REACHES, UR_REACHES
from maulstick.robot.adapters.ur import UR_LIMITS
from maulstick.robot.adapters.xarm import LITE6
from maulstick.robot.easel import Easel, write_easel
from maulstick.robot.execute import PaintProgress
from maulstick.robot.limits import Limits
from maulstick.robot.reach import Reach
from maulstick.robot.robot import StoppedError
from maulstick.robot.room import check_accepted
from maulstick.robot.routine import Prompt, routine, ways_of
from maulstick.robot.stops import Stops
from maulstick.robot.tray import Well
from maulstick.storage.arrays import Floats
from tests.support.robot.recorder import Recorder
from tests.support.robot.small_paintings import SIX, line, painting_of
from tests.support.robot.trays import TRAY

DOWNWARDS = np.diag([1.0, -1.0, -1.0])
LINES = painting_of([line(i, (0.01, 0.01 * i), (0.05, 0.01 * i)) for i in (1, 2, 3)])
MOVE = re.compile(r"; move the sheet (\d+) mm (nearer to|farther from) the base$")


def reaching(limits: Limits, reach: Reach) -> Limits:
    return limits.model_copy(update={"reach": reach.holding(DOWNWARDS, np.array([0.0, 0.0, 0.1]))})


UR3E = reaching(UR_LIMITS, UR_REACHES["UR3e"])


def at(x: float, y: float, z: float = 0.0) -> Easel:
    """Return an easel whose sheet lies with its upper left corner there, and its right edge along x."""
    return Easel(corner=(x, y, z), right=(1, 0, 0), down=(0, -1, 0), deepest=0.008)


def refused(painting: Painting, easel: Easel, limits: Limits = UR3E) -> str:
    with pytest.raises(InputError) as caught:
        routine(painting, easel, limits)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_plan_that_lies_in_the_box_but_beyond_the_arm_is_refused_with_place_and_where_to_lay_it() -> None:
    assert refused(LINES, at(0.6, 0.69)) == (
        "stroke 1, at x 50 and y 10 mm of the sheet, which is (650, 680, 5) mm of the machine, is 443 mm too far from "
        "the base of the UR3e, whose wrist gets 498 mm from its axis at that height (and 2 more like it); move the "
        "sheet 450 mm nearer to the base"
    )


def test_a_tray_is_moved_with_the_sheet_or_a_well_of_its_own() -> None:
    with pytest.raises(InputError, match=r"; move the sheet and the tray \d+ mm nearer to the base$"):
        routine(SIX, at(0.55, 0.6), UR3E, TRAY)
    far = TRAY.model_copy(update={"water": Well(x=-0.9, y=0.0, height=0.0)})
    with pytest.raises(InputError, match=r"^the rinse for paint 1, .* room: give the tray's file another place for"):
        routine(SIX, at(0.3, 0.03), UR3E, far)


def test_a_plan_that_lies_over_the_base_is_refused_with_where_to_lay_it() -> None:
    text = refused(LINES, at(0.1, 0.02))
    assert "is 106 mm too near to the base of the UR3e, whose wrist must stay 216 mm from its axis" in text
    assert text.endswith("; move the sheet 110 mm farther from the base")


@pytest.mark.parametrize(
    ("aside", "text"),
    [
        ((0.4, 0.0), "refill.at is where the machine does not go: is 2.* mm too far from the base of the UR3e"),
        ((-0.6, 0.02), "the way aside to the operator, at x .* is .* mm too near to the base of the UR3e"),
    ],
)
def test_where_a_pen_is_refilled_is_within_an_arms_reach_and_so_is_the_way_there(
    aside: tuple[float, float], text: str
) -> None:
    easel = at(0.3, 0.03)
    with pytest.raises(InputError, match=text):
        Stops(metres=0.05, aside=aside).put_into(routine(LINES, easel, UR3E), LINES, easel, UR3E)


@given(st.floats(-0.6, 0.6), st.floats(-0.6, 0.6), st.floats(-0.05, 0.1))
def test_a_sheet_that_is_moved_as_told_is_reached(x: float, y: float, z: float) -> None:
    easel = at(x, y, z)
    places = np.concatenate([way.path for way in ways_of(routine(LINES, easel, UR_LIMITS))])
    assert UR3E.reach is not None
    if not UR3E.reach.beyond(places).any():
        assert len(routine(LINES, easel, UR3E)) == 3
        return
    told = MOVE.search(refused(LINES, easel))
    assert told is not None
    middle = (places.min(axis=0) + places.max(axis=0))[:2] / 2
    ahead = (1 if told[2] == "farther from" else -1) * middle / np.linalg.norm(middle)
    dx, dy = (1e-3 * float(told[1]) * ahead).tolist()
    assert len(routine(LINES, at(x + dx, y + dy, z), UR3E)) == 3


def test_a_sheet_that_is_too_large_for_the_arm_is_said_to_be_that() -> None:
    wide = painting_of([line(1, (0.0, 0.2), (0.9, 0.2))], size=(0.9, 0.4))
    assert refused(wide, at(-0.45, 0.5)).endswith(
        "nowhere on its line from the base is there room: lay the sheet elsewhere, plan for a smaller one, "
        "or turn or scale an SVG with rotate or size"
    )


def test_a_way_from_stroke_to_stroke_through_the_base_is_refused_as_well() -> None:
    sides = painting_of([line(1, (0.0, 0.1), (0.05, 0.1)), line(2, (0.65, 0.1), (0.7, 0.1))], size=(0.7, 0.2))
    text = refused(sides, at(-0.35, 0.1))
    assert text.startswith("the way to stroke 2, at x ")
    assert "too near to the base" in text


def test_a_lite_6_refuses_the_corners_of_its_box() -> None:
    lite = reaching(LITE6, UFACTORY_REACHES[6, 9])
    assert "too far from the base of the Lite 6" in refused(LINES, at(0.325, 0.205, -0.04), lite)
    assert len(routine(LINES, at(0.2, 0.02), lite)) == 3


def test_limits_without_a_reach_are_a_box_and_keep_it_where_they_are_narrowed() -> None:
    assert len(routine(LINES, at(0.1, 0.02), UR_LIMITS)) == 3
    assert UR_LIMITS.narrowed(UR3E) == UR3E.narrowed(UR_LIMITS) == UR3E


# The machine itself is asked.


class Knowing(Recorder):
    """Recorder that knows where it gets to, and counts what it is asked."""

    knows_its_reach = True

    def __init__(self, gets_to: Callable[[Floats], bool]) -> None:
        super().__init__(UR3E)
        self.asked: list[Floats] = []
        self._gets_to = gets_to

    def easel(self, width: float, height: float) -> Easel:
        raise InputError("it stands nowhere")

    def _accepts(self, place: Floats) -> bool:
        self.asked.append(place)
        return self._gets_to(place)


def test_a_place_that_the_machine_refuses_is_named_with_where_it_would_not_refuse() -> None:
    robot = Knowing(lambda place: bool(place[0] < 0.332))
    with pytest.raises(InputError) as caught:
        check_accepted(ways_of(routine(LINES, at(0.3, 0.02), UR3E)), at(0.3, 0.02), robot)
    assert str(caught.value) == (
        "stroke 1, at x 40 and y 10 mm of the sheet, which is (340, 10, -4) mm of the machine, is refused by the "
        "machine itself: by the range of a joint, a singular pose, itself in its way, or a boundary that is set "
        "there; move the sheet 20 mm nearer to the base"
    )
    assert robot.commands == [], "nothing moved"


def test_a_machine_that_gets_nowhere_near_is_said_to_have_no_room() -> None:
    robot = Knowing(lambda place: False)
    with pytest.raises(InputError, match="nowhere on its line from the base is there room"):
        check_accepted(ways_of(routine(LINES, at(0.3, 0.02), UR3E)), at(0.3, 0.02), robot)


def test_every_place_of_a_plan_is_asked_for_to_the_millimetre_and_none_twice() -> None:
    rng = np.random.default_rng(0)
    ends = rng.uniform(0.0, 0.12, (200, 2, 2))
    lines = [line(i, tuple(a), tuple(b)) for i, (a, b) in enumerate([*ends.tolist(), *ends.tolist()])]
    scribble = painting_of(lines, size=(0.12, 0.12))
    ways = ways_of(routine(scribble, at(0.3, 0.06), UR3E))
    robot = Knowing(lambda place: True)
    check_accepted(ways, at(0.3, 0.06), robot)
    asked, places = (
        np.floor(1e3 * np.array(some)) for some in (robot.asked, [*chain.from_iterable(way.path for way in ways)])
    )
    assert len(np.unique(asked, axis=0)) == len(asked) < len(places)
    assert set(map(tuple, asked)) == set(map(tuple, places))


def test_a_single_place_in_the_middle_of_a_painting_that_is_refused_is_found() -> None:
    ways = ways_of(routine(LINES, at(0.3, 0.02), UR3E))
    refused_at = ways[1].path[len(ways[1].path) // 2]
    robot = Knowing(lambda place: not np.array_equal(place, refused_at))
    with pytest.raises(InputError, match="refused by the machine itself"):
        check_accepted(ways, at(0.3, 0.02), robot)


def test_a_stop_ends_the_asking() -> None:
    robot = Knowing(lambda place: True)
    robot.stop()
    with pytest.raises(StoppedError):
        check_accepted(ways_of(routine(LINES, at(0.3, 0.02), UR3E)), at(0.3, 0.02), robot)
    assert robot.asked == []


def test_a_machine_that_does_not_know_is_not_asked() -> None:
    robot = Recorder(UR3E)
    assert not robot.knows_its_reach
    assert robot.accepts(np.zeros(3)), "it says yes"
    check_accepted(ways_of(routine(LINES, at(0.3, 0.02), UR3E)), at(0.3, 0.02), robot)
    check_accepted([], at(0.3, 0.02), Knowing(lambda place: False))


class Nobody(Operator):
    """Operator who is not to be asked or told anything before the machine moves."""

    @classmethod
    def at(cls, setup: PaintSetup, done: Collection[int]) -> "Nobody":
        return cls(setup.robot)

    def expect(self, estimate: Estimate) -> None:
        raise AssertionError

    def on_duty(self) -> AbstractContextManager[None]:
        raise AssertionError

    def watch(self, progress: PaintProgress) -> None:
        raise AssertionError

    def ask(self, action: Prompt) -> None:
        raise AssertionError

    def note(self, sentence: str) -> None:
        raise AssertionError

    def show(self, photograph: Path) -> None:
        raise AssertionError

    def expect_plan(self, painting: Painting) -> None:
        raise AssertionError

    def leave(self, photograph: Path) -> None:
        raise AssertionError

    def wants_a_look(self) -> bool:
        return False


@pytest.mark.parametrize(
    ("corner", "gets_to", "fault"),
    [
        ((0.6, 0.69), lambda place: True, "too far from the base of the UR3e"),
        ((0.3, 0.02), lambda place: False, "is refused by the machine itself"),
    ],
)
def test_a_dry_run_says_it_too_and_moves_nothing(
    tmp_path: Path, corner: tuple[float, float], gets_to: Callable[[Floats], bool], fault: str
) -> None:
    write_painting(LINES, tmp_path / "painting.json")
    write_easel(at(*corner), tmp_path / "easel.json")
    robot = Knowing(gets_to)
    options = PaintOptions(robot="ur:127.0.0.1", easel=tmp_path / "easel.json")
    with pytest.raises(InputError, match=fault):
        rehearse(PaintRequest(tmp_path / "painting.json", options, robot=robot))
    assert robot.said == ["close"], "nothing moved"
    with pytest.raises(InputError, match=fault):
        paint(PaintRequest(tmp_path / "painting.json", options, robot=robot), lambda stroke: True, Nobody.at)
    assert robot.said == ["close", "close"], "nor when it is painted: the machine is never entered"


def test_a_machine_is_asked_for_where_a_pen_is_refilled_before_it_is_moved(tmp_path: Path) -> None:
    write_painting(LINES, tmp_path / "painting.json")
    write_easel(at(0.3, 0.02), tmp_path / "easel.json")
    robot = Knowing(lambda place: bool(place[0] > 0.305))
    options = PaintOptions(
        robot="ur:127.0.0.1", easel=tmp_path / "easel.json", refill_after="0.05m", refill_at=(0.0, 0.0)
    )
    with pytest.raises(InputError, match=r"the way aside to the operator, .* is refused by the machine itself"):
        rehearse(PaintRequest(tmp_path / "painting.json", options, robot=robot))
    assert robot.said == ["close"]


def test_an_operator_who_stops_a_machine_that_is_still_being_asked_is_heard(tmp_path: Path) -> None:
    write_painting(LINES, tmp_path / "painting.json")
    write_easel(at(0.3, 0.02), tmp_path / "easel.json")
    operators: list[Nobody] = []

    def stopping(place: Floats) -> bool:
        operators[0].stop()
        return True

    def operator_for(setup: PaintSetup, done: Collection[int]) -> Nobody:
        operators.append(Nobody.at(setup, done))
        return operators[0]

    robot = Knowing(stopping)
    options = PaintOptions(robot="ur:127.0.0.1", easel=tmp_path / "easel.json")
    with pytest.raises(StoppedError):
        paint(PaintRequest(tmp_path / "painting.json", options, robot=robot), lambda stroke: True, operator_for)
    assert robot.said == ["close"], "nothing moved"
