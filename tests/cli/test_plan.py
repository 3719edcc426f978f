import os
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from maulstick.painting.brush import built_in_brushes, load_brush, write_brush
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting
from tests.cli.conftest import PORTRAIT, QUICK, RESULTS, Ran, contents, paint, run

SVG = "{http://www.w3.org/2000/svg}"


def planned(out: Path, *words: str | Path, photo: str | Path = PORTRAIT) -> Painting:
    ran = paint(out, *words, photo=photo)
    assert ran.code == 0, ran.stderr
    assert sorted(os.listdir(out)) == RESULTS
    return read_painting(out / "painting.json")


def test_the_files_of_a_painting_agree(painted: tuple[Path, Ran]) -> None:
    out, ran = painted
    assert ran.code == 0
    assert sorted(os.listdir(out)) == RESULTS
    painting = read_painting(out / "painting.json")
    drawing = ElementTree.parse(out / "painting.svg").getroot()
    layers = drawing.findall(f"{SVG}g")
    assert 0 < len(painting.strokes) <= 20
    assert len(drawing.findall(f".//{SVG}path")) == len(painting.strokes)
    assert len(layers) == len(painting.paints) == painting.paint_changes() + 1
    assert (drawing.get("width"), drawing.get("height")) == ("200mm", "160mm")
    with Image.open(out / "preview.png") as preview, Image.open(out / "palette.png") as palette:
        assert preview.size == (1280, 1024)
        colours = {f"#{r:02x}{g:02x}{b:02x}" for r, g, b in np.asarray(palette).reshape(-1, 3)}
    assert {paint.hex for paint in painting.paints} <= colours


def test_the_summary_goes_to_standard_output_and_the_bar_to_standard_error(painted: tuple[Path, Ran]) -> None:
    out, ran = painted
    painting = read_painting(out / "painting.json")
    words = " ".join(ran.stdout.split())
    assert f"│ strokes │ {len(painting.strokes)} │" in words
    assert f"│ paints │ {len(painting.paints)} (changes: {painting.paint_changes()}) │" in words
    assert re.search(r"│ beside the picture │ \d+\.\d dB PSNR, 0\.\d\d SSIM │", words)
    assert f"│ files │ {', '.join(RESULTS)} │" in words
    assert re.search(r"^20 strokes .* 100 % loss 0\.\d{5} 0:00:00$", ran.stderr, re.MULTILINE)
    assert "\x1b" not in ran.stdout + ran.stderr
    assert "20 strokes" not in ran.stdout


def test_a_resolution_too_low_for_the_brush_is_said(painted: tuple[Path, Ran]) -> None:
    assert "note: the thinnest mark of the brush round is 0.10 pixels in half-width" in painted[1].stderr


def test_how_a_painting_was_made_is_written_into_it(painted: tuple[Path, Ran]) -> None:
    made = read_painting(painted[0] / "painting.json").provenance
    assert made.image == "astronaut.png"
    assert made.seed == 0
    assert {k: made.options[k] for k in ("strokes", "paints", "steps", "px", "size", "brush")} == {
        "strokes": 20,
        "paints": 12,
        "steps": 30,
        "px": 48,
        "size": "200x160mm",
        "brush": "round",
    }


def test_files_are_known_in_a_painting_by_their_names_and_not_by_where_they_were(tmp_path: Path) -> None:
    brush = load_brush("round").model_copy(update={"name": "mine"})
    write_brush(brush, tmp_path / "old" / "brush.json")
    (tmp_path / "old" / "paints.csv").write_text("ink,#000000")
    words = ("--brush", tmp_path / "old" / "brush.json", "--paints-from", tmp_path / "old" / "paints.csv")
    options = planned(tmp_path / "out", *words).provenance.options
    assert (options["brush"], options["style"], options["paints_from"]) == ("mine", "free", "paints.csv")
    assert str(tmp_path) not in (tmp_path / "out" / "painting.json").read_text()


def test_the_same_seed_repeats_a_painting_and_another_does_not(painted: tuple[Path, Ran], tmp_path: Path) -> None:
    planned(tmp_path / "same")
    planned(tmp_path / "other", "--seed", "1")
    assert contents(tmp_path / "same") == contents(painted[0])
    assert (tmp_path / "other" / "painting.svg").read_bytes() != (painted[0] / "painting.svg").read_bytes()


