"""Planning from several seeds, each in a process of its own."""

import os
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import replace
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.queues import Queue
from multiprocessing.synchronize import Event
from pathlib import Path
from queue import Empty
from threading import Lock, Thread

from maulstick.errors import OutputError
from maulstick.jobs.plan.checkpoints import plan_with
from maulstick.jobs.plan.request import PlanRequest
from maulstick.jobs.plan.tries import best_of, prepare_try, seeds_of
from maulstick.jobs.processes import deaf_to_interrupts
from maulstick.painting.painting import Painting
from maulstick.planning.result import PlanProgress

_REPORT_EVERY = 0.2  # seconds between two reports of a process: enough for a progress bar


def plan_in_processes(
    request: PlanRequest,
    out: Path,
    show: Callable[[float, float, Mapping[str, float]], None],
    wanted: Callable[[], bool],
) -> Painting:
    """Plan from as many seeds as the request tries, each in a process; returns the painting with the least loss."""
    seeds = seeds_of(request)
    context = get_context("spawn")
    reports, stop = context.Queue(), context.Event()
    said = dict.fromkeys(seeds, (0.0, float("inf")))
    with ProcessPoolExecutor(min(request.tries, os.cpu_count() or 1), context, _listen, (reports, stop)) as pool:
        with deaf_to_interrupts():
            tries = [pool.submit(_try, request, out, seed) for seed in seeds]
        try:
            while not all(each.done() for each in tries):
                with suppress(Empty):
                    seed, done, loss = reports.get(timeout=_REPORT_EVERY)
                    said[seed] = (done, loss)
                    show(sum(done for done, _ in said.values()) / len(said), min(loss for _, loss in said.values()), {})
                if not wanted():
                    stop.set()
            paintings = [each.result() for each in tries]
        except BrokenProcessPool as error:
            raise OutputError(
                "a process that planned was killed, most likely for want of memory; ask for fewer --tries"
            ) from error
        except BaseException:  # a second Ctrl-C, or a process that failed: the others need not finish
            for process in active_children():
                process.terminate()
            raise
    return best_of(paintings)


_reports: "Queue[tuple[int, float, float]]"
_stop: Event
_busy = Lock()


def _listen(reports: "Queue[tuple[int, float, float]]", stop: Event) -> None:
    """Prepare a process that plans."""
    global _reports, _stop
    _reports, _stop = reports, stop
    Thread(target=_leave_with_parent, daemon=True).start()


def _leave_with_parent() -> None:
    """Leave once the parent was killed; a pool's process that has nothing to do would wait for it for ever."""
    parent = parent_process()
    assert parent is not None
    parent.join()
    with _busy:  # while it plans it leaves between two steps, with its files whole
        os._exit(1)


def _try(request: PlanRequest, out: Path, seed: int) -> Painting:
    with _busy:
        return _plan_from(request, out, seed)


def _plan_from(request: PlanRequest, out: Path, seed: int) -> Painting:
    told, parent = 0.0, parent_process()
    assert parent is not None

    def watch(progress: PlanProgress) -> bool:
        nonlocal told
        if not parent.is_alive():  # killed: there is nobody to plan for
            os._exit(1)
        if time.monotonic() - told > _REPORT_EVERY:
            told = time.monotonic()
            _reports.put((seed, progress.done, progress.loss))
        return not _stop.is_set()

    prepared = prepare_try(request, seed)
    workers = max(1, prepared.workers // request.tries)  # or all tries together would have more than there are cores
    return plan_with(replace(prepared, workers=workers), out, request, watch)
