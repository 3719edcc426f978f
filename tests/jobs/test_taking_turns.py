"""Taking turns on paper: a machine paints, a person draws, and the rest is planned over a photograph of the sheet."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageDraw

import maulstick as ms
from maulstick.errors import InputError
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.painting.stroke_edits import LockStrokes, edited
from maulstick.robot.journal import Journal, journal_of
from tests.cli.conftest import run
from tests.support.planned import picture

STEPS = 4


@pytest.fixture(scope="module")
def turn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make a folder with a picture, a plan of which ten strokes are painted, and a photograph of both people's work."""
    folder = tmp_path_factory.mktemp("turn")
    Image.fromarray((255 * picture()).astype(np.uint8)).save(folder / "disc.png")
    options: dict[str, Any] = {"strokes": 24, "paints": 3, "steps": 30, "px": 48, "size": "60x45mm", "brush": "marker"}
    painting = ms.plan(folder / "disc.png", style="loops", **options)
    locked = edited(painting, [LockStrokes(strokes=tuple(stroke.id for stroke in painting.strokes[8:12]))])
    file = folder / "painting.json"
    write_painting(locked, file)
    with Journal.open(journal_of(file)) as journal:
        journal.revise(file)
        for stroke in locked.strokes[:10]:
            journal.begin(stroke.id)
            journal.end(stroke.id)
        journal.begin(locked.strokes[10].id)
    done = locked.model_copy(update={"strokes": locked.strokes[:10]})
    photograph = ms.render(done, px=90)
    ImageDraw.Draw(photograph).ellipse((10, 10, 40, 40), outline=(200, 30, 30), width=5)
    photograph.save(folder / "sheet.png")
    return folder


@pytest.fixture(scope="module")
def before(turn: Path) -> Painting:
    return read_painting(turn / "painting.json")


@pytest.fixture(scope="module")
def after(turn: Path) -> Painting:
    return ms.plan(again=turn / "painting.json", background=turn / "sheet.png", steps=STEPS)


def test_what_is_painted_is_planned_no_more_and_what_is_left_goes_on(before: Painting, after: Painting) -> None:
    assert len(after.strokes) == 24 - 10, "a stroke that was only begun is left"
    places = {stroke.id: stroke for stroke in before.strokes[10:] if stroke.locked}
    kept = {stroke.id: stroke for stroke in after.strokes if stroke.locked}
    assert {name: stroke.trajectory for name, stroke in kept.items()} == {
        name: stroke.trajectory for name, stroke in places.items()
    }
    assert {paint.hex for paint in after.paints} <= {paint.hex for paint in before.paints}


def test_the_sheet_is_the_photograph_with_what_the_person_drew(turn: Path, after: Painting) -> None:
    assert (after.sheet.width, after.sheet.height) == (0.06, 0.045)
    shown = np.asarray(ms.render(after.model_copy(update={"strokes": ()}), px=90), dtype=float)
    seen = np.asarray(Image.open(turn / "sheet.png"), dtype=float)
    assert np.abs(shown - seen).mean() < 4
    assert shown[10:40, 11:14].mean(axis=(0, 1))[0] > shown[10:40, 11:14].mean(axis=(0, 1))[1] + 20


def test_the_command_plans_the_same(turn: Path, after: Painting, tmp_path: Path) -> None:
    words = ("--again", turn / "painting.json", "--background", turn / "sheet.png", "--steps", STEPS)
    assert run("plan", *words, "--out", tmp_path / "next").code == 0
    assert read_painting(tmp_path / "next" / "painting.json").strokes == after.strokes


def test_without_a_journal_nothing_is_painted_yet(turn: Path, before: Painting, tmp_path: Path) -> None:
    write_painting(before, tmp_path / "painting.json")
    again = ms.plan(turn / "disc.png", again=tmp_path / "painting.json", background=turn / "sheet.png", steps=1)
    assert len(again.strokes) == 24
    given = ms.plan(turn / "disc.png", again=before, background=turn / "sheet.png", steps=1)
    assert given.strokes == again.strokes


def test_once_all_is_painted_more_must_be_asked_for(turn: Path, before: Painting, tmp_path: Path) -> None:
    write_painting(before, tmp_path / "painting.json")
    with Journal.open(journal_of(tmp_path / "painting.json")) as journal:
        journal.revise(tmp_path / "painting.json", painted=[stroke.id for stroke in before.strokes])
    turns = {"again": tmp_path / "painting.json", "background": turn / "sheet.png", "steps": 1}
    with pytest.raises(InputError, match="all 24 strokes are locked or painted, and strokes asks for no more"):
        ms.plan(turn / "disc.png", **turns)
    assert len(ms.plan(turn / "disc.png", **turns, strokes=30).strokes) == 6


def test_a_photograph_settles_the_paper(turn: Path) -> None:
    with pytest.raises(
        InputError, match="again keeps the sheet, the paints and the pressure of the painting; leave out paper"
    ):
        ms.plan(again=turn / "painting.json", background=turn / "sheet.png", paper="grey")


def test_the_journal_of_another_painting_says_nothing(turn: Path, before: Painting, tmp_path: Path) -> None:
    write_painting(before, tmp_path / "painting.json")
    with Journal.open(journal_of(tmp_path / "painting.json")) as journal:
        journal.revise(tmp_path / "painting.json")
    write_painting(before.model_copy(update={"strokes": before.strokes[1:]}), tmp_path / "painting.json")
    with pytest.raises(InputError, match="was begun with; move the journal away"):
        ms.plan(turn / "disc.png", again=tmp_path / "painting.json", background=turn / "sheet.png", steps=1)


def test_a_plan_does_not_go_on_once_more_of_its_painting_is_on_paper(
    turn: Path, before: Painting, tmp_path: Path
) -> None:
    file = tmp_path / "painting.json"
    write_painting(before, file)
    request = PlanRequest(turn / "disc.png", PlanOptions(again=file, background=turn / "sheet.png"))
    for sheet in (1, 2):
        began = request.with_sums({})
        began.check_unchanged(request.with_sums({}).sums)
        with Journal.open(journal_of(file, sheet)) as journal:
            journal.revise(file)
        with pytest.raises(InputError, match=f"{journal_of(file, sheet).name} has changed since planning began"):
            began.check_unchanged(request.with_sums({}).sums)
