"""Plans for a machine: what only lifts its pen can draw each of them."""

from pathlib import Path

import pytest

from maulstick.painting.brush import load_brush
from maulstick.painting.painting_file import read_painting
from maulstick.robot.easel import Easel, Pen, write_easel
from tests.cli.conftest import paint, run
from tests.support.robot.fake_ebb import FakeEbb
from tests.support.robot.fake_grbl import FakeGrbl

SMALL = ("--size", "40x40mm", "--ink", "black")


@pytest.mark.parametrize("brush", ["marker", "micron-01"])
def test_a_plan_for_a_plotter_is_drawn_by_all_of_them_with_any_brush(tmp_path: Path, brush: str) -> None:
    ran = paint(tmp_path, *SMALL, "--brush", brush, "--robot", "axidraw")
    assert ran.code == 0
    varies = load_brush(brush).pressure_matters
    assert ("this machine only lifts its pen" in ran.stderr) == varies
    plan = tmp_path / "painting.json"
    painting = read_painting(plan)
    assert painting.brushes == {brush: load_brush(brush).held_at(0.5) if varies else load_brush(brush)}
    assert painting.provenance.options["robot"] == "axidraw"
    with FakeEbb(pace=1000.0) as board:
        assert run("paint", plan, "--robot", f"axidraw:{board.port}").code == 0
    write_easel(
        Easel(corner=(0, 0.04, 0), right=(1, 0, 0), down=(0, -1, 0), pen=Pen(up=200, down=700, seconds=0.01)),
        tmp_path / "easel.json",
    )
    with FakeGrbl(pace=1000.0) as plotter:
        words = ("--robot", f"grbl:{plotter.port}", "--easel", tmp_path / "easel.json", "--restart")
        assert run("paint", plan, *words).code == 0
    assert run("export", plan, "--format", "hpgl").code == 0


def test_a_note_says_how_a_brush_is_held_and_a_pressure_that_is_given_counts(tmp_path: Path) -> None:
    held = paint(tmp_path / "held", *SMALL, "--brush", "marker", "--robot", "grbl:/dev/ttyUSB0")
    assert (
        "note: this machine only lifts its pen, so the brush marker is held at one pressure, 0.5, "
        "and draws lines of 2.4 mm\n"
    ) in held.stderr
    given = paint(tmp_path / "given", *SMALL, "--brush", "marker", "--robot", "hpgl", "--pressure", "0.2")
    assert "only lifts its pen" not in given.stderr
    (brush,) = read_painting(tmp_path / "given" / "painting.json").brushes.values()
    assert brush == load_brush("marker").held_at(0.2)


def test_a_plan_for_an_arm_varies_its_pressure(tmp_path: Path) -> None:
    ran = paint(tmp_path, *SMALL, "--brush", "marker", "--robot", "xarm:192.0.2.1")
    assert "only lifts its pen" not in ran.stderr
    assert read_painting(tmp_path / "painting.json").brushes == {"marker": load_brush("marker")}


def test_a_machine_that_there_is_not_is_refused_before_anything_is_read(tmp_path: Path) -> None:
    ran = run("plan", tmp_path / "no.jpg", "--robot", "axydraw", "--out", tmp_path / "out")
    known = "axidraw, franka, grbl, hpgl, lite6, sim, ur, xarm"
    assert (ran.code, ran.mistake) == (2, f"there is no machine 'axydraw'; there are: {known}")
