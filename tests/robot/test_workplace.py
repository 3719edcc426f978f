from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from maulstick.api.machine import paint
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.request import PaintRequest
from maulstick.jobs.paint.session import rehearse
from maulstick.painting.painting_file import write_painting
from maulstick.robot.adapters.axidraw import V3
from maulstick.robot.execute import PaintProgress
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.routine import Draw, PaintLoad, Prompt
from maulstick.robot.stops import Stops
from maulstick.robot.workplace import Workplace, home_of
from tests.support.robot.fake_ebb import FakeEbb
from tests.support.robot.recorder import EASEL, Recorder
from tests.support.robot.small_paintings import SIX, line, painting_of
from tests.support.robot.trays import TRAY
from tests.support.tolerances import FLOAT64_METRES_NEAR

IDS = list(range(10, 16))


@pytest.fixture
def place(tmp_path: Path) -> Workplace:
    """Workplace with a journal that says that stroke 11 is painted; its machine is not entered yet."""
    write_painting(SIX, tmp_path / "painting.json")
    with Journal.open(journal_of(tmp_path / "painting.json")) as journal:
        journal.revise(tmp_path / "painting.json", painted=[11])
    journal.painted.add(11)
    return Workplace(Recorder(), EASEL, journal, lambda ask: None)


def test_what_is_left_are_the_strokes_that_the_journal_does_not_know(place: Workplace) -> None:
    actions = place.left_of(SIX)
    assert [action.stroke for action in actions if isinstance(action, Draw)] == [10, 12, 13, 14, 15]
    assert [action.paint for action in actions if isinstance(action, Prompt)] == [0, 1]
    assert [action.paint for action in place.left_of(SIX, PaintLoad(0)) if isinstance(action, Prompt)] == [1]


def test_what_is_left_is_ordered_from_where_the_tip_is_and_what_is_painted_stays_first(place: Workplace) -> None:
    with place.robot:
        place.robot.move(np.array([0.01, -0.02, 0.01]))
        ordered = place.in_order(SIX)
    ids = [stroke.id for stroke in ordered.strokes]
    assert ids[0] == 11
    assert sorted(ids) == IDS
    assert ids[1] == 12, "the red stroke that is nearest"


def test_with_all_painted_there_is_nothing_to_order_and_nothing_to_do(place: Workplace) -> None:
    place.journal.painted.update(IDS)
    with place.robot:
        assert place.in_order(SIX) == SIX
        assert place.do(place.left_of(SIX), PaintLoad(1, 0.02)) == PaintLoad(1, 0.02)


