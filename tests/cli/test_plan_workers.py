"""Murals on the command line: by any number of workers the same, also after one was killed."""

import os
import sys
from functools import partial
from pathlib import Path

import pytest
from PIL import Image
from skimage.data import astronaut

from maulstick.jobs.plan import checkpoints
from maulstick.jobs.plan.window_pool import _Worker
from maulstick.painting.brush import load_brush
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.window import Window
from tests.cli.conftest import RESULTS, Running, contents, paint, run

WITH_SMALL_WINDOWS = (sys.executable, "-m", "tests.support.cli.small_windows")
STRIP = (
    "--size",
    "320x30mm",
    "--brush",
    "fineliner",
    "--strokes",
    "120",
    "--paints",
    "3",
    "--steps",
    "3",
    "--px",
    "24",
)


@pytest.fixture
def picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A picture of which, while this test runs, a mural of eight windows is made."""

    monkeypatch.setattr("maulstick.jobs.plan.prepare.LONGEST_PX", 40)
    monkeypatch.setattr("maulstick.jobs.plan.inputs.LONGEST_PX", 40)
    monkeypatch.setattr("maulstick.jobs.plan.prepared.plan_mural", partial(plan_mural, window_px=32))
    file = tmp_path / "strip.png"
    Image.fromarray(astronaut()[100:148]).save(file)
    return file


def test_a_worker_that_is_killed_leaves_a_plan_that_fewer_workers_finish_as_if_nothing_had_been(
    picture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert paint(tmp_path / "one", *STRIP, "--workers", "1", photo=picture).code == 0
    begin = _Worker.begin

    def begin_and_die(worker: _Worker, window: Window) -> None:
        begin(worker, window)
        if window.index == 3:
            worker.process.kill()

    out = tmp_path / "out"
    with monkeypatch.context() as patch:
        patch.setattr(checkpoints, "_EVERY", 0.0)
        patch.setattr(checkpoints, "_SHARE", 0)
        patch.setattr(_Worker, "begin", begin_and_die)
        died = paint(out, *STRIP, "--workers", "2", photo=picture)
    assert died.code == 1
    assert died.stderr.endswith(
        f"maulstick plan --resume {out} goes on from what was kept last\n"
        "maulstick: window 4 of the mural is not planned: its process was ended by SIGKILL, most likely for want of "
        "memory: ask for fewer --workers\n"
    )
    assert os.listdir(out) == ["plan-0.npz"]
    gone_on = run("plan", "--resume", out, "--workers", "1")
    assert gone_on.code == 0, gone_on.stderr
    assert sorted(os.listdir(out)) == RESULTS
    assert contents(out) == contents(tmp_path / "one")


def test_a_mural_that_is_stopped_has_results_and_goes_on_as_if_it_had_not(picture: Path, tmp_path: Path) -> None:
    words, out = ("plan", picture, *STRIP, "--steps", "40"), tmp_path / "out"
    running = Running(*words, "--workers", "2", "--out", out, command=WITH_SMALL_WINDOWS)
    running.interrupt_after(r" (1[2-9]|[2-5]\d) %")
    assert running.leave() == 130, running.said
    assert "Traceback" not in running.said
    assert sorted(os.listdir(out)) == sorted([*RESULTS, "plan-0.npz"])
    hurried = contents(out)
    assert run("plan", "--resume", out).code == 0
    assert run(*words, "--workers", "1", "--out", tmp_path / "whole").code == 0
    resumed = contents(out)
    assert resumed == contents(tmp_path / "whole")
    assert resumed["painting.json"] != hurried["painting.json"]


def test_how_pale_lines_are_planned_is_said_of_the_windows_not_of_the_whole(picture: Path, tmp_path: Path) -> None:
    ran = paint(tmp_path / "out", *STRIP, "--workers", "1", photo=picture)
    thinnest = load_brush("fineliner").thinnest * 24 / 0.03
    assert f"the thinnest mark of the brush fineliner is {thinnest:.2f} pixels in half-width at this" in ran.stderr


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--workers", "0"], "--workers is 0; it must be from 1 to 32"),
        (["--workers", "33"], "--workers is 33; it must be from 1 to 32"),
        (
            ["--workers", "2"],
            "--workers says how many windows of a large canvas are planned at the same time, and this canvas is "
            "planned in one piece, on all cores; leave it out, or choose a larger --px",
        ),
    ],
)
def test_workers_without_windows_are_refused(tmp_path: Path, words: list[str], text: str) -> None:
    ran = paint(tmp_path / "out", *words)
    assert ran.code == 2
    assert ran.mistake == text
    assert os.listdir(tmp_path) == []
