import json
import os
import shutil
from pathlib import Path

import pytest
from PIL import Image

from maulstick.rendering import preview
from tests.cli.conftest import Ran, run


@pytest.fixture
def painting(painted: tuple[Path, Ran], tmp_path: Path) -> Path:
    """A painting alone in a folder of its own."""
    folder = tmp_path / "alone"
    folder.mkdir()
    return Path(shutil.copy(painted[0] / "painting.json", folder))


def test_an_image_is_as_high_as_asked_for_and_as_wide_as_the_sheet(painting: Path) -> None:
    ran = run("render", painting, "--px", "80")
    image = painting.with_name("painting-80px.png")
    assert ran == (0, f"{image}\n", "")
    with Image.open(image) as opened:
        assert opened.size == (100, 80)


def test_the_preview_is_the_rendering_at_1024_pixels(painted: tuple[Path, Ran], tmp_path: Path) -> None:
    out = tmp_path / "again.png"
    assert run("render", painted[0] / "painting.json", "--out", out).code == 0
    assert out.read_bytes() == (painted[0] / "preview.png").read_bytes()


def test_an_image_that_is_there_is_replaced_only_when_told_to(painting: Path) -> None:
    image = painting.with_name("image.png")
    image.write_bytes(b"before")
    ran = run("render", painting, "--px", "40", "--out", image)
    assert ran.code == 1
    assert ran.mistake == f"{image} is already there; choose another --out, or add --overwrite"
    assert image.read_bytes() == b"before"
    assert run("render", painting, "--px", "40", "--out", image, "--overwrite").code == 0
    with Image.open(image) as opened:
        assert opened.size == (50, 40)


@pytest.mark.parametrize("px", ["0", "-1", "8193", "7000", "9" * 400])
def test_a_height_without_sense_is_refused(painting: Path, px: str) -> None:
    ran = run("render", painting, "--px", px)
    assert ran.code == 2
    assert ran.mistake == f"--px is {px}; it must be at least 1, with no side of the image above 8192"
    assert os.listdir(painting.parent) == ["painting.json"]


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"schema_version": 3}, "schema_version: it is 3, and this Maulstick reads versions 1 to 2; update Maulstick"),
        ({"strokes": [{"id": -1}]}, "strokes[0].id: Input should be greater than or equal to 0 (got -1)"),
        ({"paints": []}, "strokes[0].paint: it is 0; it must be an index into the 0 paints, from 0"),
    ],
)
def test_a_painting_with_a_fault_is_refused_by_the_name_of_the_field(
    painting: Path, change: dict[str, object], text: str
) -> None:
    painting.write_text(json.dumps({**json.loads(painting.read_text()), **change}))
    ran = run("render", painting)
    assert ran.code == 2
    assert ran.mistake == f"{painting} is not a painting: {text}"


def test_a_file_that_is_no_painting_is_refused(painting: Path) -> None:
    painting.write_bytes(painting.read_bytes()[:1000])
    assert "is not a painting: the file: Invalid JSON" in run("render", painting).mistake
    assert run("render", painting.parent).mistake == f"{painting.parent} is a folder; name {painting}"
    missing = painting.with_name("none.json")
    assert run("render", missing).mistake == f"there is no painting {missing}; check its name and folder"


@pytest.mark.parametrize("command", ["render", "show", "export"])
def test_the_folder_itself_is_refused_by_every_name_of_it(
    painting: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.chdir(painting.parent)
    for name in (".", "/", "..", ""):
        assert " is a folder; name " in run(command, name).mistake


def test_an_image_goes_into_a_file_that_ends_in_png(painting: Path) -> None:
    image = painting.with_name("image.jpg")
    ran = run("render", painting, "--out", image)
    assert ran.code == 2
    assert ran.mistake == f"--out is {image}; an image is written as PNG, so let its name end in .png"


def test_a_folder_that_is_not_there_is_not_made_and_nothing_is_drawn_for_it(
    painting: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(preview, "preview", None)  # to call it would be a traceback
    image = painting.parent / "none" / "image.png"
    ran = run("render", painting, "--px", "40", "--out", image)
    assert ran.code == 1
    assert ran.mistake == f"cannot write {image}: its folder does not exist; make the folder first"


def test_ctrl_c_while_rendering_leaves_nothing(painting: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(preview, "preview", interrupt)
    assert run("render", painting) == (130, "", "")
    assert os.listdir(painting.parent) == ["painting.json"]


def test_a_painting_without_strokes_is_its_paper(painting: Path) -> None:
    fields = {**json.loads(painting.read_text()), "strokes": []}
    painting.write_text(json.dumps(fields))
    assert run("render", painting, "--px", "40").code == 0
    with Image.open(painting.with_name("painting-40px.png")) as opened:
        assert opened.getextrema() == ((255, 255),) * 3
