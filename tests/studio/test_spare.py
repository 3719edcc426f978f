"""A process that waits for work: it does the first that comes, and goes where none does."""

import asyncio
import multiprocessing
from collections.abc import Callable

import pytest

from maulstick.studio.workers.spare import Spare
from tests.support.studio import work
from tests.support.studio.processes import PATIENCE, have_ended

LOADED = "maulstick.colour.palette"


@pytest.fixture(scope="module", autouse=True)
def warm() -> None:
    """Spawn processes as the studio does, in place of what spares the other tests the time."""


async def until(condition: Callable[[], bool]) -> None:
    async with asyncio.timeout(PATIENCE):
        while not condition():
            await asyncio.sleep(0.02)


def children() -> set[int | None]:
    return {child.pid for child in multiprocessing.active_children()}


async def said_by(spare: Spare, *arguments: object) -> list[object]:
    """Return what the spare's work says, and None for its end."""
    said, over = list[object](), asyncio.Event()

    def ended() -> None:
        said.append(None)
        over.set()

    process = spare.begin(*arguments, hear=said.append, ended=ended)
    try:
        await asyncio.wait_for(over.wait(), PATIENCE)
    finally:
        process.kill()
    return said


def test_the_process_that_waits_does_the_work_with_its_modules_loaded() -> None:
    async def working() -> None:
        spare, before = Spare(work.say_loaded, LOADED), children()
        spare.be_ready()
        spare.be_ready()
        (waiting,) = children() - before
        said = await said_by(spare, LOADED)
        assert said == [(waiting, True), None]
        assert not spare.is_ready
        other = await said_by(spare, LOADED)
        assert other[0] != (waiting, True), "the next has a process of its own"

    asyncio.run(working())


@pytest.mark.parametrize("idle", [0.2, PATIENCE])
def test_it_goes_where_no_work_comes_and_when_the_studio_closes(idle: float) -> None:
    async def waiting() -> None:
        spare, before = Spare(work.count, idle=idle), children()
        spare.be_ready()
        new = children() - before
        if idle == PATIENCE:
            spare.close()
        await until(lambda: not spare.is_ready)
        assert have_ended(pid for pid in new if pid)

    asyncio.run(waiting())


def test_one_that_cannot_load_its_modules_is_given_up_and_work_has_a_process_of_its_own() -> None:
    async def working() -> None:
        spare = Spare(work.count, "maulstick.no_such_module")
        spare.be_ready()
        await until(lambda: not spare.is_ready)
        assert await said_by(spare, 3) == [0, 1, 2, None]

    asyncio.run(working())
