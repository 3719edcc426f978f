import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from maulstick.painting.painting import Paint, Painting, Provenance, Sheet, Stroke, StyleUse
from maulstick.painting.painting_file import write_painting
from maulstick.painting.picture import encode_png
from maulstick.painting.raster import Canvas
from maulstick.rendering.preview import preview
from maulstick.strokes.ink import Ink, write_ink
from tests.cli.conftest import run
from tests.cli.test_show import BRUSH, STYLE
from tests.support.nominal import nominal

MADE = Provenance(
    version="1",
    seed=7,
    options={"steps": 90, "weights": {"tone": 1.0, "edges": 0.25}},
    metrics={"psnr": 21.26, "ssim": 0.5},
)


def a_plan(strokes: int, colour: tuple[float, float, float] = (1.0, 0.0, 0.0), made: Provenance = MADE) -> Painting:
    """Strokes from the left edge to the right one, on the upper half of the picture's area."""
    use = StyleUse(name="cursive", hash="ab", code=(), pose=(0, 0, 0))
    return Painting(
        sheet=Sheet(width=0.1, height=0.08),
        area=(0.01, 0.01, 0.08, 0.06),
        provenance=made,
        brushes={"round": nominal("round")},
        paints=(Paint(colour=colour, brush="round"), Paint(colour=(0.0, 0.0, 0.0), brush="round")),
        strokes=tuple(
            Stroke(id=i, paint=i % 2 if strokes > 9 else 0, trajectory=((0.0, y, 1.0), (0.1, y, 1.0)), style=use)
            for i, y in enumerate(np.linspace(0.01, 0.036, strokes).tolist())
        ),
    )


@pytest.fixture
def plans(tmp_path: Path) -> list[Path]:
    paths = [tmp_path / name / "painting.json" for name in ("few", "many")]
    for path, plan in zip(paths, (a_plan(2), a_plan(12, made=Provenance(version="1", image="a.jpg"))), strict=True):
        path.parent.mkdir()
        write_painting(plan, path)
    return paths


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "160")


def table(out: str) -> dict[str, list[str]]:
    cells = [[c.strip() for c in line.strip("│┃").replace("┃", "│").split("│")] for line in out.splitlines()]
    return {row[0]: row[1:] for row in cells if len(row) > 1}


def test_plans_are_told_in_figures_a_column_each(plans: list[Path]) -> None:
    ran = run("compare", *plans)
    assert (ran.code, ran.stderr) == (0, "")
    told = table(ran.stdout)
    assert told == {
        "": ["few", "many"],
        "sheet": ["100 x 80 mm"] * 2,
        "strokes": ["2", "12"],
        "drawn": ["0.20 m", "1.20 m"],
        "mean stroke": ["100.0 mm"] * 2,
        "paints": ["2", "2"],
        "paint changes": ["0", "11"],
        "sheet covered": told["sheet covered"],
        "style": ["cursive"] * 2,
        "brush": ["round"] * 2,
        "picture": ["-", "a.jpg"],
        "steps": ["90", "-"],
        "seed": ["7", "0"],
        "weights": ["tone 1, edges 0.25", "-"],
        "psnr in its file": ["21.3", "-"],
        "ssim in its file": ["0.5", "-"],
    }
    few, many = (int(share.rstrip("%")) for share in told["sheet covered"])
    assert 15 < few < many < 60
    assert ran.stdout.endswith("comparison.png\n")
    with Image.open("comparison.png") as picture:
        assert picture.height == 1024


def test_likeness_is_measured_over_the_area_of_the_picture(plans: list[Path], tmp_path: Path) -> None:
    """A photograph of the first plan's own area, so that nothing but the grid of pixels lies between them."""
    seen = preview(a_plan(2), Canvas(0.1, 0.08, 6400))[64:448, 64:576]
    (tmp_path / "photo.png").write_bytes(encode_png(seen))
    ran = run("compare", *plans, "--photo", tmp_path / "photo.png", "--px", "300", "--out", "with.png")
    assert (ran.code, ran.stderr) == (0, "")
    few, many = (float(told.split(" dB")[0]) for told in table(ran.stdout)["likeness to the photo"])
    assert few > 50
    assert many < 20
    assert run("compare", *plans, "--px", "300", "--out", "without.png").code == 0
    assert Path("with.png").read_bytes() != Path("without.png").read_bytes()


