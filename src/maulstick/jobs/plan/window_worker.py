"""Process that plans one window of a mural after another, and tells how it goes, by a connection whose number it gets.

It needs nothing of the program that started it, which may have no main module to import again, and leaves with it.
"""

import os
import pickle
import sys
import time
from dataclasses import replace
from functools import partial
from multiprocessing.connection import Connection
from queue import SimpleQueue
from threading import Event, Thread
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:  # what comes loads torch, which takes seconds; it is listened to before
    from maulstick.planning.mural.window import Window, WindowPlanner
    from maulstick.planning.result import PlanProgress

STOP: Final = b""
"""Message to a process that is to end its window after a few more steps."""

_TELL_EVERY = 2.0  # seconds between two tellings of how it goes: with its canvas and its state, these are megabytes


def work() -> None:
    """Plan each window that comes, until the other end of the connection is gone."""
    connection, messages, stop = Connection(int(sys.argv[1])), SimpleQueue[bytes](), Event()
    Thread(target=_listen, args=(connection, messages, stop), daemon=True).start()
    planner: WindowPlanner | None = None
    while True:
        sent: tuple[WindowPlanner | None, Window] = pickle.loads(messages.get())
        planner = planner or sent[0]
        assert planner is not None
        connection.send_bytes(pickle.dumps(planner.plan(sent[1], _Watch(connection, stop))))


def _listen(connection: Connection, messages: "SimpleQueue[bytes]", stop: Event) -> None:
    try:
        while True:
            message = connection.recv_bytes()
            if message == STOP:
                stop.set()
            else:
                messages.put(message)
    except (EOFError, OSError):
        os._exit(1)  # in the middle of a step, even: nobody waits for it any more


class _Watch:
    """Watch over the steps of one window, which tells how it goes now and then."""

    def __init__(self, connection: Connection, stop: Event) -> None:
        self._connection, self._stop, self._due = connection, stop, 0.0

    def __call__(self, progress: "PlanProgress") -> bool:
        if time.monotonic() > self._due:
            kept = replace(progress, state=partial(dict, progress.state()))
            self._connection.send_bytes(pickle.dumps(kept))
            self._due = time.monotonic() + _TELL_EVERY
        return not self._stop.is_set()


if __name__ == "__main__":
    work()