def test_the_demo_is_the_portrait_that_comes_along(painted: tuple[Path, Ran], tmp_path: Path) -> None:
    assert run("plan", "--demo", *QUICK, "--out", tmp_path).code == 0
    assert contents(tmp_path) == contents(painted[0])


def test_one_ink_is_one_paint(tmp_path: Path) -> None:
    painting = planned(tmp_path, "--ink", "#0000ff", "--brush", "fineliner")
    assert [paint.hex for paint in painting.paints] == ["#0000ff"]
    assert list(painting.brushes) == ["fineliner"]


def test_fewer_strokes_than_twelve_take_fewer_paints(tmp_path: Path) -> None:
    assert 1 <= len(planned(tmp_path, "--strokes", "5").paints) <= 5


def test_exactly_so_many_strokes_are_planned_when_asked_for(tmp_path: Path) -> None:
    white = tmp_path / "white.png"
    Image.new("RGB", (30, 20), "white").save(white)
    assert len(planned(tmp_path / "exact", "--exact", photo=white).strokes) == 20
    assert len(planned(tmp_path / "most", photo=white).strokes) == 0


def test_a_sheet_and_the_picture_on_it_are_as_asked_for(tmp_path: Path) -> None:
    contained = planned(tmp_path / "contain", "--size", "A5")
    assert (contained.sheet.width, contained.sheet.height) == (0.148, 0.210)
    assert contained.area[2:] == pytest.approx((0.148, 0.148), abs=0.210 / 48)
    assert planned(tmp_path / "cover", "--size", "A5", "--fit", "cover").area == (0, 0, 0.148, 0.210)


