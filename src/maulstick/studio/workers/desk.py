"""Desk: a process for short tasks, as reading an upload, fitting a style or drawing a plot, outside the server."""

import asyncio
import resource
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any, ParamSpec, TypeVar, final

from maulstick.errors import MaulstickError, needs_torch
from maulstick.studio.workers.kept import Kept
from maulstick.studio.workers.process import Failed, Line, Process

P = ParamSpec("P")
Result = TypeVar("Result")

_LONGEST = 60.0  # seconds that a task may take before it is given up
_IDLE = 300.0  # seconds without a task after which the process, which holds some 700 MB, is let go
_NICENESS = 5  # so that the server itself comes first; planning has 10
_MEMORY = 6 * 2**30  # bytes, thrice what the largest picture needs: a file that swells beyond is stopped here
_USUAL = (  # modules that the first tasks need, and that take seconds to load
    "maulstick.style.store",
    "maulstick.plots.style",
    "maulstick.recording.files.ink_files",
)


@dataclass(frozen=True)
class _Task:
    function: Callable[..., object]
    arguments: tuple[object, ...]
    named: dict[str, object]


@dataclass(frozen=True)
class _Done:
    result: object


@dataclass(frozen=True)
class _Refused:
    error: MaulstickError


@final
class Desk(Kept):
    """Queue of short tasks: one at a time, each with a time limit, in a process that is kept for the next one.

    idle: seconds without a task after which the process is let go; the next task waits while another one starts.
    """

    def __init__(self, idle: float = _IDLE) -> None:
        super().__init__(idle)
        self._free = asyncio.Lock()
        self._answer: asyncio.Future[Any] | None = None

    async def do(self, function: Callable[P, Result], *arguments: P.args, **named: P.kwargs) -> Result:
        """Call the function of a module in the process and return its result.

        Raises MaulstickError where the function does, and where it takes too long.
        """
        async with self._free:
            self._stay()
            process = self._process or self._begin()
            self._answer = answer = asyncio.get_running_loop().create_future()
            process.tell(_Task(function, arguments, named))
            try:
                result: Result = await asyncio.wait_for(answer, _LONGEST)
            except TimeoutError:
                self.close()
                raise MaulstickError(
                    f"that took longer than {_LONGEST:.0f} s and was given up; try something smaller"
                ) from None
            except asyncio.CancelledError:  # the next task must not get the answer of this one
                self.close()
                raise
            finally:
                if self._process is not None:
                    self._let_go_when_idle()
            return result

    async def warm_up(self) -> None:
        """Load the modules now that the first task would wait for."""
        await self.do(_load_usual)

    def _begin(self) -> Process:
        self._process = Process(_work, hear=self._reply, ended=self._end, niceness=_NICENESS)
        return self._process

    def _end(self) -> None:
        self._reply(Failed("the work ended without a word; try it again"))

    def _reply(self, word: _Done | _Refused | Failed) -> None:
        if isinstance(word, Failed) and self._process is not None:  # it may still run, but does not listen any more
            self._process.forget()
            self._process = None
        if self._answer is None or self._answer.done():
            return
        if isinstance(word, _Done):
            self._answer.set_result(word.result)
        else:
            error = word.error if isinstance(word, _Refused) else MaulstickError(word.why)
            self._answer.set_exception(error)


def _work(line: Line) -> None:
    """Do each task that comes; an error that is not a MaulstickError ends the process."""
    resource.setrlimit(resource.RLIMIT_DATA, (_MEMORY, resource.getrlimit(resource.RLIMIT_DATA)[1]))
    for task in line.hear():
        assert isinstance(task, _Task)
        try:
            with needs_torch():
                result = task.function(*task.arguments, **task.named)
            line.say(_Done(result))
        except MaulstickError as error:
            line.say(_Refused(error))


def _load_usual() -> None:
    for module in _USUAL:
        import_module(module)
