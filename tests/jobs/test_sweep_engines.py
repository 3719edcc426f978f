"""Sweeps on clusters: submitit with processes in place of Slurm's machines, and a real Ray cluster on this machine."""

import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

import maulstick as ms
from maulstick.errors import InputError, MachineError, how_to_add
from maulstick.jobs.plan.request import demo_picture
from maulstick.jobs.sweep import run
from maulstick.jobs.sweep.on_slurm import OnSlurm, PlanCell
from tests.support.studio.processes import children_of

OPTIONS = {"picture": str(demo_picture()), "strokes": 20, "steps": 30, "px": 48}
GRID: dict[str, Any] = {"axes": {"seed": [0, 1]}, "options": OPTIONS}


def results(folder: Path) -> dict[str, bytes]:
    return {name: (folder / name).read_bytes() for name in ("painting.json", "painting.svg", "preview.png")}


@pytest.fixture(scope="module")
def planned_here(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the same sweep, made by processes of this machine."""
    out = tmp_path_factory.mktemp("here")
    assert list(ms.sweep(GRID, out, at_once=1).fault) == ["", ""]
    return out


@pytest.fixture
def engines(monkeypatch: pytest.MonkeyPatch) -> list[OnSlurm]:
    """Slurm is this machine; its engines, as they are made."""
    pytest.importorskip("submitit", reason="submitit is not installed: pip install '.[slurm]'")
    made: list[OnSlurm] = []

    def make(_on: str, at_once: int | None, out: Path, slurm: Any) -> OnSlurm:
        made.append(OnSlurm(out, at_once, slurm, cluster="local"))
        return made[-1]

    monkeypatch.setattr(run, "make_engine", make)
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    return made


def test_submitit_plans_all_cells_the_same_to_the_bit(
    engines: list[OnSlurm], planned_here: Path, tmp_path: Path
) -> None:
    table = ms.sweep({**GRID, "slurm": {"timeout_min": 9}}, tmp_path / "out", on="slurm")
    assert list(table.fault) == ["", ""]
    assert len(engines) == 1
    for cell in ("seed-0", "seed-1"):
        assert results(tmp_path / "out" / cell) == results(planned_here / cell)


def test_a_job_that_is_requeued_does_the_same_again() -> None:
    pytest.importorskip("submitit", reason="submitit is not installed: pip install '.[slurm]'")
    again = pickle.loads(pickle.dumps(PlanCell().checkpoint("folder")))
    assert (type(again.function), again.args) == (PlanCell, ("folder",))


def test_a_job_that_is_taken_from_its_machine_is_requeued_and_finishes(engines: list[OnSlurm], tmp_path: Path) -> None:
    grid = {"axes": {"seed": [0]}, "options": {**OPTIONS, "steps": 1200}}
    taken: list[Any] = []

    def take(shares: Mapping[str, float]) -> None:
        if not taken and shares["seed-0"] > 0:
            taken.append(engines[0]._jobs[0])
            (job,) = children_of(taken[0]._process.pid)
            os.kill(job, signal.SIGUSR2)  # as Slurm does before it takes a machine away

    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a failure would be one
        table = ms.sweep(grid, tmp_path / "out", on="slurm", progress=take)
    assert list(table.fault) == [""]
    said = taken[0].stdout() + taken[0].stderr()
    assert "this job is preempted" in said
    assert "Requeued job" in said


def test_without_slurm_or_with_a_parameter_that_is_none_it_is_told_in_one_line(tmp_path: Path) -> None:
    pytest.importorskip("submitit", reason="submitit is not installed: pip install '.[slurm]'")
    if shutil.which("srun") is None:
        with pytest.raises(InputError, match="there is no Slurm here"):
            ms.sweep(GRID, tmp_path / "out", on="slurm")
    with pytest.raises(InputError, match="parameters of slurm cannot be used"):
        OnSlurm(tmp_path, None, {"minutes": 3}, cluster="local")


SLURM = {
    "srun": "exit 0",
    "sbatch": 'cat "$1" >> submitted; echo Submitted batch job 7$(grep -c array= submitted)',
    "sacct": "echo 'JobID|State|NodeList'; for job in 71_0 71_1 72_0 72_1; do echo \"$job|PENDING|\"; done",
    "scancel": "echo $@ >> cancelled",
}
"""Commands of a cluster whose machines are always busy."""


def test_slurm_gets_arrays_with_what_the_grid_says_and_ctrl_c_cancels_what_waits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("submitit", reason="submitit is not installed: pip install '.[slurm]'")
    for name, script in SLURM.items():
        (tmp_path / name).write_text(f"#!/bin/sh\ncd {tmp_path}\n{script}\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    axes = {"device": ["cpu", "cuda"], "seed": [0, 1]}
    grid = {"axes": axes, "options": OPTIONS, "slurm": {"slurm_partition": "short", "timeout_min": 9}}
    looks: list[Mapping[str, float]] = []
    table = ms.sweep(grid, tmp_path / "out", on="slurm", progress=lambda shares: looks.append(shares) or len(looks) < 3)
    assert list(table.fault) == ["not finished"] * 4
    submitted = (tmp_path / "submitted").read_text()
    assert submitted.count("#SBATCH --array=0-1") == 2
    assert submitted.count("#SBATCH --partition=short") == submitted.count("#SBATCH --time=9") == 2
    assert submitted.count("#SBATCH --gpus-per-node=1") == 1
    assert sorted((tmp_path / "cancelled").read_text().split()) == ["71_0", "71_1", "72_0", "72_1"]


RAY = """
import os, signal, sys
import maulstick as ms

def ours(*_):
    raise KeyboardInterrupt

signal.signal(signal.SIGTERM, ours)
grid, out = eval(sys.argv[1]), sys.argv[2]
seen = []
def progress(shares):
    seen.append((signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)))
