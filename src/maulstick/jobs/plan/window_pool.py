"""Processes that plan windows of a mural at the same time."""

import os
import pickle
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait
from tempfile import TemporaryFile
from types import TracebackType
from typing import Self

import torch

from maulstick.errors import InputError, OutputError, option
from maulstick.jobs.plan.request import MOST_WORKERS
from maulstick.jobs.plan.window_worker import STOP
from maulstick.jobs.processes import death_of
from maulstick.planning.mural.window import PlanWindows, WatchWindow, Window, WindowPlanner, in_turn
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.rendering.kernels.cpu import THREADS

_WORKER = "maulstick.jobs.plan.window_worker"


def workers_for(wanted: int | None, device: torch.device, *, has_windows: bool) -> int:
    """Return how many processes plan windows at the same time, by default one per core up to the most; a GPU has one.

    Raises InputError where some are wanted, and there are no windows, or a GPU plans them.
    """
    if wanted is not None and not has_windows:
        raise InputError(
            f"{option('workers')} says how many windows of a large canvas are planned at the same time, and this "
            f"canvas is planned in one piece, on all cores; leave it out, or choose a larger {option('px')}"
        )
    if device.type == "cpu":
        return min(THREADS, MOST_WORKERS) if wanted is None else wanted
    if wanted is not None and wanted > 1:
        raise InputError(f"{option('workers')} is {wanted}, and a GPU plans one window at a time; leave it out")
    return 1


@contextmanager
def windows_at_once(workers: int) -> Iterator[PlanWindows]:
    """Provide what plans so many windows at the same time: one in this process, several in one each."""
    if workers == 1:
        yield in_turn
    else:
        with WindowPool(workers) as pool:
            yield pool


class WindowPool:
    """At most so many processes, each of which is started when there is a window for it; a `PlanWindows`.

    Each computes by itself on one core, so that as many as there are cores do not get in each other's way.
    """

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._idle: list[_Worker] = []
        self._started: list[_Worker] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        for worker in self._started:
            worker.process.kill()  # it holds nothing that is not told
        for worker in self._started:
            worker.close()

    def __call__(
        self, planner: WindowPlanner, windows: Iterator[Window], watch: WatchWindow
    ) -> Iterator[tuple[int, PlanResult]]:
        """Plan windows at the same time. Raises OutputError, which names the window, where its process dies."""
        busy: dict[Connection, _Worker] = {}
        while True:
            while len(busy) < self._workers and (window := next(windows, None)) is not None:
                worker = self._idle.pop() if self._idle else self._start(planner)
                worker.begin(window)
                busy[worker.connection] = worker
            if not busy:
                return
            for connection in wait(list(busy)):
                assert isinstance(connection, Connection)
                worker = busy[connection]
                told = worker.hear()
                if isinstance(told, PlanResult):
                    self._idle.append(busy.pop(connection))
                    yield worker.window, told
                elif not watch(worker.window, told):
                    for each in busy.values():
                        each.stop()

    def _start(self, planner: WindowPlanner) -> "_Worker":
        worker = _Worker(planner)
        self._started.append(worker)
        return worker


class _Worker:
    """A process that plans a window at a time. window: index of the present one.

    It hears no Ctrl-C, which the terminal sends to all: this process acts on it.
    """

    def __init__(self, planner: WindowPlanner) -> None:
        self.connection, theirs = Pipe()
        self._said = TemporaryFile()  # noqa: SIM115  closed once the process has left
        with theirs:
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-m", _WORKER, str(theirs.fileno())],
                stdin=subprocess.DEVNULL,
                stdout=self._said,
                stderr=self._said,
                pass_fds=[theirs.fileno()],
                env={**os.environ, "OMP_NUM_THREADS": "1"},
                start_new_session=True,
            )
        self._planner: WindowPlanner | None = planner
        self.window = -1
        self._is_stopped = False

    def begin(self, window: Window) -> None:
        """Let the process plan a window."""
        self.window = window.index
        self._tell(pickle.dumps((self._planner, window)))
        self._planner = None  # told with the first window

    def hear(self) -> PlanProgress | PlanResult:
        """Return the next progress or the plan of the present window. Raises OutputError where the process died."""
        try:
            told: PlanProgress | PlanResult = pickle.loads(self.connection.recv_bytes())
        except (EOFError, OSError) as error:  # the latter where it died in the middle of telling
            why = death_of(self.process.wait(), self._said, f"ask for fewer {option('workers')}")
            raise OutputError(f"window {self.window + 1} of the mural is not planned: {why}") from error
        return told

    def stop(self) -> None:
        """Let the process end its window after a few more steps."""
        if not self._is_stopped:
            self._is_stopped = True
            self._tell(STOP)

    def close(self) -> None:
        """Wait until the process has left."""
        self.process.wait()
        self.connection.close()
        self._said.close()

    def _tell(self, message: bytes) -> None:
        try:
            self.connection.send_bytes(message)
        except ConnectionError:  # it died, which `hear` tells
            return