def test_a_dry_run_counts_the_ways_home_for_other_pens_as_the_run_does(tmp_path: Path) -> None:
    for pens in (1, 2):
        far = (line(i, (0.2, 0.1 + 0.005 * i), (0.25, 0.1 + 0.005 * i), paint=i * pens // 6) for i in range(6))
        write_painting(painting_of(far, size=(0.29, 0.2)), tmp_path / f"{pens}.json")
    seen: list[PaintProgress] = []
    with FakeEbb(pace=1000.0) as device:
        options = PaintOptions(robot=f"axidraw:{device.port}")
        one, two = (rehearse(PaintRequest(tmp_path / f"{pens}.json", options)) for pens in (1, 2))
        paint(tmp_path / "2.json", options.machine, progress=seen.append, ask=lambda message: None)
    assert two.seconds > one.seconds + 2 * 0.2 / V3.speed
    assert two.seconds == pytest.approx(seen[0].left)


@pytest.mark.parametrize("is_plotter", [True, False])
def test_a_plotter_goes_home_while_its_pen_is_changed_or_refilled(
    place: Workplace, monkeypatch: pytest.MonkeyPatch, is_plotter: bool
) -> None:
    monkeypatch.setattr(Recorder, "counts_steps", is_plotter)
    monkeypatch.setattr(Recorder, "home", np.array([0.0, 0.0]) if is_plotter else None)
    where: list[tuple[str, tuple[float, ...]]] = []

    def ask(asked: Prompt) -> None:
        where.append((asked.message[:6], tuple(place.robot.place[:2])))

    aside = Prompt("refill the pen", 1, aside=(0.02, 0.01, 0.0))
    with Journal.open(place.journal.path) as journal, place.robot:
        asking = replace(place, journal=journal, ask=ask, stops=Stops(pauses={14: 2}))
        asking.do([*asking.left_of(SIX), aside])
    assert [message for message, _ in where] == ["put in", "put in", "do wha", "refill"]
    at_home = [at == (0.0, 0.0) for _, at in where]
    assert at_home == ([True, True, False, False] if is_plotter else [False] * 4), "a pause is where it is"
    assert where[-1][1] == (0.02, 0.01), "where it is asked to be"


def test_one_that_homes_by_itself_goes_where_the_run_began_though_it_stands_over_the_sheet_before(
    place: Workplace, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Recorder, "counts_steps", True)
    where: list[tuple[float, ...]] = []
    with Journal.open(place.journal.path) as journal, place.robot as robot:
        began = robot.place
        journal.write_home(began)
        robot.move(np.array([0.02, -0.02, 0.01]))
        asking = replace(place, journal=journal, ask=lambda asked: where.append(tuple(robot.place[:2])))
        asking.do(asking.left_of(SIX))
    assert where == [tuple(began[:2])] * 2


def test_a_home_beside_the_limits_is_the_nearest_place_within_them(
    place: Workplace, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Recorder, "counts_steps", True)
    robot, asked = Recorder(), list[str]()
    robot.stands = np.array([-0.3, 0.0, 0.05])
    with Journal.open(place.journal.path) as journal, robot:
        assert home_of(robot, journal) == pytest.approx(np.array([-0.1, 0.0, 0.05]))
        asking = replace(place, robot=robot, journal=journal, ask=lambda prompt: asked.append(prompt.message))
        asking.do(asking.left_of(SIX))
    assert len(asked) == 2, "the second pen, too, is asked for where the machine may go"


def test_the_tip_steps_aside_lifted_and_never_lower_than_it_is(place: Workplace) -> None:
    with place.robot:
        place.robot.move(np.array([0.02, -0.02, 0.01]))
        place.step_aside(np.array([0.1, 0.05, 0.06]))
        assert place.robot.place == pytest.approx([0.1, 0.05, 0.06])
        place.step_aside(np.array([0.0, 0.0, 0.02]))
        assert place.robot.place == pytest.approx([0.0, 0.0, 0.06])
        place.step_aside(np.array([9.0, 0.0, 0.0]))
        assert place.robot.place[0] == place.robot.limits.upper[0]


def test_a_machine_without_a_home_waits_where_it_stood_when_its_journal_was_begun(tmp_path: Path) -> None:
    write_painting(SIX, tmp_path / "painting.json")
    began = np.array([0.1, 0.05, 0.06])
    with Recorder() as robot:
        with Journal.open(journal_of(tmp_path / "painting.json")) as journal:
            journal.revise(tmp_path / "painting.json")
            assert home_of(robot, journal) == pytest.approx(robot.place), "of a journal that knows no place"
            journal.write_home(began)
            assert home_of(robot, journal) == pytest.approx(robot.place), "nothing is drawn yet"
            journal.begin(10)
        with Journal.open(journal_of(tmp_path / "painting.json")) as journal:
            assert home_of(robot, journal) == pytest.approx(began)


def test_when_the_sheet_is_moved_the_tray_stands_where_it_stood(place: Workplace) -> None:
    with_tray = Workplace(place.robot, EASEL, place.journal, place.ask, tray=TRAY)
    moved = with_tray.moved_to(EASEL.shifted(0.008, -0.002, 0.05))
    assert moved.easel != EASEL
    assert moved.tray is not None
    for before, after in (
        *zip(TRAY.paints.values(), moved.tray.paints.values(), strict=True),
        (TRAY.water, moved.tray.water),
        (TRAY.cloth, moved.tray.cloth),
    ):
        assert after.x != pytest.approx(before.x, abs=1e-3)
        there = moved.easel.canvas_to_machine(np.array([after.x, after.y, after.height]))
        assert there == pytest.approx(
            EASEL.canvas_to_machine(np.array([before.x, before.y, before.height])), abs=FLOAT64_METRES_NEAR
        )
        assert (after.radius, after.turns) == (before.radius, before.turns)
    assert place.moved_to(moved.easel).tray is None
