import json
import re
from pathlib import Path

import numpy as np
import pytest
from gcodeparser import parse_gcode_lines

from maulstick.painting.brush import Brush
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import write_painting
from maulstick.robot.easel import Easel, Pen, write_easel
from tests.cli.conftest import run
from tests.robot.test_export import places_of
from tests.support.nominal import nominal
from tests.support.robot.small_paintings import HEIGHT, SIX, line, painting_of
from tests.support.robot.trays import TRAY_JSON
from tests.support.tolerances import GCODE_METRES, HPGL_METRES

ROUND = SIX.model_copy(
    update={
        "brushes": {"round": nominal("round")},
        "paints": tuple(paint.model_copy(update={"brush": "round"}) for paint in SIX.paints),
    }
)
VARIED = painting_of([line(0, pressure=(0.1, 0.9))])
Rows = set[tuple[tuple[float, float], ...]]


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a painting of six strokes, in which the commands run."""
    monkeypatch.chdir(tmp_path)
    write_painting(ROUND, tmp_path / "painting.json")
    return tmp_path


def exported(*words: str) -> str:
    ran = run("export", "painting.json", *words)
    assert (ran.code, ran.stderr) == (0, "")
    return Path(ran.stdout.rstrip("\n")).read_text()


def rows_of(painting: Painting) -> Rows:
    """Both ends of each stroke, from left to right, with the sheet's lower left corner at the origin, 0.1 mm."""
    ends = [np.array(stroke.trajectory)[[0, -1], :2] for stroke in painting.strokes]
    return {_row((x0, HEIGHT - y0), (x1, HEIGHT - y1)) for (x0, y0), (x1, y1) in ends}


def _row(*ends: tuple[float, float]) -> tuple[tuple[float, float], ...]:
    return tuple(sorted((round(float(x), 4), round(float(y), 4)) for x, y in ends))


def test_gcode_draws_the_painting_with_its_lower_left_corner_at_the_origin() -> None:
    text = exported()
    assert Path("painting.plot.gcode").read_text() == text
    places = places_of(text)[1:]
    strokes = [places[i : i + 7] for i in range(0, len(places), 7)]
    assert len(strokes) == 6
    assert {_row(stroke[1, :2], stroke[5, :2]) for stroke in strokes} == rows_of(ROUND)
    for stroke in strokes:
        assert stroke[1:6, 2] == pytest.approx([-0.004] * 5, abs=GCODE_METRES)
        assert stroke[[0, 6], 2] == pytest.approx([0.005] * 2, abs=GCODE_METRES)
    assert text.count("M0") == 2


def test_gcode_for_a_servo_and_for_marlin_needs_no_depth() -> None:
    write_painting(SIX, Path("painting.json"))
    assert "M3 S90" in exported("--servo", "30,90")
    assert "M280 P0 S90" in exported("--servo", "30,90", "--dialect", "marlin", "--overwrite")


def test_no_feed_is_faster_than_asked() -> None:
    feeds = [float(feed) for feed in re.findall(r"F([\d.]+)", exported("--speed", "12.5"))]
    assert max(feeds) == 60 * 12.5


def test_gcode_goes_where_the_easel_says(here: Path) -> None:
    easel = Easel(corner=(0.2, 0.5, 0.01), right=(1, 0, 0), down=(0, -1, 0), deepest=0.008)
    write_easel(easel, here / "easel.json")
    places = places_of(exported("--easel", "easel.json"))[1:]
    assert places[:, :2].min(axis=0) == pytest.approx([0.21, 0.47], abs=GCODE_METRES)
    assert places[:, 2].min() == pytest.approx(0.006, abs=GCODE_METRES)


def test_gcode_is_lifted_as_high_as_the_easel_and_the_tray_say_above_tilted_paper_too(here: Path) -> None:
    down = (0.0, -np.cos(0.09), -np.sin(0.09))
    easel = Easel(corner=(0, 0, 0), right=(1, 0, 0), down=down, deepest=0.008, travel=0.2)
    write_easel(easel, here / "easel.json")
    assert places_of(exported("--easel", "easel.json"))[:, 2].max() > 0.19
    (here / "tray.json").write_text(json.dumps({**TRAY_JSON, "clearance": 0.3}))
    assert places_of(exported("--easel", "easel.json", "--tray", "tray.json", "--overwrite"))[:, 2].max() > 0.29