def test_a_long_sheet_has_a_preview_of_a_size_that_can_be_opened(tmp_path: Path) -> None:
    planned(tmp_path, "--size", "2000x100mm", "--fit", "cover")
    with Image.open(tmp_path / "preview.png") as preview:
        assert preview.size == (4096, 205)


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The portrait, cut to 60x40, in every kind of file, and pictures of extreme sizes."""
    into = tmp_path_factory.mktemp("pictures")
    with Image.open(PORTRAIT) as opened:
        colour = opened.convert("RGB").resize((60, 40), box=(0, 0, 512, 341))
    grey, turned = colour.convert("L"), Image.Exif()
    turned[274] = 6  # a quarter turn
    colour.save(into / "turned.jpg", exif=turned)
    colour.transpose(Image.Transpose.ROTATE_270).save(into / "portrait.png")
    grey.save(into / "grey.png")
    Image.fromarray(np.asarray(grey).astype(np.uint16) * 257).save(into / "deep.png")
    transparent = colour.copy()
    transparent.putalpha(grey)
    transparent.save(into / "transparent.png")
    colour.resize((1, 1)).save(into / "pixel.png")
    colour.resize((8000, 5000)).save(into / "large.jpg")
    return into


@pytest.mark.parametrize(
    ("name", "aspect"),
    {
        "turned.jpg": 2 / 3,
        "portrait.png": 2 / 3,
        "grey.png": 3 / 2,
        "deep.png": 3 / 2,
        "transparent.png": 3 / 2,
        "pixel.png": 1,
        "large.jpg": 8 / 5,
    }.items(),
)
def test_every_kind_of_picture_is_painted_upright_and_unstretched(
    pictures: Path, tmp_path: Path, name: str, aspect: float
) -> None:
    painting = planned(tmp_path, photo=pictures / name)
    _, _, width, height = painting.area
    assert width / height == pytest.approx(aspect, rel=0.05)
    assert painting.strokes


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ([], "name one picture to paint, --demo for the portrait that comes along, or a --text"),
        (["--demo", PORTRAIT], "name one picture to paint, or --demo for the portrait that comes along"),
        (["none.jpg"], f"there is no picture {Path('none.jpg').absolute()}; check its name and folder"),
        ([os.curdir], f"{Path.cwd()} is a folder; name the picture itself"),
        (["/dev/null"], "/dev/null is a device or a pipe; a picture must be a file"),
        ([__file__], f"{__file__} is not a picture that can be read; save it as one of JPEG, PNG, TIFF, WEBP, GIF"),
        (["--demo", "--size", "large"], "'large' is not a size; write width x height and a unit, as in 200x160mm"),
        (["--demo", "--size", "200x160"], "'200x160' is not a size; write width x height and a unit"),
        (["--demo", "--size", "0x160mm"], "a side of the canvas is 0 mm; it must be between 5 mm and 100 m"),
        (["--demo", "--size", "5x90000mm"], "the sheet in pixels is"),
        ([PORTRAIT, "--size", "90x1mm"], "a side of the canvas is 1 mm; it must be between 5 mm and 100 m"),
        (["--demo", "--fit", "stretch"], "there is no fit 'stretch'; there are: contain, cover"),
        (
            ["--demo", "--brush", "broom"],
            "there is no brush 'broom'; there are: FILE.json, fineliner, ",
        ),
        (["--demo", "--brush", "none.json"], f"there is no brush {Path('none.json').absolute()}"),
        (["--demo", "--style", "rococo"], "there is no style 'rococo'; there are: FILE.json, "),
        (["--demo", "--ink", "octarine"], "'octarine' is not a colour; write a name such as black, or #rrggbb"),
        (
            ["--demo", "--ink", "red", "--paints", "2"],
            "--paints and --ink are two ways to say what to paint with; leave one",
        ),
        (["--demo", "--video", "avi"], "there is no video format 'avi'; there are: gif, mp4"),
        (["--demo", "--strokes", "0"], "--strokes is 0; it must be from 1 to 100000"),
        (["--demo", "--strokes", "-3"], "--strokes is -3; it must be from 1 to 100000"),
        (["--demo", "--strokes", "1000000"], "--strokes is 1000000; it must be from 1 to 100000"),
        (["--demo", "--paints", "0"], "--paints is 0; it must be from 1 to the 400 strokes"),
        (["--demo", "--strokes", "5", "--paints", "6"], "--paints is 6; it must be from 1 to the 5 strokes"),
        (["--demo", "--strokes", "auto", "--paints", "-3"], "--paints is -3; it must be from 1 to the 10,000 strokes"),
        (["--demo", "--steps", "0"], "--steps is 0; it must be from 1 to 1000000"),
        (["--demo", "--px", "-1"], "--px is -1; it must be from 16 to 32768"),
        (["--demo", "--px", "50000"], "--px is 50000; it must be from 16 to 32768"),
        (["--demo", "--seed", "-1"], "--seed is -1; it must be from 0 to 4294967295"),
    ],
)
def test_what_cannot_be_used_is_one_line_and_makes_no_folder(tmp_path: Path, words: list[str], text: str) -> None:
    out = tmp_path / "out"
    ran = run("plan", *words, "--out", out)
    assert ran.code == 2
    assert ran.mistake.startswith(text)
    assert not out.exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--strokes", "many"], "invalid value for '--strokes': 'many' is neither"),
        (["--strokes", "1.5"], "invalid value for '--strokes': '1.5' is neither"),
        (["--strokes"], "option '--strokes' requires an argument"),
        (["--colour"], "no such option: --colour"),
        (["more.jpg", "most.jpg"], "got unexpected extra argument"),
    ],
)
def test_what_the_command_line_cannot_read_is_one_line(tmp_path: Path, words: list[str], said: str) -> None:
    ran = run("plan", "--out", tmp_path / "out", *words)
    assert ran.code == 2
    assert ran.mistake.startswith(said)
    assert ran.mistake.endswith("; see maulstick plan --help")
    assert "Possible" not in ran.mistake
    assert os.listdir(tmp_path) == []


def test_a_truncated_picture_is_refused(tmp_path: Path) -> None:
    half = tmp_path / "half.png"
    half.write_bytes(Path(PORTRAIT).read_bytes()[:100_000])
    ran = paint(tmp_path / "out", photo=half)
    assert ran.code == 2
    assert ran.mistake == f"cannot read the picture {half}: image file is truncated; save or copy it again"
    assert os.listdir(tmp_path) == ["half.png"]


def test_all_built_in_brushes_are_named_in_the_help() -> None:
    text = run("plan", "--help").stdout
    assert all(name in text for name in built_in_brushes())
