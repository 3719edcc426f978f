"""Desk: each task is answered, and whatever happens to one, the next is done."""

import asyncio
import re
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest

from maulstick.errors import MaulstickError
from maulstick.studio.state.gallery import keep_picture
from maulstick.studio.workers.desk import Desk
from tests.support.studio import work
from tests.support.studio.processes import PATIENCE
from tests.support.without_torch import TAUGHT, hide_torch


@pytest.fixture(scope="module", autouse=True)
def warm() -> None:
    """Spawn processes as the studio does, in place of what spares the other tests the time."""


def at_a_desk(do: Callable[[Desk], Coroutine[Any, Any, None]]) -> None:
    async def working() -> None:
        desk = Desk()
        try:
            await asyncio.wait_for(do(desk), PATIENCE)
        finally:
            desk.close()

    asyncio.run(working())


def test_work_is_done_in_one_process_that_is_not_the_studios() -> None:
    async def do(desk: Desk) -> None:
        assert await asyncio.gather(*(desk.do(work.double, number) for number in range(50))) == list(range(0, 100, 2))
        assert len({await desk.do(work.who) for _ in range(3)}) == 1

    at_a_desk(do)


@pytest.mark.parametrize(
    ("task", "why"),
    [
        (work.task_refused, "there is no such brush"),
        (work.task_broken, "something in Maulstick is broken: ZeroDivisionError: no reason"),
        (work.task_died, "the work was killed, most likely for want of memory; try again with less"),
        (work.task_left, "the work ended without a word; try it again"),
        (work.task_that_leaves, "the work ended without a word; try it again"),
        (work.task_swelled, "that needs more memory than there is for it; try it with something smaller"),
        (work.task_of_no_answer, "something in Maulstick is broken: "),
    ],
)
def test_the_next_work_is_done_at_once_whatever_became_of_the_last(task: Callable[[], object], why: str) -> None:
    async def do(desk: Desk) -> None:
        for _ in range(2):
            with pytest.raises(MaulstickError) as refused:
                await desk.do(task)
            assert str(refused.value).startswith(why)
            assert await desk.do(work.double, 2) == 4

    at_a_desk(do)


def test_without_torch_what_needs_it_says_how_to_install_it_and_the_rest_is_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", hide_torch(tmp_path))

    async def do(desk: Desk) -> None:
        with pytest.raises(MaulstickError, match=re.escape(TAUGHT)):
            await desk.warm_up()
        assert await desk.do(work.double, 2) == 4

    at_a_desk(do)


def test_work_that_takes_too_long_is_given_up() -> None:
    async def do(desk: Desk) -> None:
        await desk.do(work.double, 1)
        with (
            patch("maulstick.studio.workers.desk._LONGEST", 0.05),
            pytest.raises(MaulstickError, match="that took longer than 0 s and was given up; try something smaller"),
        ):
            await desk.do(work.sleep, 3600)
        assert await desk.do(work.double, 3) == 6

    at_a_desk(do)


def test_nobody_gets_the_answer_to_what_another_asked_and_left() -> None:
    async def do(desk: Desk) -> None:
        for moment in (0.0, 0.01, 0.3):
            left = asyncio.create_task(desk.do(work.double, 100))
            await asyncio.sleep(moment)
            left.cancel()
            assert await desk.do(work.double, 3) == 6

    at_a_desk(do)


def test_a_process_that_is_lost_while_it_waits_costs_one_answer_at_most() -> None:
    async def do(desk: Desk) -> None:
        await desk.do(work.double, 1)
        process = desk._process
        assert process is not None
        process.kill()
        with pytest.raises(MaulstickError, match="the work was killed"):
            await desk.do(work.double, 2)
        assert await desk.do(work.double, 3) == 6

    at_a_desk(do)


@pytest.mark.parametrize("refused", [False, True])
def test_a_process_without_work_is_let_go_and_comes_back_with_the_next(refused: bool) -> None:
    async def do() -> None:
        desk = Desk(idle=0.2)
        first = await desk.do(work.who)
        if refused:
            with pytest.raises(MaulstickError):
                await desk.do(work.task_refused)
        async with asyncio.timeout(PATIENCE):
            while desk._process is not None:
                await asyncio.sleep(0.02)
        assert await desk.do(work.who) != first
        desk.close()

    asyncio.run(do())


def test_large_work_is_told_while_the_studio_goes_on() -> None:
    async def do(desk: Desk) -> None:
        beats = 0

        async def beat() -> None:
            nonlocal beats
            while True:
                beats += 1
                await asyncio.sleep(0.01)

        beating = asyncio.create_task(beat())
        assert await desk.do(work.length, bytes(20_000_000)) == 20_000_000
        assert len(await desk.do(work.same, bytes(20_000_000))) == 20_000_000
        beating.cancel()
        assert beats > 5

    at_a_desk(do)


def test_a_picture_that_is_none_is_a_sentence_and_the_desk_goes_on(tmp_path: Path) -> None:
    (tmp_path / "brought.png").write_bytes(b"<svg/>")

    async def do(desk: Desk) -> None:
        with pytest.raises(MaulstickError, match="is not a picture that can be read; save it as one of"):
            await desk.do(keep_picture, tmp_path / "brought.png", tmp_path / "kept")
        assert await desk.do(work.double, 3) == 6

    at_a_desk(do)
