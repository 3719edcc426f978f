"""Windows of a mural in processes of their own: the same plan by any number, and no process that stays."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import torch

from maulstick.errors import InputError, OutputError
from maulstick.jobs.plan import window_pool
from maulstick.jobs.plan.request import MOST_WORKERS
from maulstick.jobs.plan.window_pool import WindowPool, windows_at_once, workers_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.window import in_turn
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.state import State
from tests.support.planning.same import same
from tests.support.planning.strip import SETTINGS, TONE, WIDTH, plan_strip
from tests.support.studio.processes import have_ended

SOFT = LossOptions(weights={"tone": 1.0, "likeness": 0.5})  # by a network, whose bits depend on torch's threads


@pytest.fixture(scope="module")
def by_tones() -> PlanResult:
    return plan_strip()


def processes_of(pool: WindowPool) -> list[int]:
    return [worker.process.pid for worker in pool._started]


@pytest.mark.parametrize(("workers", "losses"), [(2, SOFT), (4, TONE)])
def test_any_number_of_processes_gives_the_same_plan_to_the_bit(workers: int, losses: LossOptions) -> None:
    seen: list[PlanProgress] = []

    def watch(progress: PlanProgress) -> bool:
        seen.append(progress)
        return True

    with WindowPool(workers) as pool:
        found = plan_strip(pool, watch, loss_options=losses)
        processes = processes_of(pool)
    assert same(found, plan_strip(loss_options=losses))
    assert len(processes) == workers
    assert have_ended(processes)
    assert len(seen) >= SETTINGS.steps + 8, "each window tells how it goes at least once"
    assert 0.5 < seen[-1].done < 1
    assert [step.done for step in seen] == sorted(step.done for step in seen)


def test_one_worker_is_this_process() -> None:
    with windows_at_once(1) as plan_windows:
        assert plan_windows is in_turn


def test_there_is_a_worker_per_core_unless_others_are_wanted_and_a_gpu_has_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    cpu, gpu = torch.device("cpu"), torch.device("cuda")
    for cores, workers in ((1, 1), (MOST_WORKERS, MOST_WORKERS), (128, MOST_WORKERS)):
        monkeypatch.setattr(window_pool, "THREADS", cores)
        assert workers_for(None, cpu, has_windows=True) == workers
    assert workers_for(3, cpu, has_windows=True) == 3
    assert workers_for(None, gpu, has_windows=True) == workers_for(1, gpu, has_windows=True) == 1
    with pytest.raises(InputError, match="workers is 2, and a GPU plans one window at a time; leave it out"):
        workers_for(2, gpu, has_windows=True)


def test_who_stops_gets_the_windows_in_work_and_may_go_on_as_if_nothing_had_been(by_tones: PlanResult) -> None:
    states: list[State] = []

    def stop_in_windows(progress: PlanProgress) -> bool:
        if "all.angles" in (state := progress.state()):
            states.append(state)
        return not states

    with WindowPool(2) as pool:
        stopped = plan_strip(pool, stop_in_windows)
    before, after = (
        {tuple(row) for row in each.tolist()} for each in (states[0]["all.centres"], stopped.strokes.centres)
    )
    cores = {int(x / WIDTH * 8) for x, _ in after - before}
    assert {0, 2} <= cores <= {0, 1, 2, 3}, "windows 4 and 6 of the round were not begun"
    assert same(plan_strip(resume=states[0]), by_tones)


def test_a_process_that_dies_is_told_with_its_window_and_leaves_what_to_go_on_from(by_tones: PlanResult) -> None:
    states: list[State] = []
    told = (
        r"window [13] of the mural is not planned: its process was ended by SIGKILL, most likely for want of memory: "
        "ask for fewer workers"
    )
    with WindowPool(2) as pool:

        def kill_one(progress: PlanProgress) -> bool:
            if "all.angles" in (state := progress.state()):
                states.append(state)
                pool._started[0].process.kill()
            return True

        with pytest.raises(OutputError, match=told):
            plan_strip(pool, kill_one)
        processes = processes_of(pool)
    assert have_ended(processes)
    assert same(plan_strip(resume=states[-1]), by_tones)


DIES_WHILE_TELLING = """
import os, signal, struct, sys
from multiprocessing.connection import Connection

(connection := Connection(int(sys.argv[1]))).recv_bytes()
os.write(connection.fileno(), struct.pack("!i", 1000) + b"the beginning of a message")
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_process_that_dies_in_the_middle_of_telling_is_told_as_well(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "dies_while_telling.py").write_text(DIES_WHILE_TELLING)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setattr(window_pool, "_WORKER", "dies_while_telling")
    with WindowPool(2) as pool, pytest.raises(OutputError, match="of the mural is not planned: its process was ended"):
        plan_strip(pool)


KILLED_IN_THE_MIDDLE = """
import os, signal
from dataclasses import replace
from maulstick.jobs.plan.window_pool import WindowPool
from tests.support.planning.strip import SETTINGS, plan_strip

def watch(progress):
    if "all.angles" in progress.state():
        print(*(worker.process.pid for worker in pool._started), flush=True)
        os.kill(os.getpid(), signal.SIGKILL)
    return True

with WindowPool(2) as pool:
    plan_strip(pool, watch, settings=replace(SETTINGS, steps=60))
"""


def test_processes_leave_in_the_middle_when_their_parent_is_killed() -> None:
    ran = subprocess.run([sys.executable, "-c", KILLED_IN_THE_MIDDLE], capture_output=True, text=True, timeout=100)
    assert ran.returncode == -signal.SIGKILL, ran.stderr
    processes = [int(word) for word in ran.stdout.split()]
    assert len(processes) == 2
    assert os.getpid() not in processes
    assert have_ended(processes)
