"""Checks of processes that are no children of this one."""

import time
from collections.abc import Iterable
from pathlib import Path

from maulstick.errors import InputError
from maulstick.robot.journal import journal_of, locked

PATIENCE = 60.0  # seconds, for a machine that does much else


def have_ended(processes: Iterable[int]) -> bool:
    """Whether all of the processes end soon."""
    until = time.monotonic() + PATIENCE
    while any(_is_running(process) for process in processes):
        if time.monotonic() > until:
            return False
        time.sleep(0.02)
    return True


def wait_until_nobody_paints(painting: Path) -> None:
    """Return once no process has the journal of a painting."""
    until = time.monotonic() + PATIENCE
    while True:
        try:
            with locked(journal_of(painting)):
                return
        except InputError:
            assert time.monotonic() < until, "it is still painted"
            time.sleep(0.1)


def children_of(process: int) -> list[int]:
    """Return the ids of the processes that any thread of a process started; none where it has ended."""
    try:
        threads = list(Path(f"/proc/{process}/task").iterdir())
        return [int(child) for thread in threads for child in (thread / "children").read_text().split()]
    except (FileNotFoundError, ProcessLookupError):
        return []


def command_of(process: int) -> bytes:
    """Return the words that a process was started with, apart by zeros; none where it has ended."""
    try:
        return Path(f"/proc/{process}/cmdline").read_bytes()
    except (FileNotFoundError, ProcessLookupError):
        return b""


def _is_running(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):  # the latter where it ends while it is read
        return False
