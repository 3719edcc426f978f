import io
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from maulstick.jobs.plan import checkpoints as keeping
from maulstick.painting.brush import load_brush, write_brush
from maulstick.planning.state import KIND
from maulstick.storage.arrays import read_arrays, write_arrays
from tests.cli.conftest import PORTRAIT, QUICK, RESULTS, Ran, Running, contents, paint, run
from tests.support.tolerances import FILE_METRES

MORTAL = (sys.executable, "-m", "tests.support.cli.mortal")


def killed(after: int, *words: str | Path) -> None:
    """Run ``maulstick`` until it has saved its plan so many times; then it is killed, and leaves nothing else."""
    command = [*MORTAL, str(after), *map(str, words)]
    ran = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    assert ran.returncode == -9, ran.stderr


def is_unfinished(out: Path) -> bool:
    return os.listdir(out) == ["plan-0.npz"]


@pytest.fixture(scope="module")
def picture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(shutil.copy(PORTRAIT, tmp_path_factory.mktemp("picture") / "astronaut.png"))


@pytest.fixture(scope="module")
def cut_off(picture: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a plan that was killed after 12 of its 30 steps, and that no test changes."""
    out = tmp_path_factory.mktemp("cut") / "off"
    killed(12, "plan", picture, *QUICK, "--out", out)
    assert is_unfinished(out)
    return out


@pytest.fixture
def out(cut_off: Path, tmp_path: Path) -> Path:
    """The same for a test of its own."""
    return Path(shutil.copytree(cut_off, tmp_path / "out"))


def test_a_plan_that_was_killed_goes_on_to_the_same_painting(out: Path, painted: tuple[Path, Ran]) -> None:
    ran = run("plan", "--resume", out)
    assert ran.code == 0, ran.stderr
    assert contents(out) == contents(painted[0])


def test_a_plan_may_be_killed_twice(out: Path, painted: tuple[Path, Ran]) -> None:
    killed(9, "plan", "--resume", out)
    assert is_unfinished(out)
    assert run("plan", "--resume", out).code == 0
    assert contents(out) == contents(painted[0])


def test_a_plan_that_was_stopped_has_results_and_goes_on_as_if_it_had_not(tmp_path: Path) -> None:
    words = ("plan", PORTRAIT, *QUICK, "--steps", "400")
    running = Running(*words, "--out", tmp_path / "out")
    running.interrupt_after(r"loss 0\.\d")
    assert running.leave() == 130
    assert sorted(os.listdir(tmp_path / "out")) == sorted([*RESULTS, "plan-0.npz"])
    hurried = contents(tmp_path / "out")
    assert run("plan", "--resume", tmp_path / "out").code == 0
    assert run(*words, "--out", tmp_path / "whole").code == 0
    resumed = contents(tmp_path / "out")
    assert resumed == contents(tmp_path / "whole")
    assert resumed["painting.json"] != hurried["painting.json"]


def test_a_folder_with_a_plan_that_was_cut_off_is_not_used_for_another(out: Path) -> None:
    before = contents(out)
    ran = paint(out)
    assert ran.code == 1
    assert ran.mistake == (
        f"the folder {out} holds a plan that was cut off; go on with maulstick plan --resume {out}, or add --overwrite"
    )
    assert contents(out) == before


def test_overwriting_begins_anew(out: Path, painted: tuple[Path, Ran]) -> None:
    assert paint(out, "--overwrite").code == 0
    assert contents(out) == contents(painted[0])


@pytest.mark.parametrize(
    ("words", "name"),
    [
        (["--seed", "1"], "--seed"),
        (["--strokes", "400"], "--strokes"),
        (["--demo"], "--demo"),
        (["--overwrite"], "--overwrite"),
        (["--clip-weights", "x.pt"], "--clip-weights"),
        ([PORTRAIT], "picture"),
    ],
)
def test_what_was_asked_then_is_not_asked_again(out: Path, words: list[str], name: str) -> None:
    ran = run("plan", "--resume", out, *words)
    assert ran.code == 2
    assert ran.mistake == f"--resume goes on with what was asked then; leave out {name}"
    assert is_unfinished(out)


@pytest.mark.parametrize("name", ["none", "empty", "painted", "file"])
def test_a_folder_without_a_plan_in_the_making_is_refused(tmp_path: Path, painted: tuple[Path, Ran], name: str) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "file").write_text("a file")
    folder = painted[0] if name == "painted" else tmp_path / name
    ran = run("plan", "--resume", folder)
    assert ran.code == 2
    assert ran.mistake == f"there is no unfinished plan in {folder}; name the folder that --out named when it began"


def test_a_damaged_plan_is_refused(out: Path) -> None:
    file = out / "plan-0.npz"
    file.write_bytes(file.read_bytes()[:-500])
    ran = run("plan", "--resume", out)
    assert ran.code == 2
    assert ran.mistake.startswith(f"{file} is not a file of plan in the making, or it is damaged: ")


def test_a_plan_of_another_version_is_refused(out: Path) -> None:
    file = out / "plan-0.npz"
    arrays = read_arrays(file, KIND)
    arrays["request"] = np.array(str(arrays["request"]).replace('"steps":', '"leaps":'))
    write_arrays(file, KIND, arrays)
    ran = run("plan", "--resume", out)
    assert ran.code == 2
    assert ran.mistake.startswith(f"{file} is of another version of Maulstick: ")
    assert ran.mistake.endswith("; plan anew")


def test_a_picture_that_has_changed_since_is_refused(out: Path, picture: Path) -> None:
    kept = picture.read_bytes()
    file = io.BytesIO()
    Image.open(picture).transpose(Image.Transpose.FLIP_LEFT_RIGHT).save(file, format="PNG")
    try:
        picture.write_bytes(file.getvalue())
        ran = run("plan", "--resume", out)
        picture.unlink()
        absent = run("plan", "--resume", out)
    finally:
        picture.write_bytes(kept)
    assert (ran.code, absent.code) == (2, 2)
    assert ran.mistake == f"{picture} has changed since planning began; put it back, or plan anew with --overwrite"
    assert absent.mistake == f"there is no picture {picture}; check its name and folder"
    assert is_unfinished(out)


def test_a_brush_that_has_changed_since_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class PowerCutError(Exception):
        """In the middle of planning."""

    def cut(*_: object) -> None:
        raise PowerCutError

    brush, mine = load_brush("round"), tmp_path / "mine.json"
    write_brush(brush, mine)
    with monkeypatch.context() as patch:
        patch.setattr(keeping, "_EVERY", 0.0)
        patch.setattr(keeping, "_SHARE", 0)
        patch.setattr("maulstick.jobs.plan.prepared.with_metrics", cut)
        with pytest.raises(PowerCutError):
            paint(tmp_path / "out", "--brush", mine)
    write_brush(brush.model_copy(update={"lag": brush.lag + FILE_METRES}), mine)
    ran = run("plan", "--resume", tmp_path / "out")
    assert ran.code == 2
    assert ran.mistake == "the brush has changed since planning began; put it back, or plan anew with --overwrite"
    write_brush(brush, mine)
    assert run("plan", "--resume", tmp_path / "out").code == 0
