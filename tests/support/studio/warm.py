"""Processes that have loaded at their start what takes seconds to load: forked from one that has done nothing else."""

import gc
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from multiprocessing.context import ForkServerContext, ForkServerProcess
from multiprocessing.forkserver import _forkserver
from pathlib import Path
from unittest.mock import patch

from maulstick.cli import main
from maulstick.jobs.processes import deaf_to_interrupts
from maulstick.studio.workers.planner import TAKEN

_LOADED = (
    *TAKEN,
    "maulstick.plots.style",
    "maulstick.recording.files.ink_files",
    "maulstick.studio.server.server",
)
_forkserver.set_forkserver_preload([*_LOADED])


class _Process(ForkServerProcess):
    """Process with this one's environment, as a spawned one has it; that of its server is older."""

    def __init__(self, *, target: Callable[..., None], args: Sequence[object], daemon: bool) -> None:
        super().__init__(target=_as_here, args=(dict(os.environ), target, *args), daemon=daemon)


class Warm(ForkServerContext):
    """Context of multiprocessing in place of the one that spawns."""

    Process = _Process


class WarmCommand:
    """``maulstick`` with these words in a process of its own, as `subprocess.Popen` has it; all it starts is warm.

    log: file that its output is added to.
    """

    def __init__(self, words: Sequence[str], log: Path, environment: Mapping[str, str]) -> None:
        self._process = ForkServerProcess(target=_as_here, args=(environment, _run, words, log))
        with deaf_to_interrupts():  # as the studio starts its own, since the first may start what all are forked from
            self._process.start()

    @property
    def pid(self) -> int | None:
        return self._process.pid

    def send_signal(self, number: int) -> None:
        if self.poll() is None:
            os.kill(self._process.pid, number)  # type: ignore[arg-type]  # it has begun

    def kill(self) -> None:
        self._process.kill()

    def poll(self) -> int | None:
        return self._process.exitcode

    def wait(self, timeout: float | None = None) -> int:
        self._process.join(timeout)
        if (code := self.poll()) is None:
            raise subprocess.TimeoutExpired("maulstick", timeout or 0)
        return code


def _as_here(environment: Mapping[str, str], target: Callable[..., None], *arguments: object) -> None:
    gc.freeze()  # or each collection goes through all that is loaded
    os.environ.clear()
    os.environ.update(environment)
    target(*arguments)


def _run(words: Sequence[str], log: Path) -> None:
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    written = os.open(log, os.O_WRONLY | os.O_APPEND)
    for stream in (1, 2):
        os.dup2(written, stream)
    # The one that this was forked from is asked again, which Python does not see.
    _forkserver.ensure_running = lambda: None  # type: ignore[method-assign]
    with patch("maulstick.studio.workers.process._SPAWN", Warm()), patch.object(sys, "argv", ["maulstick", *words]):
        main()
