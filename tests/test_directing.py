"""The tutorial on directing a portrait: its lines, in order; plans with fewer strokes and steps."""

import json
import shutil
from pathlib import Path

import pytest

from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting
from tests.support.pages import DOCS, lines, typed

LINES = lines(DOCS / "directing.md")
FEWER = ("--steps", "6", "--px", "96")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the lines were typed."""
    folder = tmp_path_factory.mktemp("directing")
    for file in (DOCS / "directing").iterdir():
        shutil.copy(file, folder)
    for line in LINES:
        words = line.split()
        if words[1] == "plan":
            words += FEWER
        if "--strokes" in words:
            words[words.index("--strokes") + 1] = "120"
        if "--add" in words:
            last = len(read_painting(folder / "first" / "painting.json").paints)
            words[words.index("--add") + 1] = f"{last}:signature.json"
        ran = typed(" ".join(words), folder)
        assert ran.code == 0, f"{line}: {ran.stderr}"
    return folder


def locked(painting: Painting) -> dict[int, object]:
    return {
        stroke.id: (stroke.trajectory, stroke.region, stroke.origin) for stroke in painting.strokes if stroke.locked
    }


def test_each_line_of_the_tutorial_runs_and_is_there_once() -> None:
    assert [line.split()[1] for line in LINES] == ["plan", "edit", "plan", "paint"]


def test_the_face_and_the_signature_stay_to_the_bit(folder: Path) -> None:
    first, mine, second = (
        read_painting(folder / name) for name in ("first/painting.json", "mine.json", "second/painting.json")
    )
    signed = len(json.loads((folder / "signature.json").read_text())["strokes"])
    face = [stroke for stroke in first.strokes if stroke.region == "face"]
    assert len(locked(mine)) == len(face) + signed
    assert locked(second) == locked(mine)
    assert sum(stroke.origin == "person" for stroke in second.strokes) == signed


def test_the_portrait_has_three_brushes_two_hands_and_bare_paper(folder: Path) -> None:
    painting = read_painting(folder / "second" / "painting.json")
    assert len(painting.brushes) >= 3
    assert {stroke.style.name for stroke in painting.strokes if stroke.style} == {"loops", "hatching"}
    assert {stroke.region for stroke in painting.strokes} == {"face", "suit", "rest", None}
