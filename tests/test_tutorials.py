"""The tutorials: every line and every snippet of them, in order; plans with fewer strokes and steps."""

import io
import os
import re
import runpy
import shutil
import signal
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from types import ModuleType

import pytest

import maulstick as ms
from maulstick.jobs.paint import camera_loop
from maulstick.robot.easel import read_easel
from maulstick.robot.journal import Journal, journal_of
from tests.cli.conftest import Ran
from tests.robot.test_xarm import FakeXArmAPI
from tests.support.pages import DOCS, ROOT, blocks, blocks_of, keys, lines, python, typed
from tests.support.robot.fake_ebb import FakeEbb
from tests.support.robot.fake_grbl import FakeGrbl
from tests.support.robot.under_way import once

TUTORIALS = DOCS / "tutorials"
PLOTTER, TABLET, ARM = (TUTORIALS / f"{name}.md" for name in ("plotter", "tablet", "mocap-arm"))
FEWER = ("--steps", "6", "--px", "64")
STROKES, PRACTICE = "20", "6"
RIGHT, UP = "\x1b[C", "\x1b[A"
AXIDRAW, GRBL = "bp+pwq", "1" + RIGHT + "o" + "bwq"
ENTER = 20 * "\n"
HEAVIEST = 150_000  # bytes of a picture


def few(line: str) -> str:
    """A line that plans, with so few strokes that it takes no time."""
    words = line.split()
    if "--strokes" in words:
        words[words.index("--strokes") + 1] = PRACTICE if "calibrate" in words else STROKES
    return " ".join(words + [*FEWER] * (words[1] == "plan"))


@pytest.fixture(scope="module", autouse=True)
def _own_data(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Styles, brushes and logbooks of this module's readers alone."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_DATA_HOME", str(tmp_path_factory.mktemp("readers")))
        yield


def test_the_pictures_of_the_pages_are_those_that_the_script_makes_and_small() -> None:
    made = runpy.run_path(str(ROOT / "experiments" / "tutorials.py"))["SHOWN"]
    pictures = {f"{page}-{shown}.jpg" for page, names in made.items() for shown in names.values()}
    assert pictures == {path.name for path in TUTORIALS.glob("*.jpg")}
    for page in (PLOTTER, TABLET, ARM):
        pictures -= {*re.findall(rf"\(({page.stem}-[\w-]+\.jpg)\)", page.read_text(encoding="utf-8"))}
    assert pictures == set()
    assert max(path.stat().st_size for path in TUTORIALS.glob("*.jpg")) < HEAVIEST


# a plotter and a pen


@pytest.fixture(scope="module")
def plotted(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Ran]]:
    """A folder in which the lines about plotters were typed, beside two machines, and what each line said."""
    folder = tmp_path_factory.mktemp("plotter")
    for file in (TUTORIALS / "pens.csv", DOCS / "gallery" / "boat.svg"):
        shutil.copy(file, folder)
    said: dict[str, Ran] = {}
    with FakeEbb(pace=1000.0) as ebb, FakeGrbl(pace=1000.0) as grbl:
        ports = {"axidraw ": f"axidraw:{ebb.port} ", "/dev/ttyUSB0": grbl.port}
        for line in lines(PLOTTER):
            shorter = few(line)
            for name, port in ports.items():
                shorter = shorter.replace(name, port) if " plan " not in line else shorter
            said[line] = beside(ebb, line, shorter, folder)
    return folder, said


def beside(ebb: FakeEbb, line: str, shorter: str, folder: Path) -> Ran:
    """Type a line, and do what the page says to do beside it: press keys, put in pens, stop the first drawing."""
    if line.startswith("maulstick machine ") and "--log" not in line:
        with keys(GRBL if "grbl" in line else AXIDRAW) as stdin:
            ran = typed(shorter, folder, stdin=stdin)
    elif line == "maulstick paint drawing/painting.json --robot axidraw --easel easel.json":
        begun = len(ebb.reached)
        with once(lambda: len(ebb.reached) > begun + 12, lambda: os.kill(os.getpid(), signal.SIGINT)):
            ran = typed(shorter, folder, stdin=io.StringIO(ENTER))
        assert ran.code == 130, ran.stderr
        return ran
    else:
        ran = typed(shorter, folder, stdin=io.StringIO(ENTER))
    assert ran.code == 0, f"{line}: {ran.stderr}"
    return ran


def painted(path: Path) -> int:
    with Journal.open(journal_of(path)) as journal:
        return len(journal.painted)


def test_a_drawing_is_stopped_goes_on_and_is_whole(plotted: tuple[Path, dict[str, Ran]]) -> None:
    folder, said = plotted
    path = folder / "drawing" / "painting.json"
    painting = ms.read_painting(path)
    assert painted(path) == len(painting.strokes) > 0
    assert len(painting.paints) == 1
    stopped = said["maulstick paint drawing/painting.json --robot axidraw --easel easel.json"]
    assert "--resume goes on" in " ".join(stopped.stderr.split())