def test_a_servo_of_other_numbers_takes_the_time_that_the_easel_says(here: Path) -> None:
    pen = Pen(up=1, down=2, seconds=0.7)
    write_easel(Easel(corner=(0, 0.5, 0), right=(1, 0, 0), down=(0, -1, 0), pen=pen), here / "easel.json")
    assert "M3 S90\nG4 P0.700" in exported("--easel", "easel.json", "--servo", "30,90")


def test_gcode_visits_the_tray_beside_the_sheet() -> None:
    Path("tray.json").write_text(json.dumps(TRAY_JSON))
    places = places_of(exported("--tray", "tray.json"))
    assert places[1:, 0].max() > 0.12


def test_hpgl_is_in_units_of_a_fortieth_of_a_millimetre_with_a_pen_a_paint() -> None:
    write_painting(SIX, Path("painting.json"))
    ran = run("export", "painting.json", "--format", "hpgl")
    assert (ran.code, ran.stderr) == (0, "note: pen 1 is marker #cc1a1a, pen 2 is marker #1a33b2\n"), "or nobody knows"
    text = Path(ran.stdout.rstrip("\n")).read_text()
    rows = re.findall(r"PU(-?\d+,-?\d+);PD([-\d,]+);", text)
    units = [np.array(f"{start},{rest}".split(","), dtype=float).reshape(-1, 2) for start, rest in rows]
    found = {_row(path[0] * 0.025e-3, path[-1] * 0.025e-3) for path in units}
    assert np.abs(np.array(sorted(found)) - sorted(rows_of(SIX))).max() < HPGL_METRES
    assert re.findall(r"SP(\d)", text) == ["1", "2", "0"]


def test_svg_is_read_by_vpype_in_its_place() -> None:
    import vpype

    exported("--format", "svg")
    document = vpype.read_multilayer_svg("painting.plot.svg", quantization=0.1)
    metre = 96 / 0.0254
    lines = [each / metre for layer in document.layers.values() for each in layer]
    found = {_row((each[0].real, HEIGHT - each[0].imag), (each[-1].real, HEIGHT - each[-1].imag)) for each in lines}
    assert found == rows_of(ROUND)
    assert len(document.layers) == 2


def test_json_is_a_motion_a_line() -> None:
    entries = [json.loads(row) for row in exported("--format", "json").splitlines()]
    draws = [entry for entry in entries if entry["do"] == "draw"]
    assert {_row(entry["path"][0][:2], entry["path"][-1][:2]) for entry in draws} == rows_of(ROUND)
    assert {entry["stroke"] for entry in draws} == set(range(10, 16))


def test_a_pen_that_only_lifts_is_told_how_to_plan_for_it() -> None:
    write_painting(VARIED, Path("painting.json"))
    for words in (("--format", "hpgl"), ("--servo", "30,90")):
        assert run("export", "painting.json", *words).mistake == (
            "stroke 0 varies its pressure by 0.80, and this machine only lifts its pen; "
            "plan it again with maulstick plan --pressure 0.5"
        )


def test_without_any_depth_gcode_by_height_is_refused() -> None:
    write_painting(SIX, Path("painting.json"))
    ran = run("export", "painting.json")
    assert ran.code == 2
    assert "neither the brush marker nor the easel says how deep it may be pressed" in ran.mistake


