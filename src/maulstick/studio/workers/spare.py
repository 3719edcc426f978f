"""Spare: a process that has loaded what its work takes before there is any, so that nobody waits for that."""

from collections.abc import Callable
from importlib import import_module
from typing import Any, final

from maulstick.studio.workers.kept import Kept
from maulstick.studio.workers.process import Line, Process

_IDLE = 300.0  # seconds without a call after which the process, which holds some 400 MB, is let go


@final
class Spare(Kept):
    """A process for some work that may come soon.

    work: as `Process` has it.  modules: names of those that it takes seconds to load.  niceness: of the process.
    idle: seconds after the last call of `be_ready` until the process is let go.
    """

    def __init__(self, work: Callable[..., None], *modules: str, niceness: int = 0, idle: float = _IDLE) -> None:
        super().__init__(idle)
        self._work, self._modules, self._niceness = work, modules, niceness

    @property
    def is_ready(self) -> bool:
        """Whether a process waits for work, or loads what that takes."""
        return self._process is not None

    def be_ready(self) -> None:
        """Let a process wait for work, if none does."""
        self._stay()
        if self._process is None:
            self._process = Process(
                _wait, self._work, self._modules, hear=_pass_over, ended=self._forget, niceness=self._niceness
            )
        self._let_go_when_idle()

    def begin(self, *arguments: object, hear: Callable[[Any], None], ended: Callable[[], None]) -> Process:
        """Return a process that does the work, as `Process` describes: the one that waits, or else a new one."""
        self._stay()
        process, self._process = self._process, None
        if process is None:
            return Process(self._work, *arguments, hear=hear, ended=ended, niceness=self._niceness)
        process.report_to(hear, ended)
        process.tell(arguments)
        return process

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
