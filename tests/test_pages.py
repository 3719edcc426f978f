"""The shorter pages: what they tell to type does what they say; plans with few strokes and steps."""

import re
import shutil
from pathlib import Path

import pytest
import skimage
from PIL import Image

import maulstick as ms
from tests.support.pages import DOCS, blocks, lines, python, typed

TINY = ("--strokes", "24", "--steps", "3", "--px", "48")

pytestmark = pytest.mark.filterwarnings("ignore:libmypaint is not installed")


def test_a_first_painting_is_planned_changed_compared_and_painted(tmp_path: Path) -> None:
    for line in lines(DOCS / "start.md"):
        ran = typed(line, tmp_path, *TINY * line.startswith("maulstick plan "))
        assert ran.code == 0, f"{line}: {ran.stderr}"
    assert (tmp_path / "comparison.png").is_file()
    assert (tmp_path / "portrait" / "painting-painted.png").is_file()


def test_strokes_from_a_web_page_are_read_as_the_page_says(tmp_path: Path) -> None:
    page = DOCS / "pointer-events.md"
    (example,), (line,) = blocks(page, "json"), lines(page)
    (tmp_path / "drawing.json").write_text(example, encoding="utf-8")
    assert typed(line, tmp_path).code == 0
    assert len(ms.read_ink(tmp_path / "cat.ink.npz")) == 2


def test_a_survey_is_built_its_links_are_made_and_its_results_shown(tmp_path: Path) -> None:
    page = DOCS / "survey.md"
    (code,) = blocks(page, "python")
    for name in re.findall(r"[\w-]+\.(?:jpg|png)", code):
        Image.new("RGB", (40, 30), "white").save(tmp_path / name)
    python(["-c", code], tmp_path)
    links, results = (typed(line, tmp_path) for line in lines(page))
    assert len(links.stdout.splitlines()) == 20
    assert results.code == 0, results.stderr
    assert (tmp_path / "my-survey" / "answers.csv").is_file()


def test_a_sweep_plans_the_cells_of_its_grid(tmp_path: Path) -> None:
    page = DOCS / "sweep.md"
    skimage.io.imsave(tmp_path / "cat.jpg", skimage.data.chelsea())
    shutil.copy(tmp_path / "cat.jpg", tmp_path / "dog.jpg")
    grid, (line,) = blocks(page, "toml")[0], lines(page)
    for long, short in {'"cat.jpg", "dog.jpg"': '"dog.jpg"', "200, 800": "12", '"loops", ': "", "0, 1, 2": "0"}.items():
        assert long in grid
        grid = grid.replace(long, short)
    (tmp_path / "grid.toml").write_text(f"{grid}steps = 3\npx = 40\n", encoding="utf-8")
    ran = typed(line, tmp_path)
    assert ran.code == 0, ran.stderr
    assert len((tmp_path / "wall" / "sweep.csv").read_text().splitlines()) == 3
