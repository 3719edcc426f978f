"""Sweep on this machine: some processes, each of which finishes one cell after another."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from threading import Lock, local

from maulstick.errors import OutputError

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
        self._started: list[subprocess.Popen[str]] = []
        self._changing, self._closed = Lock(), False

    def submit(self, folders: Sequence[Path]) -> list["Future[str | None]"]:
        """Begin to plan the cells in these folders."""
        return [self._pool.submit(self._plan, folder) for folder in folders]

    def stop(self) -> None:
        """Do nothing: all that was taken has begun."""

    def close(self) -> None:
        """End all processes, whose plans in the making are kept."""
        with self._changing:
            self._closed = True
            for worker in self._started:
                worker.kill()
        self._pool.shutdown(cancel_futures=True)
        for worker in self._started:
            worker.communicate()

    def _plan(self, folder: Path) -> str | None:
        worker: subprocess.Popen[str] | None = getattr(self._mine, "worker", None)
        if worker is None or worker.poll() is not None:
            worker = self._mine.worker = self._start()
        assert worker.stdin is not None
        assert worker.stdout is not None
        try:
            print(json.dumps(str(folder.absolute())), file=worker.stdin, flush=True)
            said = worker.stdout.readline()
        except BrokenPipeError:
            said = ""
        if not said:
            raise OutputError(_death(worker.wait()))
        answer: str | None = json.loads(said)
        return answer

    def _start(self) -> subprocess.Popen[str]:
        """Start a process that hears no Ctrl-C, which the terminal sends to all: this one acts on it."""
        with self._changing:
            if self._closed:
                raise OutputError("the sweep is over")
            worker = subprocess.Popen(
                [sys.executable, "-P", "-m", _WORKER],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                env={"OMP_NUM_THREADS": str(self._threads), **os.environ},
                start_new_session=True,
            )
            self._started.append(worker)
        return worker


def _death(code: int) -> str:
    if code >= 0:
        return f"its process left with exit code {code}"
    name = signal.Signals(-code).name
    why = ", most likely for want of memory: plan fewer cells at once" if name == "SIGKILL" else ""
    return f"its process was ended by {name}{why}"
