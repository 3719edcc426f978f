"""``maulstick paint`` of SVGs: at a terminal, with a Grbl on a pseudo-terminal, killed in the middle, and resumed."""

import json
import signal
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from maulstick.cli.drawing import drawing_options
from maulstick.robot.journal import journal_of
from tests.cli.conftest import Ran, run
from tests.cli.paint.conftest import answers, events, painted, picture_of
from tests.cli.paint.test_terminal import Begun, Terminal, begin, begun, said_of, said_of_running, wait_for_stroke
from tests.support.robot.fake_ebb import FakeEbb
from tests.support.robot.fake_grbl import FakeGrbl

__all__ = ["begin"]  # a fixture

SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">{}</svg>'
BARS = [(5.0 * x, 5.0, 5.0 * x, 35.0) for x in range(1, 11)]
DOWN = 1e-6  # millimetres above the paper that count as on it
STEPS_PER_MM = 80  # of an AxiDraw


@pytest.fixture
def drawing(tmp_path: Path) -> Path:
    """Ten bars of 30 mm, in no quick order."""
    file = tmp_path / "drawing.svg"
    paths = [f'<path d="M{x0} {y0}L{x1} {y1}"/>' for x0, y0, x1, y1 in BARS]
    file.write_text(SVG.format("".join(paths[::2] + paths[1::2])))
    return file


@pytest.fixture
def grbl() -> Iterator[FakeGrbl]:
    with FakeGrbl(pace=2.0) as device:
        yield device


def touched(device: FakeGrbl) -> list[tuple[float, float]]:
    """Places on the sheet where the pen stood on the paper, x and y down in whole millimetres, in order."""
    found: list[tuple[float, float]] = []
    for x, y, z, _ in device.reached:
        place = (round(x), round(40 - y))
        if z <= DOWN and (not found or found[-1] != place):
            found.append(place)
    return found


def test_a_drawing_that_is_killed_in_the_middle_goes_on_and_every_path_is_drawn_once(
    drawing: Path, grbl: FakeGrbl, begin: Begun
) -> None:
    machine = ("--robot", f"grbl:{grbl.port}", "--speed", "20")
    terminal: Terminal = begin(drawing, *machine)
    wait_for_stroke(drawing, terminal, count=4)
    terminal.send(signal.SIGKILL)
    assert terminal.leave() == -9
    first, unfinished = said_of(drawing)
    assert 3 <= len(first) < 10
    again = begin(drawing, "--resume")
    if said_of_running(drawing)[1]:
        again.wait_for("was under the brush when the run ended")
        again.press("n\n")
    again.wait_for("see that the pen stands")
    again.press("\n")
    assert again.leave() == 0, again.said
    assert said_of(drawing) == (set(range(10)), None)
    assert sorted(set(begun(drawing))) == list(range(10))
    assert len(begun(drawing)) == 10 + (unfinished is not None)
    places = touched(grbl)
    times = [min(places.count((x0, y0)), places.count((x1, y1))) for x0, y0, x1, y1 in BARS]
    assert min(times) == 1
    assert sum(times) <= 10 + (unfinished is not None), "none but the one that was under the pen is drawn again"


def test_a_drawing_is_painted_on_the_simulated_easel_where_it_lies_on_its_page(drawing: Path) -> None:
    ran = run("paint", drawing)
    assert ran.code == 0, ran.stderr
    assert "10 strokes, 300 mm, 1 paint" in ran.stderr
    dark = picture_of(drawing.with_name("drawing-painted.png")).mean(axis=2) < 0.5
    rows, columns = np.nonzero(dark)
    unit = dark.shape[0] / 40
    assert (columns.min() / unit, columns.max() / unit) == pytest.approx((5, 50), abs=0.5)
    assert (rows.min() / unit, rows.max() / unit) == pytest.approx((5, 35), abs=0.5)


def test_how_it_was_read_is_kept_and_what_would_read_it_otherwise_is_refused(drawing: Path) -> None:
    assert run("paint", drawing, "--rotate", "90", "--from-stroke", "9").code == 0
    (options,) = [
        line["options"]
        for line in map(json.loads, journal_of(drawing).read_text().splitlines())
        if line["event"] == "options"
    ]
    assert options["drawing"] == {"rotate": 90}
    assert len(painted(drawing)) == 2
    for other in (("--rotate", "180"), ("--hatch", "2"), ("--keep-order",)):
        assert run("paint", drawing, "--resume", *other).mistake == (
            "this drawing was begun with other options, and would have other strokes; leave them out, or start on a "
            "new sheet with --restart"
        )
    for same in ((), ("--rotate", "90")):
        assert run("paint", drawing, "--resume", *same).stderr == "all strokes are painted\n"