def test_strokes_that_reach_a_millimetre_beyond_the_sheet_are_exported_with_a_note(here: Path) -> None:
    strokes = [line(0, (-0.001, 0.01), (0.03, 0.01)), line(1, (0.01, HEIGHT + 5e-4), (0.03, HEIGHT))]
    write_painting(painting_of(strokes, [nominal("fineliner")]), here / "painting.json")
    for words in (("--servo", "30,90"), ("--format", "hpgl"), ("--format", "json"), ("--format", "svg")):
        ran = run("export", "painting.json", *words)
        assert ran.code == 0, ran.stderr
        assert "note: strokes reach up to 1 mm beyond the sheet; let the machine have so much room" in ran.stderr
    text = Path("painting.plot.gcode").read_text()
    assert "X-1.000" in text
    assert "Y-0.500" in text
    write_painting(painting_of(strokes[1:], [nominal("fineliner")], (0.06, HEIGHT + 5e-4)), here / "inside.json")
    assert run("export", "inside.json", "--servo", "30,90").stderr == ""


def test_what_rounding_takes_past_that_millimetre_is_exported_too(here: Path) -> None:
    write_painting(
        painting_of([line(0, (-0.001001, 0.01), (0.03, 0.01))], [nominal("fineliner")]), here / "painting.json"
    )
    ran = run("export", "painting.json", "--servo", "30,90")
    assert ran.code == 0, ran.stderr
    assert "X-1.001" in Path("painting.plot.gcode").read_text()


def test_nothing_is_overwritten_unless_it_is_asked_for() -> None:
    Path("there.gcode").write_text("mine")
    ran = run("export", "painting.json", "--out", "there.gcode")
    assert (ran.code, ran.mistake) == (
        1, "there.gcode is already there; choose another --out, or add --overwrite",
    )  # fmt: skip
    assert Path("there.gcode").read_text() == "mine"
    assert exported("--out", "there.gcode", "--overwrite").startswith("G21")


def test_what_is_exported_is_not_written_over(here: Path) -> None:
    Path("drawing.svg").write_text(exported("--format", "svg"))
    before = {file: Path(file).read_bytes() for file in ("painting.json", "drawing.svg")}
    for file, format in (("painting.json", "gcode"), ("drawing.svg", "svg")):
        ran = run("export", file, "--format", format, "--out", here / file, "--overwrite")
        assert ran.mistake == f"--out is {here / file}, the painting itself; choose another --out"
    Path("drawing.svg").rename("drawing-2.svg")
    ran = run("export", "drawing-2.svg", "--format", "svg", "--per-pen", "--out", "drawing.svg", "--overwrite")
    assert "--out is drawing-2.svg, the painting itself; choose another --out" in ran.stderr
    assert before == {
        "painting.json": Path("painting.json").read_bytes(),
        "drawing.svg": Path("drawing-2.svg").read_bytes(),
    }


def test_a_folder_that_is_not_there_is_found_before_anything_is_exported() -> None:
    Path("painting.json").write_text("broken")
    ran = run("export", "painting.json", "--out", "no/painting.gcode")
    assert ran.mistake == "cannot write no/painting.gcode: its folder does not exist; make the folder first"


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("--speed", "0"), "--speed is 0; it must be from 0.1 to 10000 mm/s"),
        (("--speed", "nan"), "--speed is nan; it must be from 0.1 to 10000 mm/s"),
        (("--servo", "up"), "--servo is 'up'; it must be two numbers that differ, up and down, as in 30,90"),
        (("--servo", "90,90"), "--servo is '90,90'; it must be two numbers that differ, up and down, as in 30,90"),
        (("--servo", "nan,90"), "--servo is 'nan,90'; it must be two numbers that differ, up and down, as in 30,90"),
        (("--servo", "-10,90"), "a number of the servo is -10; it must be from 0 to 65535 in G-code"),
        (("--servo", "30,1e6"), "a number of the servo is 1e+06; it must be from 0 to 65535 in G-code"),
        (("--servo", "30,90", "--format", "hpgl"), "--servo and --dialect are for G-code; leave them out"),
        (("--tray", "t", "--format", "svg"), "SVG is of the sheet alone; leave out --easel, --tray and --speed"),
        (("--easel", "none.json"), "there is no easel none.json; check its name and folder"),
        (("--tray", "none.json"), "there is no tray none.json; check its name and folder"),
    ],
)
def test_what_cannot_be_exported_is_one_sentence(words: tuple[str, ...], text: str) -> None:
    ran = run("export", "painting.json", *words)
    assert (ran.code, ran.mistake) == (2, text)
    assert sorted(path.name for path in Path().iterdir()) == ["painting.json"]


