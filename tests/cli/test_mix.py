from pathlib import Path

import pytest

from maulstick.colour.tubes import USUAL_PAINTS
from maulstick.painting.painting import Paint, Painting, Provenance, Sheet, Stroke
from maulstick.painting.painting_file import write_painting
from tests.cli.conftest import run
from tests.support.nominal import nominal

YELLOW = next(paint.colour for paint in USUAL_PAINTS if paint.name == "hansa yellow")
PAINTS = (
    Paint(colour=YELLOW, brush="round"),
    Paint(colour=(0.0, 1.0, 0.0), brush="round"),
    Paint(colour=(0.2, 0.2, 0.6), brush="round", name="my blue"),
)


@pytest.fixture
def painting(tmp_path: Path) -> Path:
    path = ((0.01, 0.01, 0.5), (0.04, 0.05, 0.5))
    plan = Painting(
        sheet=Sheet(width=0.1, height=0.08),
        provenance=Provenance(version="1"),
        brushes={"round": nominal("round")},
        paints=PAINTS,
        strokes=tuple(Stroke(id=i, paint=p, trajectory=path) for i, p in enumerate((0, 0, 1))),
    )
    write_painting(plan, tmp_path / "painting.json")
    return tmp_path / "painting.json"


@pytest.fixture(autouse=True)
def _wide(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "160")


def rows(out: str) -> list[list[str]]:
    lines = [line for line in out.splitlines() if line.startswith("│")]
    return [[cell.strip() for cell in line.strip("│").split("│")] for line in lines]


def test_each_paint_has_its_metres_its_recipe_and_how_near_that_comes(painting: Path) -> None:
    ran = run("mix", painting)
    assert (ran.code, ran.stderr) == (0, "")
    assert "from usual acrylics" in ran.stdout
    yellow, green, blue = rows(ran.stdout)
    assert yellow == ["1     #f4dd1c", "0.10", "hansa yellow alone", "#f4dd1c, the same to the eye (0.0)"]
    assert green[:2] == ["2     #00ff00", "0.05"]
    assert "out of reach" in green[3]
    assert blue == ["3     my blue #333399", "0.00", "as it is in its tube", ""]


def test_paints_that_are_at_hand_are_mixed_and_named_ones_too(painting: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.csv").write_text("snow,#ffffff\nnight,#000040\n")
    ran = run("mix", painting, "--from", tmp_path / "mine.csv")
    assert (ran.code, ran.stderr) == (0, "")
    found = rows(ran.stdout)
    assert len(found) == 3
    for _, _, recipe, _ in found:
        assert "snow" in recipe or "night" in recipe
    assert " parts snow + 1 part night" in found[2][2]


def test_a_painting_without_paints_needs_none(tmp_path: Path) -> None:
    plan = Painting(
        sheet=Sheet(width=0.1, height=0.08), provenance=Provenance(version="1"), brushes={}, paints=(), strokes=()
    )
    write_painting(plan, tmp_path / "bare.json")
    ran = run("mix", tmp_path / "bare.json")
    assert (ran.code, rows(ran.stdout)) == (0, [])


def test_a_mistake_is_one_line(painting: Path, tmp_path: Path) -> None:
    ran = run("mix", tmp_path / "none.json")
    assert (ran.code, ran.mistake) == (2, f"there is no painting {tmp_path / 'none.json'}; check its name and folder")
    (tmp_path / "mine.csv").write_text("snow,wintry\n")
    ran = run("mix", painting, "--from", tmp_path / "mine.csv")
    assert ran.code == 2
    assert ran.mistake == (
        f"{tmp_path / 'mine.csv'}, line 1: 'wintry' is not a colour; write a name such as black, or #rrggbb"
    )