def test_hatching_is_as_dense_in_millimetres_as_with_its_unit() -> None:
    for typed in ("1.5@30", "1.5mm@30", "0.15cm@30"):
        options = drawing_options(None, None, "0", typed, None, False, None, None, False)
        assert options is not None
        assert (options.hatch, options.hatch_angle) == pytest.approx((1.5e-3, np.pi / 6))


def test_a_drawing_that_has_changed_does_not_go_on(drawing: Path) -> None:
    assert run("paint", drawing, "--from-stroke", "9").code == 0
    drawing.write_text(drawing.read_text().replace("M5.0", "M6.0"))
    ran = run("paint", drawing, "--resume")
    assert ran.mistake.startswith(f"{drawing} is not the file that {journal_of(drawing)} was begun with; ")


def test_a_drawing_that_is_read_as_other_strokes_does_not_go_on(drawing: Path) -> None:
    assert run("paint", drawing, "--hatch", "2", "--hatch-hand", "marks", "--from-stroke", "9").code == 0
    assert run("paint", drawing, "--resume").stderr == "all strokes are painted\n"
    journal = journal_of(drawing)
    journal.write_text(journal.read_text().replace('"hatch": 0.002', '"hatch": 0.003'))
    assert run("paint", drawing, "--resume").code == 0, "nothing is filled, so nothing changes"
    journal.write_text(journal.read_text().replace('"hatch": 0.003', '"keep_order": true, "hatch": 0.003'))
    assert run("paint", drawing, "--resume").mistake == (
        f"{drawing} has other strokes than when it was begun, by another Maulstick, or a hand that has changed; start "
        "again with --restart"
    )


def test_each_layer_is_asked_for_by_its_name_and_colour(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "drawing.svg"
    layer = '<g xmlns:i="http://www.inkscape.org/namespaces/inkscape" i:groupmode="layer" i:label="{}">{}</g>'
    body = '<path stroke="{}" stroke-width=".5" d="M{} 5v9"/>'
    layers = [layer.format("2 blue", body.format("blue", 9)), layer.format("!1+S10 red", body.format("red", 20))]
    file.write_text(SVG.format("".join(layers)))
    with FakeGrbl() as device:
        answers(monkeypatch, "\n\n")
        ran = run("paint", file, "--robot", f"grbl:{device.port}")
    assert ran.code == 0, ran.stderr
    asked = [
        line.removesuffix(" (it draws for less than 1 min); s and Enter stop")
        for line in ran.stderr.splitlines()
        if line.startswith("put in")
    ]
    assert asked == [
        "put in the fineliner 0.5 mm with the paint red #ff0000, and press Enter",
        "put in the fineliner 0.5 mm with the paint blue #0000ff, and press Enter",
    ]
    assert [line for line in device.lines if "F1200" in line], "+S10 is 20 mm/s"
    assert len(events(file)) == 4


def test_a_dry_run_says_what_is_not_drawn_as_the_file_says(drawing: Path) -> None:
    drawing.write_text(SVG.format('<path d="M5 5h90"/>'))
    ran = run("paint", drawing, "--dry-run")
    assert ran.stderr.splitlines()[0] == "note: lines that reach beyond the sheet of 60 x 40 mm are cut at its edges: 1"
    assert "1 stroke, 55 mm" in ran.stderr


def test_a_path_that_is_there_twice_is_drawn_once_on_request(drawing: Path) -> None:
    drawing.write_text(SVG.format('<path d="M5 5h30"/><path d="M35 5h-30"/>'))
    for words, strokes in (((), "2 strokes, 60 mm"), (("--no-repeats",), "1 stroke, 30 mm")):
        assert strokes in run("paint", drawing, "--dry-run", *words).stderr


def test_paths_whose_ends_meet_are_drawn_in_one_go_on_request(drawing: Path) -> None:
    drawing.write_text(SVG.format('<path d="M5 5h30"/><path d="M35 20V5.05"/>'))
    for words, strokes in (((), "2 strokes, 45 mm"), (("--join", "0.1"), "1 stroke, 45 mm")):
        assert strokes in run("paint", drawing, "--dry-run", *words).stderr


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        (("--join", "near"), "--join is 'near'; it must be a length, as 10 for millimetres, 10mm or 1cm"),
        (("--join", "30000"), "--join is 30000 mm; it must be from 0 to 20000 mm"),
        (("--hatch", "wide"), "--hatch is 'wide'; it must be millimetres between lines, as 1, or 1@30 with an angle"),
        (("--hatch", "1@"), "--hatch is '1@'; it must be millimetres between lines, as 1, or 1@30 with an angle"),
        (("--hatch", "1@nan"), "--hatch is '1@nan'; it must be millimetres between lines, as 1, or 1@30 with an angle"),
        (("--hatch", "0"), "--hatch is 0 mm; it must be from 0.05 to 100 mm between lines"),
        (("--rotate", "45"), "--rotate is 45; it must be 0, 90, 180 or 270"),
        (("--margin", "2ft"), "--margin is '2ft'; it must be a length, as 10 for millimetres, 10mm or 1cm"),
        (("--shortest", "far"), "--shortest is 'far'; it must be a length, as 10 for millimetres, 10mm or 1cm"),
        (("--margin", "2cm"), "--margin is 20 mm; it must be below 20 mm, half of the sheet's shorter side"),
        (("--size", "large"), "'large' is not a size; write width x height and a unit"),
        (("--size", "30x1m"), "a side of the canvas is 30000 mm; it must be between 5 mm and 20 m"),
        (("--margin", "20"), "--margin is 20 mm; it must be below 20 mm, half of the sheet's shorter side"),
        (("--shortest", "99"), "all of it is shorter than 99 mm; --shortest must be less"),
    ],
)
def test_options_that_cannot_be_used_are_refused_in_a_sentence(
    drawing: Path, words: tuple[str, str], fault: str
) -> None:
    for command in ("paint", "export", "render"):
        ran: Ran = run(command, drawing, *words)
        assert ran.code == 2
        assert fault in ran.mistake
    assert [file.name for file in drawing.parent.iterdir()] == ["drawing.svg"]