def test_a_painting_that_is_not_there_and_a_format_that_is_none_are_refused() -> None:
    assert run("export", "none.json").mistake == "there is no painting none.json; check its name and folder"
    ran = run("export", "painting.json", "--format", "dxf")
    assert ran.code == 2
    assert "'dxf'" in ran.stderr


def test_a_tray_has_no_place_in_hpgl() -> None:
    brush = nominal("round")
    lifted = Brush.model_validate({**brush.model_dump(), "alpha": 0.0, "depth": (0.0, 0.0)})
    write_painting(ROUND.model_copy(update={"brushes": {"round": lifted}}), Path("painting.json"))
    Path("tray.json").write_text(json.dumps(TRAY_JSON))
    ran = run("export", "painting.json", "--format", "hpgl", "--tray", "tray.json")
    assert ran.mistake == "HPGL knows pens and no wells; leave out the tray, or export gcode"


def test_an_svg_says_that_the_pressure_is_lost(here: Path) -> None:
    write_painting(VARIED, here / "painting.json")
    ran = run("export", "painting.json", "--format", "svg")
    assert ran.code == 0
    assert ran.stderr == (
        "note: stroke 0 varies the pressure, which an SVG cannot say: the pen's height is one for each layer\n"
    )


def test_hpgl_of_more_paints_than_pens_is_a_file_per_load(here: Path) -> None:
    strokes = [line(i, (0.01, 0.004 * (i + 1)), (0.03, 0.004 * (i + 1)), paint=i) for i in range(5)]
    write_painting(painting_of(strokes, [nominal("fineliner")]), here / "painting.json")
    ran = run("export", "painting.json", "--format", "hpgl", "--carousel", "2", "--speed", "30")
    assert ran.code == 0, ran.stderr
    files = [f"painting.plot-{number}.hpgl" for number in (1, 2, 3)]
    assert ran.stdout.splitlines() == files
    said = ran.stderr.splitlines()
    assert [row.partition(": ")[0] for row in said] == files
    assert all(row.startswith("IN;VS3;\n") for row in (Path(file).read_text() for file in files))
    assert said[2].count("pen ") == 1
    ran = run("export", "painting.json", "--format", "hpgl", "--carousel", "2")
    assert (ran.code, "painting.plot-1.hpgl is already there" in ran.stderr) == (1, True)
    ran = run("export", "painting.json", "--format", "hpgl", "--carousel", "3", "--overwrite")
    assert ran.stdout.splitlines() == files[:2]
    assert ran.stderr.splitlines()[2:] == [
        "note: painting.plot-3.hpgl is not of this export; delete it if an earlier one, with other pens, left it"
    ], "or somebody plots it"
    ran = run("export", "painting.json", "--format", "hpgl", "--carousel", "8", "--overwrite")
    assert ran.stderr.count("is not of this export") == 3
    assert run("export", "painting.json", "--format", "hpgl", "--out", "alone.hpgl").code == 0
    assert "VS" not in Path("alone.hpgl").read_text(), "the plotter's own speed"


def test_an_svg_per_pen_holds_the_strokes_of_that_pen_alone(here: Path) -> None:
    ran = run("export", "painting.json", "--format", "svg", "--per-pen")
    assert ran.code == 0
    files = ["painting.plot-1.svg", "painting.plot-2.svg"]
    assert ran.stdout.splitlines() == files
    assert [row.partition(": ")[0] for row in ran.stderr.splitlines()] == files
    drawn = [Path(file).read_text().count("<path") for file in files]
    whole = exported("--format", "svg").count("<path")
    assert (sum(drawn), min(drawn) > 0) == (whole, True)


@pytest.mark.parametrize(("words", "parts"), [(("--format", "svg", "--per-pen"), 2), (("--format", "hpgl"), 1)])
def test_a_file_that_would_not_be_written_stands_in_nobodys_way(words: tuple[str, ...], parts: int) -> None:
    path = Path(f"painting.plot.{words[1]}")
    path.write_text("before")
    ran = run("export", "painting.json", *words)
    assert path.read_text() == "before"
    if parts == 1:
        assert ran.mistake == f"{path} is already there; choose another --out, or add --overwrite"
    else:
        assert ran.stdout.split() == ["painting.plot-1.svg", "painting.plot-2.svg"]
        assert f"note: {path} is not of this export" in ran.stderr


