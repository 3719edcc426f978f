"""Processes that work for the one that hears the terminal."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import IO


@contextmanager
def deaf_to_interrupts() -> Iterator[None]:
    """Start processes within that do not hear Ctrl-C, which the terminal sends to all of them; their parent acts on it.

    The parent hears afterwards what it was sent meanwhile.
    """
    resource_tracker.ensure_running()  # else the first process starts it, and that lets Ctrl-C through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def death_of(code: int, told: IO[bytes], advice: str) -> str:
    """Return how a process ended, for people.

    code: of its exit, as `subprocess` has it.  told: the file that it wrote its errors to.  advice: what to do where
    memory was short.
    """
    if code >= 0:
        told.seek(0)
        last = told.read().decode(errors="replace").strip().rpartition("\n")[2]
        return f"its process left with exit code {code}" + (f", and said: {last}" if last else "")
    name = signal.Signals(-code).name
    why = f", most likely for want of memory: {advice}" if name == "SIGKILL" else ""
    return f"its process was ended by {name}{why}"
