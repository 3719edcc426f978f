"""The gallery: every picture is there, and its commands run; plans with few strokes and steps."""

import re
import shutil
from pathlib import Path

import pytest
from PIL import Image

from tests.support.pages import DOCS, ROOT, blocks, lines, typed

PAGE, FILES = DOCS / "gallery.md", DOCS / "gallery"
SECTIONS = PAGE.read_text(encoding="utf-8").split("\n## ")[1:]
TINY = ("--strokes", "24", "--steps", "3", "--px", "64")
WIDEST, HEAVIEST = 900, 3_000_000  # pixels of a picture, and bytes of all


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder as the page's beginning says."""
    folder = tmp_path_factory.mktemp("gallery")
    for path in FILES.iterdir():
        if path.suffix != ".jpg":
            shutil.copy(path, folder)
    assert typed(lines(PAGE)[0], folder).code == 0
    return folder


@pytest.mark.parametrize("section", SECTIONS, ids=lambda text: text.partition("\n")[0])
def test_each_picture_has_commands_that_run_and_make_it(section: str, folder: Path) -> None:
    (name,) = re.findall(r"!\[[^\]]+\]\(gallery/(\w+)\.jpg\)", section)
    (block,) = re.findall(r"```sh\n(.*?)```", section, re.DOTALL)
    for line in block.splitlines():
        ran = typed(line, folder, *TINY * line.startswith("maulstick plan "))
        assert ran.code == 0, ran.stderr
    assert f" --out {name}" in block
    assert (folder / f"{name}.png").is_file() or (folder / name / "preview.png").is_file()


def test_the_page_has_eight_to_twelve_pictures_that_are_there_and_small() -> None:
    shown = re.findall(r"\]\(gallery/(\w+\.jpg)\)", PAGE.read_text(encoding="utf-8"))
    assert 8 <= len(shown) <= 12
    assert sorted(shown) == sorted(path.name for path in FILES.glob("*.jpg"))
    assert sum(path.stat().st_size for path in FILES.glob("*.jpg")) < HEAVIEST
    for name in shown:
        with Image.open(FILES / name) as image:
            assert image.width <= WIDEST


def test_make_gallery_runs_what_the_page_says() -> None:
    assert "$(BIN)/python experiments/gallery.py" in (ROOT / "Makefile").read_text(encoding="utf-8")
    assert len(blocks(PAGE, "sh")) == len(SECTIONS) + 1
