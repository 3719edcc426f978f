"""Copies and pauses of a run, without a page: a real process, and a plotter on a pseudo-terminal."""

import asyncio
from pathlib import Path

import pytest

from maulstick.jobs.paint.options import PaintOptions
from maulstick.robot.journal import Journal, journal_of
from maulstick.studio.panels.paint.paint import _begun_text
from maulstick.studio.state.run import Run
from maulstick.studio.workers.messages import Done
from tests.studio.test_run import confirm_where_it_stands, opened, outcome, put_in, stroke, until
from tests.support.robot.fake_ebb import FakeEbb
from tests.support.robot.small_paintings import line, painting_of
from tests.support.studio.plans_to_paint import put_plan

pytestmark = pytest.mark.usefixtures("data")

FOUR = painting_of([line(i, (0.005, 0.002 * i), (0.035, 0.002 * i)) for i in range(4)])
SECOND = "put in a new sheet for copy 2 of 2"
PAUSE = "do what the pause before stroke 3 is for"


async def answer(run: Run, question: str) -> int:
    """Wait for a request that begins so, and answer it; return its number."""
    await until(run, lambda: run.state.question.startswith(question))
    number = run.state.question_number
    run.done(number)
    return number


def sheets_to_follow(run: Run) -> int | None:
    """Return how many sheets follow the present one, None before that is known."""
    return None if run.state.estimate is None else run.state.estimate.more_sheets


def painted(painting: Path, sheet: int) -> set[int]:
    """Return the ids of the strokes that are painted on a sheet."""
    return {*Journal.read(journal_of(painting, sheet)).painted}


def test_each_copy_asks_for_its_sheet_and_pauses_where_it_was_told(tmp_path: Path) -> None:
    painting, asked = put_plan(tmp_path, "four", FOUR), list[int]()

    async def paint() -> None:
        async with opened(tmp_path) as run:
            options = PaintOptions(robot=f"axidraw:{device.port}", copies=2, pause_at=(3,))
            await run.begin("four", options)
            asked.append(await answer(run, "put in the marker"))
            asked.append(await answer(run, PAUSE))
            assert sheets_to_follow(run) == 1
            await until(run, lambda: run.state.question.startswith(SECOND))
            assert run._process is not None
            run._process.tell(Done(asked[0]))  # a click that was late
            await asyncio.sleep(0.5)
            assert painted(painting, 2) == set()
            asked.append(await answer(run, SECOND))
            await until(run, lambda: run.state.question.startswith(PAUSE))
            assert sheets_to_follow(run) == 0
            run.stop()
            assert await outcome(run) == "You stopped it. The pen is lifted."

            status = await run.status("four")
            assert status is not None
            assert (status.sheet, status.painted, status.is_over) == (2, 2, False)
            begun = "It was begun: 2 of 4 strokes are painted on sheet 2 of 2."
            assert _begun_text(status).startswith(begun)
            await run.resume("four", status.options, None)
            await confirm_where_it_stands(run)
            asked.append(await answer(run, "put in the marker"))
            asked.append(await answer(run, PAUSE))
            assert await outcome(run) == "four is painted."
            status = await run.status("four")
            assert status is not None
            assert status.is_over

    with FakeEbb(pace=50.0) as device:
        asyncio.run(paint())
    assert painted(painting, 1) == painted(painting, 2) == {0, 1, 2, 3}
    assert asked[:3] == [1, 2, 3]


def test_a_pause_at_the_end_of_a_sheet_holds_the_next_one(tmp_path: Path) -> None:
    painting = put_plan(tmp_path, "four", FOUR)

    async def paint() -> None:
        async with opened(tmp_path) as run:
            await run.begin("four", PaintOptions(robot=f"axidraw:{device.port}", copies=2))
            await put_in(run, "marker")
            await until(run, lambda: stroke(run) == 4)
            run.pause()
            await until(run, journal_of(painting, 2).exists)
            await asyncio.sleep(0.5)
            assert (run.state.held, run.state.question) == (True, "")
            run.go_on()
            await answer(run, SECOND)
            assert await outcome(run) == "four is painted."

    with FakeEbb(pace=1.0) as device:
        asyncio.run(paint())
