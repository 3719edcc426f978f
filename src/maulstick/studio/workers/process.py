"""Work in processes of its own, which exchange messages with the studio."""

import asyncio
import os
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.reduction import ForkingPickler
from queue import SimpleQueue
from typing import Any, final

from maulstick.errors import MaulstickError, needs_torch
from maulstick.jobs.processes import deaf_to_interrupts
from maulstick.studio.wording import error_text

_SPAWN = get_context("spawn")
CLOSING = 8.0
"""Seconds that a machine gets to lift its pen when the studio closes."""

LONGEST_STOP = 10.0
"""Seconds after a stop until a machine counts as one that does not answer."""

_LONGEST_FAREWELL = 20.0  # seconds for the pen to be lifted once the studio is gone


@dataclass(frozen=True)
class Failed:
    """Last message of work that failed. why: a sentence for people."""

    why: str


@final
class Line:
    """Connection of the work to the studio."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._saying = threading.Lock()

    def say(self, word: object) -> None:
        """Send a message to the studio, from any thread; it is lost where the studio is gone."""
        with self._saying:
            try:
                self._connection.send(word)
            except OSError:  # the studio is gone, which `hear` tells
                return

    def hear(self) -> Iterator[object]:
        """Yield each message of the studio, as it comes; end once the studio is gone, killed or not."""
        try:
            while True:
                yield self._connection.recv()
        except (EOFError, OSError):
            return

    def heard_by(self, hear: Callable[[object], None], alone: Callable[[], None]) -> None:
        """Call `hear` with each message from now on, in a thread of its own, and `alone` once the studio is gone."""

        def listen() -> None:
            for word in self.hear():
                hear(word)
            alone()

        threading.Thread(target=listen, daemon=True).start()


def farewell(stop: Callable[[], None]) -> None:
    """Stop a machine whose studio is gone, and end the process once the pen had time to lift."""
    stop()
    time.sleep(_LONGEST_FAREWELL)
    os._exit(1)


@final
class Process:
    """Process of some work, as the studio has it. Made in its event loop, in which `hear` and `ended` are called.

    work: a function of a module, called with a `Line` and the arguments.
    hear: called with each message of the work.  ended: called once, when the process is over.
    niceness: of the process, as for ``nice``.
    """

    def __init__(
        self,
        work: Callable[..., None],
        *arguments: object,
        hear: Callable[[Any], None],
        ended: Callable[[], None],
        niceness: int = 0,
    ) -> None:
        self.report_to(hear, ended)
        ours, theirs = _SPAWN.Pipe()
        self._connection, self._loop = ours, asyncio.get_running_loop()
        self._forgotten = False
        self._process = _SPAWN.Process(target=_begin, args=(work, theirs, niceness, arguments), daemon=True)
        try:
            with deaf_to_interrupts():  # here the studio alone acts on Ctrl-C
                self._process.start()
        finally:
            theirs.close()
        self._words: SimpleQueue[memoryview | None] = SimpleQueue()
        self._ended = threading.Event()
        threading.Thread(target=self._speak, daemon=True).start()
        threading.Thread(target=self._listen, daemon=True).start()

    def report_to(self, hear: Callable[[Any], None], ended: Callable[[], None]) -> None:
        """Call these from now on, in place of those that the process was begun with."""
        self._hear, self._over = hear, ended

    def forget(self) -> None:
        """Call neither `hear` nor `ended` any more, whatever is on its way."""
        self._forgotten = True

    def tell(self, word: object) -> None:
        """Send a message to the work, which may not listen yet, or be over."""
        self._words.put(ForkingPickler.dumps(word))

    def kill(self) -> None:
        """Kill the process at once."""
        self._process.kill()

    def join(self, seconds: float) -> bool:
        """Wait for the end of the process, at most so many seconds; return whether it has ended."""
        return self._ended.wait(seconds)

    def _speak(self) -> None:
        while (word := self._words.get()) is not None:
            with suppress(OSError):  # it is over
                self._connection.send_bytes(word)

    def _listen(self) -> None:
        said = False
        try:
            while True:
                word = self._connection.recv()
                said = isinstance(word, Failed)
                self._call(self._take, word)
        except (EOFError, OSError):
            while self._process.exitcode is None:  # starting another process may take the exit status away meanwhile
                self._process.join()
        self._ended.set()
        self._words.put(None)
        if self._process.exitcode and not said:
            self._call(self._take, Failed("the work was killed, most likely for want of memory; try again with less"))
        self._call(self._end)

    def _take(self, word: object) -> None:
        self._hear(word)  # whoever is told by then

    def _end(self) -> None:
        self._over()

    def _call(self, function: Callable[..., None], *arguments: object) -> None:
        def call() -> None:
            if not self._forgotten:
                function(*arguments)

        try:
            self._loop.call_soon_threadsafe(call)
        except RuntimeError:  # the studio is closing
            return


def _begin(work: Callable[..., None], connection: Connection, niceness: int, arguments: tuple[object, ...]) -> None:
    os.nice(niceness)
    line = Line(connection)
    try:
        with needs_torch():
            work(line, *arguments)
    except MaulstickError as error:
        line.say(Failed(error_text(error)))
        sys.exit(1)
    except MemoryError:
        line.say(Failed("that needs more memory than there is for it; try it with something smaller"))
        sys.exit(1)
    except Exception as error:
        traceback.print_exc()
        line.say(Failed(f"something in Maulstick is broken: {type(error).__name__}: {' '.join(str(error).split())}"))
        sys.exit(1)
