"""The command line and Python where there is no PyTorch, as on a small computer beside a plotter."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import PORTRAIT, Ran, run, run_command
from tests.support.without_torch import TAUGHT, hide_torch


@pytest.fixture(scope="module")
def without(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A folder for PYTHONPATH, with which nothing finds torch."""
    return hide_torch(tmp_path_factory.mktemp("without"))


@pytest.fixture
def painting(painted: tuple[Path, Ran], tmp_path: Path) -> Path:
    """A painting alone in a folder of its own."""
    return Path(shutil.copy(painted[0] / "painting.json", tmp_path))


def test_a_painting_is_painted_without_torch(without: str, painting: Path) -> None:
    ran = run_command("paint", painting, PYTHONPATH=without)
    assert ran.code == 0, ran.stderr
    assert painting.with_name("painting-painted.png").is_file()


@pytest.mark.parametrize("format", ["gcode", "svg"])
def test_an_svg_is_exported_without_torch_as_with_it(without: str, format: str, tmp_path: Path) -> None:
    drawing = tmp_path / "drawing.svg"
    drawing.write_text('<svg xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm"><path d="M1 1 20 9"/></svg>')
    for name, environment in (("with", {}), ("without", {"PYTHONPATH": without})):
        ran = run_command("export", drawing, "--format", format, "--out", tmp_path / name, **environment)
        assert ran.code == 0, ran.stderr
    assert (tmp_path / "without").read_bytes() == (tmp_path / "with").read_bytes()


@pytest.mark.parametrize(
    "words",
    [
        ["plan", "--demo", "--out", "new"],
        ["render", "painting.json"],
        ["style", "show", "loops", "--out", "loops.png"],
        ["paint", "painting.json", "--replan", "5", "--picture", PORTRAIT],
    ],
    ids=lambda words: words[0],
)
def test_what_needs_torch_says_how_to_install_it_and_leaves_nothing_behind(
    words: list[str], without: str, painting: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(painting.parent)
    ran = run_command(*words, PYTHONPATH=without)
    assert (ran.code, ran.mistake) == (2, TAUGHT)
    assert [path.name for path in painting.parent.iterdir()] == ["painting.json"]


def test_python_paints_without_torch_and_says_what_planning_needs(without: str, painting: Path) -> None:
    script = f"""
import maulstick as ms

ms.paint(ms.read_painting({str(painting)!r}), robot="sim")
for use in (lambda: ms.plan, lambda: ms.render, lambda: ms.load_style("loops"), lambda: ms.fit_brush("trials")):
    try:
        use()
    except ValueError as error:
        print(error)
"""
    ran = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"PYTHONPATH": without},
    )
    assert ran.stdout.splitlines() == 4 * [TAUGHT]


def test_a_module_of_ours_that_is_missing_is_no_fault_of_an_installation(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "maulstick.cli.mix", None)
    with pytest.raises(ModuleNotFoundError, match=r"maulstick\.cli\.mix"):
        run("mix", "painting.json")
