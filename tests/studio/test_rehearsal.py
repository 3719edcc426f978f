"""Pens as they are asked for: on the simulated easel as on the machine it stands for, each with how long it draws."""

import asyncio
from pathlib import Path

import pytest

from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.turns import Turn, in_minutes
from maulstick.robot.easel import Easel, Pen, write_easel
from maulstick.studio.state.run import Run
from maulstick.studio.workers.plan_pictures import rehearsed_sheet
from tests.studio.test_run import events, opened, outcome
from tests.support.robot.fake_grbl import FakeGrbl
from tests.support.robot.small_paintings import SIX, line, painting_of
from tests.support.studio.plans_to_paint import STROKES, put_plan

_LONG = 60  # strokes of 50 mm at 30 mm/s: more than a minute
pytestmark = pytest.mark.usefixtures("data")

UNEVEN = painting_of(
    line(i, (0.005, 0.0006 * i), (0.055, 0.0006 * i), paint=int(i < _LONG), speed=0.03) for i in range(_LONG + 1)
)


@pytest.fixture
def plotter(tmp_path: Path) -> Path:
    """Write an easel file of a plotter with a servo; return its path."""
    path = tmp_path / "easel.json"
    pen = Pen(up=200, down=700, seconds=0.01)
    write_easel(Easel(corner=(0, 0.04, 0), right=(1, 0, 0), down=(0, -1, 0), pen=pen), path)
    return path


async def answered(run: Run) -> list[str]:
    """Do all that a run asks for until it ends; return what that was."""
    asked: list[str] = []
    while run.is_busy:
        if run.state.question:
            asked.append(run.state.question)
            run.done(run.state.question_number)
        await asyncio.sleep(0.02)
    return asked


def paint(root: Path, name: str, options: PaintOptions) -> list[str]:
    """Paint a plan to its end; return what was asked for on the way."""

    async def begin() -> list[str]:
        async with opened(root) as run:
            await run.begin(name, options)
            asked = await answered(run)
            assert run.state.sentence == f"{name} is painted."
            return asked

    return asyncio.run(begin())


def test_the_easel_asks_for_pens_as_the_plotter_it_stands_for_and_nothing_has_to_be_mixed(
    tmp_path: Path, plotter: Path
) -> None:
    put_plan(tmp_path, "rehearsed", SIX, mixed=False)
    put_plan(tmp_path, "real", SIX)
    asked = paint(tmp_path, "rehearsed", PaintOptions(robot="sim:pens"))
    assert asked == [
        f"put in the marker with {pen}; it draws for less than 1 min" for pen in ("paint 1 (red)", "paint 2 (blue)")
    ]
    with FakeGrbl(pace=100.0) as device:
        assert paint(tmp_path, "real", PaintOptions(robot=f"grbl:{device.port}", easel=plotter)) == asked


def test_the_picture_of_a_rehearsal_stays_until_a_real_machine_is_there(tmp_path: Path, plotter: Path) -> None:
    painting = put_plan(tmp_path, "rehearsed", SIX)
    paint(tmp_path, "rehearsed", PaintOptions(robot="sim"))

    async def begin(port: str) -> str:
        async with opened(tmp_path) as run:
            await run.begin("rehearsed", PaintOptions(robot=f"grbl:{port}", easel=plotter))
            await answered(run)
            return run.state.sentence

    assert "is it plugged in" in asyncio.run(begin("/dev/ttyNONE"))
    assert rehearsed_sheet(painting).is_file()
    with FakeGrbl(pace=1000.0) as device:
        assert asyncio.run(begin(device.port)) == "rehearsed is painted."
    assert not rehearsed_sheet(painting).is_file()


def test_the_easel_with_a_tray_asks_for_nothing_and_nothing_has_to_be_mixed(tmp_path: Path) -> None:
    put_plan(tmp_path, "six", SIX, mixed=False)
    assert paint(tmp_path, "six", PaintOptions(robot="sim")) == []


def test_one_pen_is_asked_for_once_before_a_plotter_starts_though_nobody_ticked_it(
    tmp_path: Path, plotter: Path
) -> None:
    painting = put_plan(tmp_path, "lines", mixed=False)

    async def begin() -> None:
        async with opened(tmp_path) as run:
            await run.begin("lines", PaintOptions(robot=f"grbl:{device.port}", easel=plotter))
            while not run.state.question:
                assert run.is_busy, run.state.sentence
                await asyncio.sleep(0.02)
            assert run.state.question.startswith("put in the marker with paint 1 (red); it draws for less than 1 min")
            assert events(painting, "begin") == []
            run.done(run.state.question_number)
            assert await answered(run) == []
            assert run.state.sentence == "lines is painted."

    with FakeGrbl(pace=100.0) as device:
        asyncio.run(begin())
    assert sorted(events(painting, "end")) == list(range(STROKES))


def test_a_check_says_in_which_order_pens_come_and_how_long_each_draws(tmp_path: Path) -> None:
    put_plan(tmp_path, "uneven", UNEVEN, mixed=False)

    async def check() -> list[Turn]:
        async with opened(tmp_path) as run:
            run.check("uneven", PaintOptions(robot="sim:pens"))
            assert await outcome(run) == "It fits."
            assert run.state.estimate is not None
            turns = run.state.estimate.turns
            assert sum(turn.seconds for turn in turns) == pytest.approx(run.state.estimate.seconds)
            return [*turns]

    turns = asyncio.run(check())
    assert [turn.paint for turn in turns] == [UNEVEN.paints[turn.index] for turn in turns]
    minutes = {turn.index: in_minutes(turn.seconds) for turn in turns}
    assert minutes == {0: "less than 1 min", 1: "about 3 min"}
    names = ("paint 1 (red)", "paint 2 (blue)")
    assert paint(tmp_path, "uneven", PaintOptions(robot="sim:pens")) == [
        f"put in the marker with {names[turn.index]}; it draws for {minutes[turn.index]}" for turn in turns
    ]
