"""Work in processes of its own: its end is always reported, and it ends when the studio is gone."""

import asyncio
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from maulstick.studio.workers.process import Failed, Process
from tests.support.studio import work
from tests.support.studio.processes import PATIENCE, have_ended


@pytest.fixture(scope="module", autouse=True)
def warm() -> None:
    """Spawn processes as the studio does, in place of what spares the other tests the time."""


def said_by(
    what: Callable[..., None], *arguments: object, meanwhile: Callable[[Process], None] = lambda _: None
) -> list[object]:
    """Collect all messages of some work; None stands for its end."""

    async def listening() -> list[object]:
        said, over = list[object](), asyncio.Event()

        def ended() -> None:
            said.append(None)
            over.set()

        process = Process(what, *arguments, hear=said.append, ended=ended)
        meanwhile(process)
        try:
            await asyncio.wait_for(over.wait(), PATIENCE)
        finally:
            process.kill()
        await asyncio.sleep(0.05)
        return said

    return asyncio.run(listening())


def test_many_words_come_in_their_order_and_then_the_end() -> None:
    assert said_by(work.count, 5000) == [*range(5000), None]


def test_large_words_go_both_ways_before_anybody_listens() -> None:
    words = [bytes([number]) * 10_000_000 for number in range(3)]
    took = list[float]()

    async def talking() -> list[object]:
        said, heard = list[object](), asyncio.Event()

        def hear(word: object) -> None:
            said.append(word)
            if len(said) == len(words):
                heard.set()

        process = Process(work.echo, hear=hear, ended=lambda: None)
        for word in words:
            process.tell(word)
        took.append(len(said))
        try:
            await asyncio.wait_for(heard.wait(), PATIENCE)
        finally:
            process.kill()
        return said

    assert asyncio.run(talking())[: len(words)] == words
    assert took == [0], "telling waited for the work to listen"


@pytest.mark.parametrize(
    ("what", "why"),
    [
        (work.refuse, "there is no such brush"),
        (work.break_down, "something in Maulstick is broken: ZeroDivisionError: no reason"),
        (work.swell, "that needs more memory than there is for it; try it with something smaller"),
        (work.die, "the work was killed, most likely for want of memory; try again with less"),
    ],
)
def test_work_that_cannot_be_done_says_why_once(what: Callable[..., None], why: str) -> None:
    assert said_by(what) == [Failed(why), None]


def test_work_that_says_nothing_has_ended() -> None:
    assert said_by(work.leave) == [None]


def test_what_is_told_to_work_that_is_over_is_lost_without_harm() -> None:
    def tell_late(process: Process) -> None:
        assert process.join(PATIENCE)
        for _ in range(3):
            process.tell(bytes(10_000_000))

    assert said_by(work.leave, meanwhile=tell_late) == [None]


def test_work_that_is_killed_by_a_person_has_ended() -> None:
    assert said_by(work.echo, meanwhile=lambda process: process.kill())[-1] is None


def test_ctrl_c_is_the_studios_own_matter(tmp_path: Path) -> None:
    ready, alone = tmp_path / "ready", tmp_path / "alone"

    def interrupt(process: Process) -> None:
        until = time.monotonic() + PATIENCE
        while not (ready.exists() and ready.read_text()):
            assert time.monotonic() < until
            time.sleep(0.02)
        os.kill(int(ready.read_text()), signal.SIGINT)
        process.tell("still there")

    assert said_by(work.wait_until_alone, ready, alone, meanwhile=interrupt) == ["still there", None]


def test_ctrl_c_does_not_disturb_work_that_has_hardly_begun() -> None:
    def interrupt(process: Process) -> None:
        os.kill(process._process.pid or 0, signal.SIGINT)

    assert said_by(work.count, 3, meanwhile=interrupt) == [0, 1, 2, None]


def test_work_whose_studio_is_killed_ends_by_itself(tmp_path: Path) -> None:
    ready, alone = tmp_path / "ready", tmp_path / "alone"
    studio = subprocess.Popen([sys.executable, "-c", _STUDIO, str(ready), str(alone)])
    until = time.monotonic() + PATIENCE
    while not (ready.exists() and ready.read_text()):
        assert time.monotonic() < until
        time.sleep(0.02)
    child = int(ready.read_text())
    os.kill(child, 0)
    studio.kill()
    studio.wait()
    assert have_ended([child])
    assert alone.exists()


_STUDIO = """
import asyncio, sys
from pathlib import Path
from maulstick.studio.workers.process import Process
from tests.support.studio import work

async def keep():
    Process(work.wait_until_alone, *map(Path, sys.argv[1:]), hear=print, ended=lambda: None)
    await asyncio.sleep(3600)

asyncio.run(keep())
"""
