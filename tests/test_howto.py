"""The page "How do I …": each of its lines and snippets, in order, plans with few strokes and steps."""

import io
import re
import runpy
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import skimage

from tests.cli.conftest import run
from tests.cli.test_brush_fit import draw_trials
from tests.support.pages import ROOT, blocks, lines
from tests.support.recording.motive_export import motive_csv
from tests.support.recording.simulated_take import loops_and_lines, simulate
from tests.support.robot.fake_grbl import FakeGrbl

PAGE = ROOT / "docs" / "howto.md"
TEXT = PAGE.read_text(encoding="utf-8")
FEW = ("--strokes", "24", "--steps", "3", "--px", "40")
FEW_IN_PYTHON = "strokes=24, steps=3, px=40"
PORT = "/dev/ttyUSB0"
SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="150mm" height="100mm" viewBox="0 0 150 100">{}</svg>'
WAVES = (f'<path fill="none" d="M{10 + 20 * (i % 6)} {15 + 17 * (i // 6)} q5 {i - 20} 12 {i / 3}"/>' for i in range(30))
POSTER = '<circle cx="40" cy="50" r="10"/><rect x="80" y="30" width="20" height="20" fill="#a03020"/>'

pytestmark = pytest.mark.filterwarnings("ignore:libmypaint is not installed")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A folder with what files on the page stand for, in which the tests run."""
    folder = tmp_path_factory.mktemp("howto")
    skimage.io.imsave(folder / "cat.jpg", skimage.data.chelsea())
    for name in ("map.svg", "map.toml"):
        shutil.copy(ROOT / "docs" / "directing" / name, folder)
    shutil.copytree(ROOT / "examples", folder / "examples")
    skimage.io.imsave(folder / "sheet.jpg", np.full((200, 250, 3), 240, np.uint8), check_contrast=False)
    (folder / "drawing.svg").write_text(SVG.format("".join(WAVES)))
    (folder / "poster.svg").write_text(SVG.format(POSTER))
    (folder / "tubes.csv").write_text("name,colour\nblack,#101010\nochre,#c08040\nwhite,#f7f7f2\n")
    (folder / "take.csv").write_bytes(motive_csv(simulate(loops_and_lines(5), 1).take))
    (grid,) = blocks(PAGE, "toml")
    few = grid.replace('"loops", ', "")
    (folder / "grid.toml").write_text(f"{few}strokes = 12\nsteps = 3\npx = 40\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_DATA_HOME", str(folder / "data"))
        patch.chdir(folder)
        draw_trials("trials", 5)
        yield folder


@pytest.fixture(scope="module")
def said(folder: Path) -> dict[str, str]:
    """What each line said; every one has ended well."""
    said = {}
    with FakeGrbl(pace=400) as plotter, pytest.MonkeyPatch.context() as patch:
        for line in lines(PAGE):
            patch.setattr("sys.stdin", io.StringIO("\n" * 20))  # pens are put in when they are asked for
            words = shlex.split(line.replace(PORT, plotter.port))
            if words[0] == "python":
                patch.setattr("sys.argv", [words[1], *words[2:], *FEW[:4]])
                runpy.run_path(words[1], run_name="__main__")
            elif words != ["maulstick", "studio"]:  # tests/test_readme.py opens it
                few = FEW if words[1] == "plan" else ("--px", "240") if words[1:3] == ["style", "show"] else ()
                ran = run(*words[1:], *few)
                assert ran.code == 0, f"{line}: {ran.stderr}"
                said[line] = ran.stdout + ran.stderr
    return said


def test_there_are_twenty_answers_and_more_each_with_something_to_type() -> None:
    answers = TEXT.split("\n### ")[1:]
    assert len(answers) > 20
    assert [answer.splitlines()[0] for answer in answers if "`" not in answer] == []
    assert all(re.match(r"… .+\?\n", answer) for answer in answers)


def test_every_line_of_the_page_does_what_it_says(said: dict[str, str], folder: Path) -> None:
    assert all(line.startswith(("maulstick ", "python examples/")) for line in lines(PAGE))
    for made in re.findall(r"--(?:out|plot) ([\w.-]+)", TEXT):
        assert (folder / made).exists(), made
    assert (folder / "cat" / "painting-painted.png").is_file()
    assert len(said["maulstick style list"].splitlines()) > 8
    assert "micron-01" in said["maulstick brush pens"]
    assert "white" in said["maulstick mix cat/painting.json --from tubes.csv"]


def test_every_snippet_of_python_runs(said: dict[str, str], folder: Path) -> None:
    for code in blocks(PAGE, "python"):
        quick = re.sub(r"strokes=\d+", FEW_IN_PYTHON, code)
        exec(compile(quick, "docs/howto.md", "exec"), {})
    assert all(
        (folder / name).is_file() for name in ("cat.json", "cat.png", "mine.svg", "directed.json", "painted.png")
    )
