"""The sheet, its margins and the picture's corrections, as they are typed."""

from pathlib import Path

import pytest

from maulstick.painting.edit import PictureEdit
from maulstick.painting.painting_file import read_painting
from tests.cli.conftest import PORTRAIT, QUICK, contents, paint, run
from tests.cli.test_plan_resume import killed

CORRECTED = (
    *("--size", "A5-auto", "--fit", "cover", "--margin", "1.5cm", "--brush", "marker"),
    *("--rotate", "90", "--straighten", "-2", "--crop", "0,0,1,0.5", "--exposure", "-0.5", "--contrast", "1.2"),
)


def test_a_plan_of_a_corrected_picture_that_was_killed_goes_on_to_the_same_painting(tmp_path: Path) -> None:
    whole, cut = tmp_path / "whole", tmp_path / "cut"
    ran = paint(whole, *CORRECTED)
    assert ran.code == 0, ran.stderr
    painting = read_painting(whole / "painting.json")
    assert (painting.sheet.width, painting.sheet.height) == (0.21, 0.148)  # the half that is kept lies
    assert painting.area == (0.015, 0.015, 0.18, 0.118)
    assert PictureEdit.of(painting.provenance.options) == PictureEdit(
        rotate=90, straighten=-2, crop=(0, 0, 1, 0.5), exposure=-0.5, contrast=1.2
    )
    killed(12, "plan", PORTRAIT, *QUICK, "--out", cut, *CORRECTED)
    assert run("plan", "--resume", cut).code == 0
    assert contents(cut) == contents(whole)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--crop", "0,0,1"], "--crop is '0,0,1'; it must be four shares of the picture, as in 0.1,0,0.9,1"),
        (["--crop", "0.6,0,0.4,1"], "--crop is 0.6,0.0,0.4,1.0; it must be the left, top, right and lower edge"),
        (["--rotate", "45"], "--rotate is 45; it must be 0, 90, 180 or 270"),
        (["--straighten", "20"], "--straighten is 20.0; it must be from -15 to 15"),
        (["--margin", "20mm", "--size", "200x45mm"], "--margin leaves "),
        (["--margin", "21", "--size", "200x45mm"], "--margin is 21mm; it must be at most 20mm on a sheet of 200 x"),
        (["--margin", "21mm", "--size", "200x45mm"], "--margin is 21mm; it must be at most 20mm on a sheet of 200 x"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_written(tmp_path: Path, words: list[str], said: str) -> None:
    ran = run("plan", PORTRAIT, *words, "--out", tmp_path / "out")
    assert ran.code == 2
    assert ran.mistake.startswith(said)
    assert not (tmp_path / "out").exists()
