"""Sweep on this machine: some processes, each of which finishes one cell after another."""

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from threading import Lock, local
from typing import IO

from maulstick.errors import OutputError
from maulstick.jobs.processes import death_of

_WORKER = "maulstick.jobs.sweep.worker"


def usable_cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Local:
    """Engine of this machine; `at_once` cells at a time, by default as many as there are cores, which they share."""

    def __init__(self, at_once: int | None = None) -> None:
        count = usable_cores() if at_once is None else at_once
        self.room = float(count)
        self._threads = max(1, usable_cores() // count)
        self._pool = ThreadPoolExecutor(count)
        self._mine = local()
        self._started: list[_Worker] = []
        self._changing, self._closed = Lock(), False

    def submit(self, folders: Sequence[Path]) -> list["Future[str | None]"]:
        """Begin to plan the cells in these folders."""
        return [self._pool.submit(self._plan, folder) for folder in folders]

    def stop(self) -> tuple[()]:
        """Take nothing back: all that was taken has begun."""
        return ()

    def close(self) -> None:
        """End all processes, whose plans in the making are kept."""
        with self._changing:
            self._closed = True
            for worker in self._started:
                worker.process.kill()
        self._pool.shutdown(cancel_futures=True)
        for worker in self._started:
            worker.process.communicate()
            worker.told.close()

    def _plan(self, folder: Path) -> str | None:
        worker: _Worker | None = getattr(self._mine, "worker", None)
        if worker is None or worker.process.poll() is not None:
            worker = self._mine.worker = self._start()
        said = worker.ask(json.dumps(str(folder.absolute())))
        if not said:
            raise OutputError(death_of(worker.process.wait(), worker.told, "plan fewer cells at once"))
        answer: str | None = json.loads(said)
        return answer

    def _start(self) -> "_Worker":
        """Start a process that hears no Ctrl-C, which the terminal sends to all: this one acts on it."""
        with self._changing:
            if self._closed:
                raise OutputError("the sweep is over")
            told = TemporaryFile()  # noqa: SIM115  closed once the process has left
            process = subprocess.Popen(
                [sys.executable, "-P", "-m", _WORKER, str(os.getpid())],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=told,
                text=True,
                env={"OMP_NUM_THREADS": str(self._threads), **os.environ},
                start_new_session=True,
            )
            self._started.append(_Worker(process, told))
            return self._started[-1]


@dataclass(frozen=True)
class _Worker:
    """A process, and the file that it writes its errors to."""

    process: subprocess.Popen[str]
    told: IO[bytes]

    def ask(self, line: str) -> str:
        """Return the answer to a line; nothing where the process has left."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        try:
            print(line, file=self.process.stdin, flush=True)
            return self.process.stdout.readline()
        except BrokenPipeError:
            return ""