table = ms.sweep(grid, out, on="ray", at_once=2, progress=progress)
assert list(table.fault) == ["", ""], table.fault
assert set(seen) == {(signal.default_int_handler, ours)}, seen
assert signal.getsignal(signal.SIGTERM) is ours
print("done")
"""


def test_a_ray_cluster_plans_all_cells_the_same_to_the_bit_and_leaves_signals_alone(
    planned_here: Path, tmp_path: Path
) -> None:
    pytest.importorskip("ray", reason="Ray is not installed: pip install '.[ray]'")
    ran = subprocess.run(
        [sys.executable, "-c", RAY, repr(GRID), tmp_path / "out"],
        capture_output=True,
        text=True,
        timeout=90,
        env={**os.environ, "OMP_NUM_THREADS": "1", "RAY_worker_niceness": "0"},  # or other tests starve them
    )
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.splitlines()[-1] == "done"
    for cell in ("seed-0", "seed-1"):
        assert results(tmp_path / "out" / cell) == results(planned_here / cell)


@pytest.mark.parametrize("address", ["127.0.0.1:1", "ray://127.0.0.1:1", "127.0.0.1:99999"])
def test_a_ray_cluster_that_is_not_there_is_told_in_one_line(tmp_path: Path, address: str) -> None:
    pytest.importorskip("ray", reason="Ray is not installed: pip install '.[ray]'")
    with pytest.raises(MachineError, match=f"the Ray cluster {address} does not answer: .*; start it, or check its"):
        ms.sweep(GRID, tmp_path / "out", on=f"ray:{address}")


def test_an_engine_that_is_not_installed_is_told_with_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for on, module in (("ray", "ray"), ("slurm", "submitit")):
        monkeypatch.setitem(sys.modules, module, None)
        with pytest.raises(InputError, match=re.escape(how_to_add(on))):
            ms.sweep(GRID, tmp_path / "out", on=on)