def test_options_of_drawings_are_refused_for_a_painting(painting: Path) -> None:
    for command in ("paint", "export", "render"):
        assert run(command, painting, "--hatch", "1").mistake == (
            f"{painting} is no SVG, and a painting is painted as it was planned; leave out the options of drawings"
        )


def test_a_drawing_is_rendered_and_exported_as_it_would_be_painted(drawing: Path) -> None:
    assert run("render", drawing, "--px", "200", "--margin", "1").code == 0
    dark = picture_of(drawing.with_name("drawing-200px.png")).mean(axis=2) < 0.5
    rows = np.nonzero(dark.any(axis=1))[0]
    assert (rows.min(), rows.max()) == pytest.approx((5, 195), abs=2)
    assert run("show", drawing).code == 0
    assert picture_of(drawing.with_name("drawing-1024px.png")).shape[:2] == (1024, 1536)
    for kind in ("gcode", "hpgl", "svg", "json"):
        assert run("export", drawing, "--format", kind).code == 0
    assert drawing.with_name("drawing.plot.hpgl").read_text().count("PD") >= 10


def test_an_axidraw_draws_it_from_the_corner_where_its_pen_rests(drawing: Path) -> None:
    with FakeEbb(pace=200.0) as device:
        ran = run("paint", drawing, "--robot", f"axidraw:{device.port}")
    assert ran.code == 0, ran.stderr
    assert sorted(painted(drawing)) == list(range(10))
    motors = np.array([(one, two) for one, two, down in device.reached if down])
    places = np.stack([motors.sum(axis=1), motors[:, 0] - motors[:, 1]], axis=1) / 2 / STEPS_PER_MM
    for x0, y0, x1, y1 in BARS:
        for end in ((x0, y0), (x1, y1)):
            assert np.hypot(*(places - end).T).min() < 0.05


def test_a_pen_of_another_width_than_the_lines_is_a_note(drawing: Path) -> None:
    ran = run("paint", drawing, "--pen", "micron-01", "--dry-run")
    assert ran.code == 0
    assert "note: the lines of the drawing are " in ran.stderr
    assert "planned" not in ran.stderr


def test_a_drawing_is_not_planned_again_on_the_way(drawing: Path) -> None:
    ran = run("paint", drawing, "--replan", "3", "--dry-run")
    assert ran.code == 2
    assert ran.mistake.endswith("a drawing is not planned, so it is not planned again either; leave out --replan")


def test_a_page_may_be_larger_than_the_machine_reaches_where_its_strokes_are_not(tmp_path: Path) -> None:
    page = '<svg xmlns="http://www.w3.org/2000/svg" width="210mm" height="297mm" viewBox="0 0 210 297">{}</svg>'
    head, foot = tmp_path / "head.svg", tmp_path / "foot.svg"
    head.write_text(page.format('<path d="M10 30H90"/>'))
    foot.write_text(page.format('<path d="M10 280H90"/>'))
    with FakeEbb() as device:
        robot = ("--robot", f"axidraw:{device.port}", "--dry-run")
        assert run("paint", head, *robot).stderr == "1 stroke, 80 mm, 1 paint, about 1 min\n"
        assert run("paint", foot, *robot).mistake == (
            "stroke 0: the machine's y is -280 mm; it must be -218 to 0 mm: 62 mm less far; lay the sheet elsewhere, "
            "plan for a smaller one, or turn or scale an SVG with --rotate or --size"
        )
        assert run("paint", foot, *robot, "--rotate", "90").code == 0
