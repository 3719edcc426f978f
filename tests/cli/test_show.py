import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from maulstick.cli import show as word
from maulstick.strokes.ink import Ink, write_ink
from maulstick.strokes.strokes import Strokes, write_strokes
from tests.cli.conftest import Ran, run

STROKE = np.array([[0.0, 0.01, 0.02, 0.2], [0.5, 0.05, 0.04, 0.6], [1.0, 0.09, 0.01, 1.0]])
INK = Ink.of([STROKE, STROKE[:1]], (0.1, 0.05))
BRUSH = Path(word.__file__).parents[1] / "painting" / "built_in_brushes" / "marker.json"
STYLE = Path(word.__file__).parents[1] / "style" / "built_in" / "hatching.json"


@pytest.fixture
def ink(tmp_path: Path) -> Path:
    write_ink(INK, tmp_path / "cat.ink.npz")
    return tmp_path / "cat.ink.npz"


@pytest.fixture(params=["ink", "strokes", "style", "brush", "painting"])
def file(request: pytest.FixtureRequest, tmp_path: Path, painted: tuple[Path, Ran]) -> Path:
    """One file of each kind that has a picture."""
    path = tmp_path / {"ink": "a.ink.npz", "strokes": "a.strokes.npz"}.get(request.param, f"{request.param}.json")
    if request.param == "ink":
        write_ink(INK, path)
    elif request.param == "strokes":
        write_strokes(Strokes.of(INK), path)
    else:
        written = {"style": STYLE, "brush": BRUSH, "painting": painted[0] / "painting.json"}[request.param]
        shutil.copy(written, path)
        if request.param == "style":
            shutil.copy(STYLE.with_suffix(".safetensors"), path.with_suffix(".safetensors"))
    return path


def test_whatever_maulstick_wrote_has_a_picture_beside_it(file: Path) -> None:
    ran = run("show", file, "--px", "300")
    picture = file.with_name(f"{file.stem}-300px.png")
    assert ran == (0, f"{picture}\n", "")
    with Image.open(picture) as opened:
        assert opened.height == 300
        assert len(opened.convert("L").getcolors() or []) > 2


def test_a_painting_is_shown_as_it_is_rendered(painted: tuple[Path, Ran], tmp_path: Path) -> None:
    assert run("show", painted[0] / "painting.json", "--out", tmp_path / "a.png").code == 0
    assert (tmp_path / "a.png").read_bytes() == (painted[0] / "preview.png").read_bytes()


def test_a_style_is_shown_as_it_is_by_its_name(tmp_path: Path) -> None:
    assert run("show", STYLE, "--px", "240", "--out", tmp_path / "file.png").code == 0
    assert run("style", "show", STYLE, "--px", "240", "--out", tmp_path / "style.png").code == 0
    pictures = [Image.open(tmp_path / name).convert("L") for name in ("file.png", "style.png")]
    strokes = [np.array(picture)[:180] for picture in pictures]  # below stands what it is called
    assert np.array_equal(*strokes)


def test_a_style_without_its_arrays_is_refused(tmp_path: Path) -> None:
    shutil.copy(STYLE, tmp_path / "a.json")
    ran = run("show", tmp_path / "a.json")
    assert ran.code == 2
    assert ran.mistake == f"{tmp_path / 'a.json'} has no a.safetensors beside it; copy both"


def test_a_picture_that_is_there_is_replaced_only_when_told_to(ink: Path) -> None:
    picture = ink.with_name("cat.png")
    picture.write_bytes(b"before")
    ran = run("show", ink, "--out", picture)
    assert ran.code == 1
    assert ran.mistake == f"{picture} is already there; choose another --out, or add --overwrite"
    assert picture.read_bytes() == b"before"
    assert run("show", ink, "--out", picture, "--overwrite", "--px", "240").code == 0
    with Image.open(picture) as opened:
        assert opened.height == 240


@pytest.mark.parametrize("px", ["0", "239", "2401"])
def test_a_height_without_sense_is_refused(ink: Path, px: str) -> None:
    ran = run("show", ink, "--px", px)
    assert ran.code == 2
    assert ran.mistake == f"--px is {px}; it must be from 240 to 2400"


def test_a_picture_goes_into_a_file_that_ends_in_png(ink: Path) -> None:
    ran = run("show", ink, "--out", ink.with_name("cat.jpg"))
    assert (
        ran.mistake == f"--out is {ink.with_name('cat.jpg')}; a picture is written as PNG, so let its name end in .png"
    )


@pytest.mark.parametrize(("name", "content"), [("a.inkml", "<ink/>"), ("a.json", '{"strokes": []}'), ("a.npz", "PK")])
def test_what_cannot_be_shown_is_refused_with_the_remedy(tmp_path: Path, name: str, content: str) -> None:
    path = tmp_path / name
    path.write_text(content)
    ran = run("show", path)
    assert ran.code == 2
    assert ran.mistake == (
        f"{path} is none of what can be shown: brush, ink, painting, strokes, style, svg; "
        "where it is another program's drawing, make ink of it with maulstick record ink"
    )


def test_a_file_with_a_fault_is_refused_by_what_it_is(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    for content, text in (
        ('{"alpha": -1}', f"{path} is not a brush: name: Field required"),
        ('{"paints": ', f"{path} is not a painting: the file: Invalid JSON"),
        ('{"sha256": ""}', f"{path} is not a style: name: Field required"),
    ):
        path.write_text(content)
        assert run("show", path).mistake.startswith(text)
    missing = tmp_path / "none.npz"
    assert run("show", missing).mistake == f"there is no file {missing}; check its name and folder"


def test_a_folder_that_is_not_there_is_not_made_and_nothing_is_read_for_it(ink: Path) -> None:
    ink.write_bytes(b"")
    picture = ink.parent / "none" / "cat.png"
    ran = run("show", ink, "--out", picture)
    assert ran.code == 1
    assert ran.mistake == f"cannot write {picture}: its folder does not exist; make the folder first"


def test_a_painting_too_wide_for_a_picture_is_refused(painted: tuple[Path, Ran], tmp_path: Path) -> None:
    fields = json.loads((painted[0] / "painting.json").read_text())
    fields["sheet"]["width"] = 50 * fields["sheet"]["height"]
    (tmp_path / "painting.json").write_text(json.dumps(fields))
    ran = run("show", tmp_path / "painting.json", "--px", "240")
    assert ran.code == 2
    assert ran.mistake == "--px is 240; it must be at least 1, with no side of the image above 8192"
    assert run("render", tmp_path / "painting.json", "--px", "240").mistake == ran.mistake