def test_plans_are_called_by_what_tells_them_apart(plans: list[Path], tmp_path: Path) -> None:
    for name in ("a", "b"):
        shutil.copy(plans[0], tmp_path / f"{name}.json")
    words = ("--px", "240", "--overwrite")
    assert table(run("compare", "a.json", "b.json", *words).stdout)[""] == ["a", "b"]
    assert table(run("compare", *plans, *words).stdout)[""] == ["few", "many"]
    both = ("few/painting.json", "few/copy.json", "many/painting.json")
    shutil.copy(plans[0], both[1])
    assert table(run("compare", *both, *words).stdout)[""] == list(both)


def test_plans_of_nothing_can_be_compared(tmp_path: Path) -> None:
    for name in ("a", "b"):
        write_painting(a_plan(0), tmp_path / f"{name}.json")
    ran = run("compare", "a.json", "b.json", "--px", "240")
    assert (ran.code, ran.stderr) == (0, "")
    assert table(ran.stdout)["sheet covered"] == ["0%", "0%"]


@pytest.mark.parametrize("count", [1, 7])
def test_too_few_and_too_many_are_refused(plans: list[Path], count: int) -> None:
    ran = run("compare", *(plans * 4)[:count])
    assert ran.code == 2
    assert ran.mistake == f"the number of paintings to compare is {count}; it must be from 2 to 6"


def test_the_same_painting_twice_is_refused(plans: list[Path], tmp_path: Path) -> None:
    (tmp_path / "again.json").symlink_to(plans[0])
    ran = run("compare", *plans, "again.json")
    assert (ran.code, ran.mistake) == (2, "again.json is named twice; name each painting once")


def test_what_is_no_painting_is_refused_by_what_it_is(plans: list[Path], tmp_path: Path) -> None:
    write_ink(Ink.of([np.array([[0.0, 0.0, 0.0, 0.5], [1.0, 1.0, 1.0, 0.5]])], (2.0, 2.0)), tmp_path / "a.npz")
    (tmp_path / "text.json").write_text("hello")
    for other, text in {
        BRUSH: f"{BRUSH} holds brush, and paintings are compared; name a painting.json",
        STYLE: f"{STYLE} holds style, and paintings are compared; use maulstick style compare",
        Path("a.npz"): "a.npz holds ink, and paintings are compared; name a painting.json",
        Path("text.json"): "text.json is not a painting: the file: Invalid JSON: expected value at line 1 column 1",
        Path("none.json"): "there is no painting none.json; check its name and folder",
        plans[0].parent: f"{plans[0].parent} is a folder; name {plans[0].parent / 'painting.json'}",
    }.items():
        ran = run("compare", plans[0], other)
        assert ran.code == 2
        assert ran.mistake.startswith(text)
    assert not Path("comparison.png").exists()


def test_a_picture_that_is_there_is_replaced_only_when_told_to(plans: list[Path]) -> None:
    Path("comparison.png").write_bytes(b"before")
    ran = run("compare", *plans, "--px", "240")
    assert (ran.code, ran.mistake) == (1, "comparison.png is already there; choose another --out, or add --overwrite")
    assert Path("comparison.png").read_bytes() == b"before"
    assert run("compare", *plans, "--px", "240", "--overwrite").code == 0
    assert run("compare", *plans, "--px", "239", "--overwrite").mistake == "--px is 239; it must be from 240 to 2400"


def test_a_photo_that_cannot_be_read_is_refused_before_anything_is_drawn(plans: list[Path]) -> None:
    ran = run("compare", *plans, "--photo", "none.jpg")
    assert (ran.code, ran.mistake) == (2, "there is no picture none.jpg; check its name and folder")
    assert not Path("comparison.png").exists()