def test_walking_to_the_corners_writes_the_pen_into_the_easel(plotted: tuple[Path, dict[str, Ran]]) -> None:
    folder, _ = plotted
    assert read_easel(folder / "easel.json").pen is not None
    pen = read_easel(folder / "easel-grbl.json").pen
    assert pen is not None
    assert (pen.up, pen.down) == (700, 500)


def test_each_pen_is_asked_for(plotted: tuple[Path, dict[str, Ran]]) -> None:
    folder, said = plotted
    (ran,) = (ran for line, ran in said.items() if "--pause-at" in line)
    used = {stroke.paint for stroke in ms.read_painting(folder / "three" / "painting.json").strokes}
    assert ran.stderr.count("put in ") == len(used) > 1
    assert "before stroke 5" in ran.stderr or "stroke 5" in ran.stderr


def test_files_for_other_senders_are_written(plotted: tuple[Path, dict[str, Ran]]) -> None:
    folder, said = plotted
    written = {path.suffix for path in (folder / "drawing").iterdir()}
    assert {".gcode", ".hpgl", ".svg"} <= written or {".nc", ".plt"} <= written
    assert " m" in said["maulstick machine --log"].stdout


# a tablet and your own hand


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the lines about a hand of one's own were typed."""
    folder = tmp_path_factory.mktemp("tablet")
    for name in ("wine.svg", "formulas.json"):
        shutil.copy(TUTORIALS / name, folder)
    for line in lines(TABLET):
        ran = typed(few(line), folder)
        assert ran.code == 0, f"{line}: {ran.stderr}"
    (snippet,) = blocks(TABLET, "python")
    python(["-c", snippet.replace("strokes=800", "strokes=12, steps=4, px=64")], folder)
    return folder


def test_the_drawing_becomes_a_hand_and_plans_are_drawn_in_it(drawn: Path) -> None:
    assert {"wine.png", "mine.png", "three.png", "colours.png"} <= {path.name for path in drawn.iterdir()}
    for name in ("large/painting.json", "small/painting.json", "alone/painting.json", "colours.json"):
        painting = ms.read_painting(drawn / name)
        assert {stroke.style.name for stroke in painting.strokes if stroke.style} == {"mine"}, name


def test_the_tablets_file_has_pressure_and_times(drawn: Path) -> None:
    assert "pressure recorded" in ms.read_ink(drawn / "formulas.ink.npz").summary()


# motion capture, a camera and an arm


@pytest.fixture(scope="module")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Ran]]:
    """A folder in which the page about an arm was followed from its beginning to its end, and what each line said."""
    pytest.importorskip("xarm.core.config.x_code")
    folder = tmp_path_factory.mktemp("arm")
    for name in ("tubes.csv", "tray.json", "easel.json"):
        shutil.copy(TUTORIALS / name, folder)
    library = ModuleType("xarm.wrapper")
    library.XArmAPI = FakeXArmAPI  # type: ignore[attr-defined]
    said: dict[str, Ran] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "xarm.wrapper", library)
        patch.setattr(camera_loop, "replanned", partial(camera_loop.replanned, steps=6))
        for language, block in blocks_of(ARM, "sh", "python"):
            if language == "python":
                python(["-c", block], folder)
                continue
            for line in block.splitlines():
                said[line] = typed(few(line).replace("--replan 50", "--replan 5"), folder)
                assert said[line].code == 0, f"{line}: {said[line].stderr}"
    return folder, said


def test_a_take_becomes_a_hand_and_a_brush_is_fitted_to_photographs(simulated: tuple[Path, dict[str, Ran]]) -> None:
    folder, said = simulated
    assert len(ms.read_ink(folder / "hand.ink.npz")) == 30
    painting = ms.read_painting(folder / "cat" / "painting.json")
    assert {stroke.style.name for stroke in painting.strokes if stroke.style} == {"hand"}
    assert [brush.name for brush in painting.brushes.values()] == ["felt"]
    (camera,) = (ran.stdout for line, ran in said.items() if " camera " in line)
    assert camera.startswith("4 tags: ")


def test_it_is_painted_with_looks_on_the_way(simulated: tuple[Path, dict[str, Ran]]) -> None:
    folder, _ = simulated
    names = {path.name for path in (folder / "cat").iterdir()}
    assert {"painting.r1.json", "painting.r1.png", "painting.r2.json", "painting-painted.png"} <= names


def test_the_arm_was_asked_and_nothing_moved(simulated: tuple[Path, dict[str, Ran]]) -> None:
    (ran,) = (ran for line, ran in simulated[1].items() if "xarm:" in line)
    assert "strokes" in ran.stderr + ran.stdout
    assert FakeXArmAPI.latest.asked
    assert not FakeXArmAPI.latest.sent
