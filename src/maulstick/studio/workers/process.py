"""Work in processes of its own: it says what becomes of it, and hears what is wanted of it."""

import asyncio
import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.reduction import ForkingPickler
from queue import SimpleQueue
from typing import Any, final

from maulstick.errors import MaulstickError
from maulstick.studio.wording import said

_SPAWN = get_context("spawn")
_OF_THE_TERMINAL = {signal.SIGINT}  # which tells all of its processes; the studio tells its own


@dataclass(frozen=True)
class Failed:
    """The last word of work that could not be done: why, in a sentence for people."""

    why: str


@final
class Line:
    """The end of the line that the work has."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._saying = threading.Lock()

    def say(self, word: object) -> None:
        """Let the studio know; from any thread. Nobody need listen any more."""
        with self._saying:
            try:
                self._connection.send(word)
            except OSError:  # the studio is gone, which `hear` tells
                return

    def hear(self) -> Iterator[object]:
        """Each word of the studio, as it comes; ends once the studio is gone, killed or not."""
        try:
            while True:
                yield self._connection.recv()
        except (EOFError, OSError):
            return

    def heard_by(self, hear: Callable[[object], None], alone: Callable[[], None]) -> None:
        """From now on each word is heard in a thread of its own, and once the studio is gone `alone` is called."""

        def listen() -> None:
            for word in self.hear():
                hear(word)
            alone()

        threading.Thread(target=listen, daemon=True).start()


@final
class Process:
    """The studio's end. Made in its event loop, in which `hear` and `ended` are called.

    work: a function of a module, called with a `Line` and the arguments.
    hear: is told each word of the work.  ended: is called once, when the process is over.
    niceness: how much the work gives way to everything else on the machine.
    """

    def __init__(
        self,
        work: Callable[..., None],
        *arguments: object,
        hear: Callable[[Any], None],
        ended: Callable[[], None],
        niceness: int = 0,
    ) -> None:
        ours, theirs = _SPAWN.Pipe()
        self._connection, self._loop = ours, asyncio.get_running_loop()
        self._process = _SPAWN.Process(target=_begin, args=(work, theirs, niceness, arguments), daemon=True)
        before = signal.pthread_sigmask(signal.SIG_BLOCK, _OF_THE_TERMINAL)
        try:
            self._process.start()  # with what is blocked here
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
            theirs.close()
        self._words: SimpleQueue[memoryview | None] = SimpleQueue()
        threading.Thread(target=self._speak, daemon=True).start()
        threading.Thread(target=self._listen, args=(hear, ended), daemon=True).start()

    def tell(self, word: object) -> None:
        """Let the work know, which may not listen yet, or be over."""
        self._words.put(ForkingPickler.dumps(word))

    def kill(self) -> None:
        """End it at once, whatever it does."""
        self._process.kill()

    def join(self, seconds: float) -> bool:
        """Wait so long for its end; whether it has come."""
        self._process.join(seconds)
        return not self._process.is_alive()

    def _speak(self) -> None:
        while (word := self._words.get()) is not None:
            with suppress(OSError):  # it is over
                self._connection.send_bytes(word)

    def _listen(self, hear: Callable[[Any], None], ended: Callable[[], None]) -> None:
        said = False
        try:
            while True:
                word = self._connection.recv()
                said = isinstance(word, Failed)
                self._call(hear, word)
        except (EOFError, OSError):
            self._process.join()
        self._words.put(None)
        if self._process.exitcode and not said:
            self._call(hear, Failed("the work was killed, most likely for want of memory; try again with less"))
        self._call(ended)

    def _call(self, function: Callable[..., None], *arguments: object) -> None:
        try:
            self._loop.call_soon_threadsafe(function, *arguments)
        except RuntimeError:  # the studio is closing, and nobody wants to know
            return


def _begin(work: Callable[..., None], connection: Connection, niceness: int, arguments: tuple[object, ...]) -> None:
    os.nice(niceness)
    line = Line(connection)
    try:
        work(line, *arguments)
    except MaulstickError as error:
        line.say(Failed(said(error)))
        sys.exit(1)
    except MemoryError:
        line.say(Failed("that needs more memory than there is for it; try it with something smaller"))
        sys.exit(1)
    except Exception as error:
        traceback.print_exc()
        line.say(Failed(f"something in Maulstick is broken: {type(error).__name__}: {' '.join(str(error).split())}"))
        sys.exit(1)