def test_an_svg_per_pen_says_where_a_pen_is_taken_up_again(here: Path) -> None:
    across = [line(i, (0.01, 0.01), (0.03, 0.03), paint=i % 2) for i in range(3)]
    write_painting(painting_of(across, [nominal("fineliner")]), here / "painting.json")
    assert exported("--format", "svg").count("inkscape:label") == 3
    ran = run("export", "painting.json", "--format", "svg", "--per-pen", "--overwrite")
    assert ran.code == 0
    assert ran.stderr.splitlines()[0] == (
        "note: pens are taken up 3 times in this painting, and here 2 times: "
        "where strokes of two pens overlap, the other one may come to lie on top"
    )


def test_a_sheet_that_is_too_large_for_hpgl_is_refused_or_drawn_smaller(here: Path) -> None:
    strokes = [line(0, (0.1, 0.1), (1.1, 0.6))]
    write_painting(painting_of(strokes, [nominal("fineliner")], (1.2, 0.8)), here / "painting.json")
    ran = run("export", "painting.json", "--format", "hpgl")
    assert ran.code == 2
    assert (
        "HPGL counts up to 819 mm; draw it smaller with --shrink, plan for a smaller sheet, or scale an SVG with --size"
        in ran.mistake
    )
    numbers = [abs(int(number)) for number in re.findall(r"-?\d+", exported("--format", "hpgl", "--shrink"))]
    assert max(numbers) == 32_767


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("--carousel", "0", "--format", "hpgl"), "--carousel is 0; it must be 1 to 99"),
        (("--carousel", "4"), "--carousel and --shrink are for HPGL; leave them out"),
        (("--shrink", "--format", "svg"), "--carousel and --shrink are for HPGL; leave them out"),
        (("--speed", "5", "--format", "hpgl"), "--speed is 5 mm/s; it must be at least 10 mm/s for HPGL"),
    ],
)
def test_options_of_hpgl_that_do_not_fit_are_refused(words: tuple[str, ...], text: str) -> None:
    assert run("export", "painting.json", *words).mistake == text


@pytest.mark.parametrize("dialect", ["grbl", "marlin"])
@pytest.mark.parametrize("servo", [(), ("--servo", "30,90")])
def test_another_programs_reader_finds_the_same_drawing_in_gcode(dialect: str, servo: tuple[str, ...]) -> None:
    """gcodeparser reads it, which knows no dialect: what lowers and lifts is looked up here."""
    rows = list(parse_gcode_lines(exported("--dialect", dialect, *servo)))
    down, at, strokes = False, (0.0, 0.0), list[list[tuple[float, float]]]()
    for row in rows:
        word, params = row.command_str, row.params
        if word == "G1" and "X" in params:
            at = (1e-3 * params["X"], 1e-3 * params["Y"])
            if not servo:
                lower = params["Z"] < 0
                if lower and not down:
                    strokes.append([])
                down = lower
            if down:
                strokes[-1].append(at)
        elif word == "G1":
            down = params["Z"] < 0
        elif (dialect, word) in (("grbl", "M3"), ("marlin", "M280")):
            down = params["S"] == 90
            if down:
                strokes.append([at])
    assert {_row(stroke[0], stroke[-1]) for stroke in strokes} == rows_of(ROUND)
    words = {row.command_str for row in rows}
    pens = ({"M3", "G4"} if dialect == "grbl" else {"M280", "M400", "G4"}) if servo else set()
    assert words == {"G21", "G90", "G1", "M0", *pens} | ({"G94", "G54"} if dialect == "grbl" else set())
    waits = {row.params["P"] for row in rows if row.command_str == "G4"}
    assert waits == ({0.2 if dialect == "grbl" else 200} if servo else set()), "seconds, and milliseconds"
