from pathlib import Path

import pytest

from maulstick.painting.brush import load_brush, write_brush
from maulstick.painting.painting_file import read_painting
from tests.cli.conftest import QUICK, paint, run


def test_a_brush_that_is_held_paints_for_a_plotter(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert paint(out, "--brush", "marker", "--pressure", "0.5").code == 0
    painting = read_painting(out / "painting.json")
    (brush,) = painting.brushes.values()
    assert brush == load_brush("marker").held_at(0.5)
    assert painting.provenance.options["pressure"] == 0.5
    assert {pressure for stroke in painting.strokes for _, _, pressure in stroke.trajectory} == {0.0}
    assert run("export", out / "painting.json", "--format", "hpgl").code == 0


def test_what_a_plotter_cannot_draw_it_can_with_the_words_that_it_is_told(tmp_path: Path) -> None:
    assert paint(tmp_path / "varied").code == 0
    refused = run("export", tmp_path / "varied" / "painting.json", "--servo", "30,90")
    assert refused.code == 2
    assert refused.mistake.endswith("plan it again with maulstick plan --pressure 0.5")
    assert paint(tmp_path / "even", *refused.mistake.split()[-2:]).code == 0
    assert run("export", tmp_path / "even" / "painting.json", "--servo", "30,90").code == 0


@pytest.mark.parametrize("pressure", ["-0.1", "1.5", "nan"])
def test_a_pressure_is_from_0_to_1(tmp_path: Path, pressure: str) -> None:
    ran = run("plan", "--demo", *QUICK, f"--pressure={pressure}", "--out", tmp_path / "out")
    assert (ran.code, ran.mistake) == (
        2, f"--pressure is {float(pressure)}; it must be from 0, just touching, to 1, as deep as the brush goes",
    )  # fmt: skip
    assert not (tmp_path / "out").exists()


def test_a_pressure_that_leaves_no_mark_is_one_sentence(tmp_path: Path) -> None:
    brush = load_brush("marker").model_copy(update={"name": "dry", "beta": -0.0005})
    write_brush(brush, tmp_path / "dry.json")
    ran = paint(tmp_path / "out", "--brush", tmp_path / "dry.json", "--pressure", "0.1")
    assert (ran.code, ran.mistake) == (2, "the brush dry leaves no mark at pressure 0.1; hold it deeper")
