import json
import os
from pathlib import Path

import numpy as np
import pytest

from maulstick.painting.painting import Sheet
from maulstick.painting.painting_file import write_painting
from maulstick.painting.picture import encode_png
from maulstick.robot.easel import write_easel
from maulstick.robot.journal import journal_of
from tests.cli.conftest import contents, run
from tests.cli.paint.conftest import ALL, MESSAGE, answers, correlation, painted, picture_of
from tests.support.robot.recorder import EASEL, LIMITS, Recorder
from tests.support.robot.small_paintings import line, painting_of
from tests.support.robot.trays import TRAY_JSON
from tests.support.tolerances import PAINTED_CORRELATION, SAME_SHEET


def test_a_dry_run_says_how_long_it_takes_and_neither_moves_nor_writes(painting: Path, recorder: Recorder) -> None:
    before = contents(painting.parent)
    for machine in ("sim", "sim:real", "grbl:/dev/ttyUSB0"):
        ran = run("paint", painting, "--dry-run", "--robot", machine)
        assert (ran.code, ran.stdout) == (0, "")
        assert ran.stderr.strip() == MESSAGE
    assert recorder.said == ["close"], "it was asked for its limits, and no more"
    assert contents(painting.parent) == before


def test_a_dry_run_refuses_what_a_run_would(painting: Path) -> None:
    narrow = LIMITS.model_copy(update={"upper": (0.01, 0.1, 0.1)})
    write_easel(EASEL.model_copy(update={"limits": narrow}), painting.with_name("easel.json"))
    ran = run("paint", painting, "--dry-run", "--easel", painting.with_name("easel.json"))
    assert ran.code == 2
    assert "less far" in ran.mistake


def test_it_paints_every_stroke_once_and_shows_the_sheet(painting: Path) -> None:
    ran = run("paint", painting)
    assert ran.code == 0, ran.stderr
    assert ran.stdout == f"{painting.with_name('painting-painted.png')}\n"
    assert MESSAGE in ran.stderr
    assert sorted(painted(painting)) == ALL
    seen = [name for name in sorted(os.listdir(painting.parent)) if not name.startswith(".")]
    assert seen == ["painting-painted.png", "painting.json", "painting.log.jsonl"]


def test_a_painting_that_is_replaced_while_the_machine_connects_is_not_taken_for_the_one_that_was_begun(
    painting: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def connect(spec: str, easel: object) -> Recorder:
        write_painting(painting_of([line(99)]), painting)
        return Recorder()

    monkeypatch.setattr("maulstick.jobs.paint.setup.machine", connect)
    answers(monkeypatch, "\n\n\n")
    assert run("paint", painting, "--robot", "grbl:/dev/ttyUSB0").code == 0
    assert sorted(painted(painting)) == ALL
    assert "is not the file that" in run("paint", painting, "--resume").mistake


def test_what_is_painted_is_like_the_preview(calibrated: Path) -> None:
    assert run("paint", calibrated).code == 0
    assert correlation(calibrated) > PAINTED_CORRELATION


def test_a_simulated_sheet_has_the_colour_of_the_paper_and_what_is_painted_on_it_already(tmp_path: Path) -> None:
    plan, path = painting_of([line(1, pressure=(1, 1))]), tmp_path / "dark.json"
    dark = Sheet(width=plan.sheet.width, height=plan.sheet.height, paper=(0.2, 0.2, 0.2))
    write_painting(plan.model_copy(update={"sheet": dark}), path)
    assert run("paint", path).code == 0
    image = picture_of(tmp_path / "dark-painted.png")
    assert image[0, 0] == pytest.approx([0.2] * 3, abs=1 / 255)
    assert image[..., 0].max() > 0.5, "the stroke is red"
    used = dark.model_copy(update={"picture": encode_png(np.flipud(image))})
    write_painting(plan.model_copy(update={"sheet": used}), path)
    assert run("paint", path, "--restart").code == 0
    red, before = picture_of(tmp_path / "dark-painted.png")[..., 0], image[..., 0]
    assert red == pytest.approx(np.maximum(before, np.flipud(before)), abs=1 / 255)


def test_a_painting_of_one_paint_has_its_colour(tmp_path: Path) -> None:
    path = tmp_path / "red.json"
    write_painting(painting_of([line(1, pressure=(1, 1))]), path)
    assert run("paint", path).code == 0
    image = picture_of(tmp_path / "red-painted.png")
    darkest = image.reshape(-1, 3)[image.sum(axis=2).argmin()]
    assert darkest[0] > darkest[1] + 0.3


def test_a_brush_is_dipped_into_its_wells(calibrated: Path) -> None:
    (calibrated.parent / "tray.json").write_text(json.dumps(TRAY_JSON))
    ran = run("paint", calibrated, "--tray", calibrated.with_name("tray.json"))
    assert ran.code == 0, ran.stderr
    assert correlation(calibrated) > PAINTED_CORRELATION


def test_the_simulated_sheet_lies_where_the_easel_says(painting: Path) -> None:
    assert run("paint", painting).code == 0
    usual = picture_of(painting.with_name("painting-painted.png"))
    easel = EASEL.model_copy(
        update={"corner": (0.1, 0.05, 0.01), "right": (0.0, 1.0, 0.0), "down": (1.0, 0.0, 0.0), "deepest": 2e-3}
    )
    write_easel(easel, painting.with_name("easel.json"))
    assert run("paint", painting, "--restart", "--easel", painting.with_name("easel.json")).code == 0
    assert np.abs(picture_of(painting.with_name("painting-painted.png")) - usual).mean() < SAME_SHEET


def test_the_easel_may_narrow_the_limits_of_the_simulator(painting: Path) -> None:
    narrow = LIMITS.model_copy(update={"upper": (0.02, 0.1, 0.1)})
    write_easel(EASEL.model_copy(update={"limits": narrow}), painting.with_name("easel.json"))
    ran = run("paint", painting, "--easel", painting.with_name("easel.json"))
    assert ran.code == 2
    assert "the machine's x is" in ran.mistake
    assert ran.mistake.endswith("or turn or scale an SVG with --rotate or --size")
    assert not journal_of(painting).exists()
