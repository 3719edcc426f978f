"""Spare: a process that has loaded what its work takes before there is any, so that nobody waits for that."""

import asyncio
from collections.abc import Callable
from importlib import import_module
from typing import Any, final

from maulstick.studio.workers.process import Line, Process

_IDLE = 300.0  # seconds without a call after which the process, which holds some 400 MB, is let go


@final
class Spare:
    """A process for some work that may come soon.

    work: as `Process` has it.  modules: names of those that it takes seconds to load.  niceness: of the process.
    idle: seconds after the last call of `be_ready` until the process is let go.
    """

    def __init__(self, work: Callable[..., None], *modules: str, niceness: int = 0, idle: float = _IDLE) -> None:
        self._work, self._modules, self._niceness, self._idle = work, modules, niceness, idle
        self._process: Process | None = None
        self._letting_go: asyncio.TimerHandle | None = None

    @property
    def is_ready(self) -> bool:
        """Whether a process waits for work, or loads what that takes."""
        return self._process is not None

    def be_ready(self) -> None:
        """Let a process wait for work, if none does."""
        self._keep()
        if self._process is None:
            self._process = Process(
                _wait, self._work, self._modules, hear=_pass_over, ended=self._forget, niceness=self._niceness
            )
        self._letting_go = asyncio.get_running_loop().call_later(self._idle, self.close)

    def begin(self, *arguments: object, hear: Callable[[Any], None], ended: Callable[[], None]) -> Process:
        """Return a process that does the work, as `Process` describes: the one that waits, or else a new one."""
        self._keep()
        process, self._process = self._process, None
        if process is None:
            return Process(self._work, *arguments, hear=hear, ended=ended, niceness=self._niceness)
        process.report_to(hear, ended)
        process.tell(arguments)
        return process

    def close(self) -> None:
        """End the process that waits."""
        self._keep()
        if self._process is not None:
            self._process.forget()
            self._process.kill()
            self._process = None

    def _keep(self) -> None:
        """Forget that the process was to be let go."""
        if self._letting_go is not None:
            self._letting_go.cancel()
            self._letting_go = None

    def _forget(self) -> None:
        self._process = None


def _pass_over(word: object) -> None:
    """Say nothing of what failed before there was any work: whoever has some is told by the next process."""


def _wait(line: Line, work: Callable[..., None], modules: tuple[str, ...]) -> None:
    """Load the modules, and do the work with the arguments that come; without any, the studio is gone."""
    for module in modules:
        import_module(module)
    arguments = next(line.hear(), None)
    if isinstance(arguments, tuple):
        work(line, *arguments)
