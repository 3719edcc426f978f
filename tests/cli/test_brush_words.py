"""The words that look at brushes."""

from pathlib import Path

import pytest
from PIL import Image

from maulstick.painting.brush import BRUSHES, Brush, write_brush
from maulstick.painting.painting_file import read_painting
from maulstick.painting.pens import PENS
from tests.cli.conftest import paint, run
from tests.cli.test_brush_fit import rows


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which the commands run; an own brush is kept under it."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.chdir(tmp_path)
    write_brush(Brush(name="twig", source="a [b]test[/b]", alpha=2e-3, beta=-1e-3), BRUSHES.own() / "twig.json")
    return tmp_path


def test_the_list_has_the_brushes_that_come_along_and_the_own_ones(here: Path) -> None:
    ran = run("brush", "list")
    listed = rows(ran.stdout)
    assert ran.code == 0
    assert list(listed) == ["fineliner", "marker", "round", "wash", "twig"]
    assert listed["fineliner"].startswith("0.312 mm comes with Maulstick: a fineliner")
    assert listed["round"].startswith("0.686 to 15.8 mm comes with Maulstick: a 6 mm round")
    assert listed["twig"] == "0 to 2 mm your own: a [b]test[/b]"


def test_a_broken_brush_does_not_hide_the_others(here: Path) -> None:
    (BRUSHES.own() / "twig.json").write_text("{}")
    listed = rows(run("brush", "list").stdout)
    assert "twig.json is not a brush: name: Field required" in listed["twig"]
    assert "round" in listed
    assert "twig.json is not a brush: name: Field required" in run("plan", "--demo", "--brush", "twig").mistake


@pytest.mark.parametrize("name", ["twig", "round"])
def test_a_brush_is_shown_by_its_name(here: Path, name: str) -> None:
    assert run("brush", "show", name, "--px", "300") == (0, f"{name}.png\n", "")
    with Image.open(f"{name}.png") as image:
        assert image.height == 300


def test_a_brush_is_shown_by_its_file(here: Path) -> None:
    path = BRUSHES.own() / "twig.json"
    assert run("brush", "show", path, "--px", "240") == (0, "twig.png\n", "")
    assert run("brush", "show", "twig", "--px", "240", "--out", "same.png").code == 0
    assert Path("twig.png").read_bytes() == Path("same.png").read_bytes()


@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        (["broom"], 2, "there is no brush 'broom'; there are: FILE.json, fineliner, marker, round, twig"),
        (["none.json"], 2, "there is no brush none.json; check its name and folder"),
        (["twig", "--px", "5"], 2, "--px is 5; it must be from 240 to 2400"),
        (["twig", "--out", "a.jpg"], 2, "--out is a.jpg; a picture is written as PNG, so let its name end in .png"),
        (["twig", "--out", "there.png"], 1, "there.png is already there; choose another --out, or add --overwrite"),
    ],
)
def test_what_cannot_be_shown_is_refused(here: Path, words: list[str], code: int, text: str) -> None:
    Path("there.png").write_bytes(b"before")
    ran = run("brush", "show", *words)
    assert ran.code == code
    assert ran.mistake.startswith(text)
    assert Path("there.png").read_bytes() == b"before"


def test_a_picture_of_a_brush_is_replaced_when_told_to(here: Path) -> None:
    Path("twig.png").write_bytes(b"before")
    assert run("brush", "show", "twig", "--px", "240", "--overwrite").code == 0
    assert Path("twig.png").read_bytes() != b"before"


def test_the_catalogue_of_pens_is_listed_with_the_own_ones(here: Path) -> None:
    PENS.own().mkdir(parents=True)
    mine = '{"maker": "Nobody", "model": "0.7", "kind": "gel pen", "width": 0.0007, "colour": "#1a33b2"}'
    (PENS.own() / "mine.json").write_text(mine)
    (PENS.own() / "fineliner.json").write_text(mine)
    (PENS.own() / "torn.json").write_text(mine[:9])
    write_brush(Brush(name="micron-03", source="photographs", alpha=0, beta=2e-4), BRUSHES.own() / "micron-03.json")
    write_brush(Brush(name="biro", source="photographs", alpha=0, beta=3e-4), BRUSHES.own() / "biro.json")
    (BRUSHES.own() / "rotten.json").write_text("{}")
    ran = run("brush", "pens")
    listed = rows(ran.stdout)
    assert ran.code == 0
    assert listed["micron-01"] == "0.25 mm #000000 fineliner Sakura Pigma Micron 01"
    assert listed["mine"] == "0.7 mm #1a33b2 gel pen your own: Nobody 0.7"
    assert listed["micron-03"] == "0.4 mm #000000 fineliner your own brush: photographs"
    assert listed["fineliner"].startswith("0.312 mm #1a33b2 gel pen a brush that comes with Maulstick: a fineliner, ")
    assert "torn.json is not a pen" in listed["torn"]
    assert listed["biro"].split() == ["0.6", "mm", "your", "own", "brush:", "photographs"]
    assert not {"twig", "rotten", "marker"} & listed.keys(), "the first varies, and the last comes along"


def test_a_plan_is_made_for_a_pen_in_its_colour(here: Path) -> None:
    ran = paint(here / "out", "--pen", "micron-05")
    assert ran.code == 0, ran.stderr
    plan = read_painting(here / "out" / "painting.json")
    assert list(plan.brushes) == ["micron-05"]
    assert [each.hex for each in plan.paints] == ["#000000"]
    assert run("plan", "--demo", "--pen", "round").mistake.endswith("so it is no pen; plan with it as a brush")
    both = run("plan", "--demo", "--pen", "micron-05", "--brush", "round")
    assert both.mistake == "--pen and --brush both say what to draw with; leave out one"
