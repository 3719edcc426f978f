import os
import signal
import subprocess
import sys
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.synchronize import Event
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest
from rich.console import Console

from maulstick.cli.plan import tries
from maulstick.cli.progress import stop_on_interrupt
from maulstick.jobs.plan.request import PlanRequest, state_files
from maulstick.painting.painting import Painting, Provenance
from maulstick.painting.painting_file import read_painting
from tests.cli.conftest import PORTRAIT, QUICK, RESULTS, Ran, Running, paint, run

TRIES = ("plan", PORTRAIT, *QUICK, "--tries", "2")
MORTAL = (sys.executable, "-m", "tests.support.cli.mortal", "0")


def but_for_how_it_was_made(painting: Painting) -> Painting:
    return painting.model_copy(update={"provenance": Provenance(version="any")})


def test_tries_that_were_killed_go_on_to_the_better_of_both_plans_and_no_process_stays(
    painted: tuple[Path, Ran], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    running = Running(*TRIES, "--out", out, command=MORTAL)
    while len(state_files(out)) < 2:
        assert running.listen(), running.said
    running.kill()
    assert running.leave() == -9, "the terminal is left once nobody is there to write to it"
    assert sorted(os.listdir(out)) == ["plan-0.npz", "plan-1.npz"]
    assert run("plan", "--resume", out).code == 0
    assert sorted(os.listdir(out)) == RESULTS
    assert paint(tmp_path / "alone", "--seed", "1").code == 0
    alone = [read_painting(folder / "painting.json") for folder in (painted[0], tmp_path / "alone")]
    losses = [painting.provenance.metrics["loss"] for painting in alone]
    better, kept = alone[losses.index(min(losses))], read_painting(out / "painting.json")
    assert losses[0] != losses[1]
    assert but_for_how_it_was_made(kept) == but_for_how_it_was_made(better)
    assert (kept.provenance.seed, kept.provenance.metrics) == (better.provenance.seed, better.provenance.metrics)
    assert kept.provenance.options == {**better.provenance.options, "tries": 2}


KILLED_WHILE_A_PROCESS_IS_IDLE = """
import os, signal
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from maulstick.cli.plan import tries

context = get_context("spawn")
pool = ProcessPoolExecutor(1, context, tries._listen, (context.Queue(), context.Event()))
print(pool.submit(os.getpid).result(), flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_process_that_planned_all_it_had_to_leaves_when_its_parent_is_killed() -> None:
    ran = subprocess.run([sys.executable, "-c", KILLED_WHILE_A_PROCESS_IS_IDLE], capture_output=True, timeout=100)
    assert ran.returncode == -9, ran.stderr  # and run() came back: nobody holds its output any more
    assert int(ran.stdout) > 0


def test_tries_that_are_stopped_while_they_begin_keep_the_better_one_and_what_to_go_on_from(tmp_path: Path) -> None:
    out = tmp_path / "out"
    running = Running(*TRIES, "--steps", "300000", "--out", out)
    running.interrupt_after("loss …")
    assert running.leave() == 130
    assert "Traceback" not in running.said
    assert sorted(os.listdir(out)) == sorted([*RESULTS, "plan-0.npz", "plan-1.npz"])
    painting = read_painting(out / "painting.json")
    assert painting.strokes
    assert painting.provenance.options["tries"] == 2


def test_an_interrupt_while_processes_are_started_is_heard(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Pool(ThreadPoolExecutor):
        def __init__(self, processes: int, _context: object, _prepare: object, shared: tuple[object, Event]) -> None:
            super().__init__(processes)
            self._stop = shared[1]

        def submit(self, *_: object) -> Future[SimpleNamespace]:  # type: ignore[override]
            signal.raise_signal(signal.SIGINT)
            return super().submit(self._planned)

        def _planned(self) -> SimpleNamespace:
            stopped = self._stop.wait(20)
            return SimpleNamespace(stopped=stopped, provenance=SimpleNamespace(metrics={"loss": 0.0}))

    monkeypatch.setattr(tries, "ProcessPoolExecutor", Pool)
    request = PlanRequest(None, tries=2)
    with stop_on_interrupt(Console(quiet=True)) as wanted:
        chosen = tries.plan_in_processes(request, tmp_path, lambda *_: None, wanted)
    assert cast("SimpleNamespace", chosen).stopped


def test_a_process_that_is_killed_is_told_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Pool(ThreadPoolExecutor):
        def submit(self, *_: object) -> Future[Painting]:  # type: ignore[override]
            future: Future[Painting] = Future()
            future.set_exception(BrokenProcessPool("terminated abruptly"))
            return future

    monkeypatch.setattr(tries, "ProcessPoolExecutor", lambda *_: Pool())
    ran = run(*TRIES, "--out", tmp_path / "out")
    assert ran.code == 1
    told = "a process that planned was killed, most likely for want of memory; ask for fewer --tries"
    assert ran.stderr.endswith(f"maulstick: {told}\n")
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--tries", "0"], "--tries is 0; it must be from 1 to 64"),
        (["--tries", "9999999999"], "--tries is 9999999999; it must be from 1 to 64"),
        (["--tries", "65"], "--tries is 65; it must be from 1 to 64"),
        (["--tries", "2", "--seed", "4294967295"], "--seed is 4294967295; it must be from 0 to 4294967294"),
        (
            ["--tries", "2", "--video", "gif"],
            "--video records one plan, and --tries makes several; leave one of them out",
        ),
    ],
)
def test_tries_that_cannot_be_made_are_refused(tmp_path: Path, words: list[str], text: str) -> None:
    ran = run("plan", "--demo", *words, "--out", tmp_path / "out")
    assert ran.code == 2
    assert ran.mistake.startswith(text)
    assert os.listdir(tmp_path) == []
