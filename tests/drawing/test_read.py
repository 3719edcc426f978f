from pathlib import Path

import numpy as np
import pytest
import vpype
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.optimize import brentq

from maulstick.drawing.lines import bounds_of
from maulstick.drawing.options import DrawingOptions
from maulstick.drawing.read import read_drawing
from maulstick.errors import InputError
from maulstick.ordering.sequence import sequenced
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.painting.refined import refined
from maulstick.storage.arrays import Floats
from tests.drawing.conftest import PAGE, SPACES, Read, labels, millimetres, points

SQUARE = '<path d="M20 10h20v20h-20z" fill="{}" stroke="none"/>'


def test_a_drawing_stays_straight_and_in_its_order_through_its_file(read: Read, tmp_path: Path) -> None:
    painting = read('<path d="M0 0h9v9"/><path d="M50 0l1 20 1-20"/><path d="M5 5h9"/>').painting
    write_painting(painting, tmp_path / "painting.json")
    again = read_painting(tmp_path / "painting.json")
    assert again == painting
    assert refined(again).strokes == sequenced(again, (0.0, 0.0)).strokes == painting.strokes


def test_lines_off_the_sheet_are_cut_at_its_edges_and_counted(read: Read) -> None:
    drawing = read('<path d="M-10 10L110 10"/><path d="M10 -5V5H20V-5H30V5"/><path d="M1 1h9"/><path d="M0 60h9"/>')
    assert points(drawing) == [
        [[0, 10], [100, 10]],
        [[10, 0], [10, 5], [20, 5], [20, 0]],
        [[30, 0], [30, 5]],
        [[1, 1], [10, 1]],
    ]
    assert drawing.notes == ("lines that reach beyond the sheet of 100 x 50 mm are cut at its edges: 3",)


def test_a_curve_that_only_touches_the_edge_leaves_no_dot_there(read: Read) -> None:
    (curve,) = millimetres(read('<circle cx="0" cy="50" r="5"/>'))
    assert curve[[0, -1]] == pytest.approx(np.array([[0, 45], [5, 50]]), abs=1e-3)


def test_a_line_that_crosses_itself_is_cut_only_at_the_edge(read: Read) -> None:
    assert points(read('<path d="M10 10L30 30L30 10L10 30L10 70"/>')) == [
        [[10, 10], [30, 30], [30, 10], [10, 30], [10, 50]]
    ]


def test_clips_cut_what_lies_outside_them_also_within_each_other(read: Read) -> None:
    body = (
        '<clipPath id="a"><rect x="10" y="0" width="30" height="50"/></clipPath>'
        '<clipPath id="b" clip-path="url(#a)"><path clip-rule="evenodd" d="M0 0h60v20h-60zM20 0h10v20h-10z"/>'
        "</clipPath>"
        '<g clip-path="url(#b)"><path d="M0 5h90"/></g><path clip-path="url(#a)" d="M0 25h90"/>'
        '<g clip-path="url(#b)" transform="translate(0 30)"><path d="M0 5h90"/></g><path d="M0 49h90"/>'
    )
    assert points(read(body)) == [
        [[10, 5], [20, 5]],
        [[30, 5], [40, 5]],
        [[10, 25], [40, 25]],
        [[10, 35], [20, 35]],
        [[30, 35], [40, 35]],
        [[0, 49], [90, 49]],
    ]


@pytest.mark.parametrize("place", ["root", "group", "clip", "rule"])
def test_a_clip_has_the_rule_of_what_it_stands_in_and_not_of_what_it_cuts(read: Read, place: str) -> None:
    said = {each: 'style="fill-rule:evenodd;clip-rule:evenodd"' if each == place else "" for each in ("group", "clip")}
    body = (
        f"<style>{'#a { clip-rule: evenodd }' if place == 'rule' else ''}</style>"
        f'<g {said["group"]}><clipPath id="a" {said["clip"]}><path d="M0 0h60v20h-60zM20 0h10v20h-10z"/></clipPath></g>'
        '<g clip-rule="nonzero" clip-path="url(#a)"><path d="M0 5h90"/></g>'
    )
    assert points(read(body, PAGE + (' style="clip-rule:evenodd"' if place == "root" else ""))) == [
        [[0, 5], [20, 5]],
        [[30, 5], [60, 5]],
    ]


def test_a_clip_in_units_of_a_box_is_of_what_it_clips(read: Read) -> None:
    body = (
        '<clipPath id="a" clipPathUnits="objectBoundingBox"><rect x=".25" y="0" width=".5" height="1"/></clipPath>'
        '<g clip-path="url(#a)" transform="translate(10 0)"><path d="M0 0L80 20"/><path d="M10 15h20"/></g>'
        '<g transform="scale(2)"><path clip-path="url(#a)" transform="translate(0 10)" d="M0 2C0 8 16 8 16 2"/></g>'
        '<clipPath id="b" clip-path="url(#a)"><rect width="90" height="50"/></clipPath>'
        '<path clip-path="url(#b)" d="M0 40L80 41"/><path clip-path="url(#a)" d="M0 49h9"/><g clip-path="url(#a)"/>'
    )
    first, second, bowl, fourth = points(read(body))
    assert first == [[30, 5], [70, 15]]
    assert second == [[30, 15], [40, 15]]
    t = brentq(lambda t: 48 * t**2 * (1 - t) + 16 * t**3 - 4, 0, 1)
    assert bowl[0] == pytest.approx([8, 2 * (12 + 18 * t * (1 - t))], abs=0.05)
    assert bowl[-1] == pytest.approx([24, bowl[0][1]], abs=0.05)
    assert fourth == [pytest.approx([20, 40.25]), pytest.approx([60, 40.75])]


def test_a_transform_of_a_clip_is_in_the_units_of_what_it_cuts(read: Read) -> None:
    clip = '<clipPath id="a" {} clipPathUnits="objectBoundingBox"><rect width=".5" height="2"/></clipPath>'
    assert points(read(clip.format('transform="translate(5 0)"') + '<path clip-path="url(#a)" d="M10 9L30 10"/>')) == [
        [[15, 9.25], [25, 9.75]]
    ]


def test_what_cuts_a_clip_lies_where_the_clip_is_used_and_is_of_each_that_it_cuts(read: Read) -> None:
    body = (
        '<clipPath id="half" clipPathUnits="objectBoundingBox"><rect width=".5" height="2"/></clipPath>'
        '<clipPath id="a" clip-path="url(#half)" transform="translate(5 0)"><rect width="90" height="50"/></clipPath>'
        '<path clip-path="url(#a)" d="M0 9L40 10"/><path clip-path="url(#a)" d="M0 29L80 30"/>'
        '<clipPath id="b" clip-path="url(#half)" clipPathUnits="objectBoundingBox">'
        '<rect width="1" height="2"/></clipPath>'
        '<path clip-path="url(#b)" d="M20 39L40 40"/>'
    )
    assert points(read(body)) == [[[5, 9.12], [20, 9.5]], [[5, 29.06], [40, 29.5]], [[20, 39], [30, 39.5]]]


def test_a_clip_in_percent_is_of_the_viewport_that_it_is_used_in(read: Read) -> None:
    line = '<path clip-path="url(#a)" d="M0 5h90"/>'
    body = f'<clipPath id="a"><rect width="50%" height="50%"/></clipPath>{line}<svg width="60">{line}</svg>'
    assert points(read(body)) == [[[0, 5], [50, 5]], [[0, 5], [30, 5]]]


def test_what_is_clipped_may_have_parts_in_the_same_clip(read: Read) -> None:
    clips = (
        '<clipPath id="half" clipPathUnits="objectBoundingBox"><rect width=".5" height="2"/></clipPath>'
        '<clipPath id="a" clip-path="url(#half)"><rect width="90" height="50"/></clipPath>'
    )
    nested = '<path clip-path="url(#a)" d="M0 9L80 10"/>'
    for _ in range(40):  # would be measured 2**40 times if each measured what lies in it anew
        nested = f'<g clip-path="url(#a)">{nested}</g>'
    assert points(read(clips + nested)) == [[[0, 9], [40, 9.5]]]


@pytest.mark.parametrize("units", ["", 'clipPathUnits="objectBoundingBox" transform="scale(.025 1)"'])
def test_a_clip_of_what_is_used_is_moved_with_it(read: Read, units: str) -> None:
    body = (
        f'<defs><clipPath id="c" {units}><rect width="20" height="20"/></clipPath><path id="l" d="M0 9L40 10"/></defs>'
        '<use href="#l" x="50" clip-path="url(#c)"/>'
    )
    assert points(read(body)) == [[[50, 9], [70, 9.5]]]


@given(hnp.arrays(float, (3, 4, 2), elements=st.floats(-1e3, 1e3)))
@example(np.array([[[6.0, 6.0], [1e-308, 6.0], [0.0, 6.0], [6.0, 6.0]]]))  # whose turn lies beyond all floats
def test_the_bounds_of_curves_are_those_of_their_points(cubics: Floats) -> None:
    least, most = bounds_of([cubics])
    t = np.linspace(0, 1, 2001)[:, None, None]
    p, q, r, s = np.moveaxis(cubics, 1, 0)
    points = (1 - t) ** 3 * p + 3 * (1 - t) ** 2 * t * q + 3 * (1 - t) * t**2 * r + t**3 * s
    assert least == pytest.approx(points.min(axis=(0, 1)), abs=2e-3)
    assert most == pytest.approx(points.max(axis=(0, 1)), abs=2e-3)
    assert (least <= points.min(axis=(0, 1)) + 1e-9).all()
    assert (most >= points.max(axis=(0, 1)) - 1e-9).all()


def test_an_empty_clip_hides_all(read: Read) -> None:
    body = '<clipPath id="a"/><path clip-path="url(#a)" d="M0 25h90"/><path d="M0 9h9"/>'
    assert points(read(body)) == [[[0, 9], [9, 9]]]


def test_masks_and_markers_are_said_to_be_passed_over(read: Read) -> None:
    body = '<mask id="m"/><marker id="k"/><g mask="url(#m)"><path style="marker-end:url(#k)" d="M0 9h9"/></g>'
    assert read(body).notes == ("passed over: markers, masks",)


def test_a_clip_by_a_basic_shape_is_said_to_be_passed_over(read: Read) -> None:
    assert read('<path style="clip-path:circle(9px at 9px 9px)" d="M0 9h9"/>').notes == (
        "passed over: clips by CSS's basic shapes",
    )
    assert read('<path style="clip-path:none" clip-path="inset(1px)" d="M0 9h9"/>').notes == ()


def test_dashes_are_said_to_be_passed_over_where_there_are_any(read: Read) -> None:
    solid = '<path stroke-dasharray="none" stroke="red" d="M0 9h9"/><path stroke-dasharray="2" d="M0 9h9"/>'
    assert read(solid).notes == ()
    dashed = '<g style="stroke-dasharray:2,1"><path stroke="red" d="M0 9h9"/></g>'
    assert read(dashed).notes == ("passed over: dashes",)


def test_a_page_is_scaled_to_the_sheet_and_a_margin_scales_what_is_drawn(read: Read) -> None:
    body = '<path d="M10 10L30 20"/>'
    scaled = read(body, size=(0.2, 0.2))
    assert points(scaled) == [[[20, 70], [60, 90]]]
    assert scaled.painting.sheet.millimetres == "200 x 200 mm"
    assert points(read(body, size=(0.2, 0.2), margin=0.01)) == [[[10, 55], [190, 145]]]
    assert points(read(body, margin=0.005)) == [[[10, 5], [90, 45]]]
    assert points(read('<path d="M200 200h10"/>', margin=0.0)) == [[[0, 25], [100, 25]]]


@pytest.mark.parametrize(
    ("turn", "size", "line"),
    [
        (90, "50 x 100 mm", [[40, 10], [40, 30]]),
        (180, "100 x 50 mm", [[90, 40], [70, 40]]),
        (270, "50 x 100 mm", [[10, 90], [10, 70]]),
    ],
)
def test_a_page_is_turned_clockwise(read: Read, turn: int, size: str, line: list[list[float]]) -> None:
    drawing = read('<path d="M10 10h20"/>', rotate=turn)
    assert points(drawing) == [line]
    assert drawing.painting.sheet.millimetres == size


def test_paths_that_are_there_twice_are_drawn_once_on_request(read: Read) -> None:
    curve = '<path d="M1 1C5 1 9 5 9 9"/><path d="M9 9C9 5 5 1 1 1"/><path d="M1 1h9"/>'
    body = f'{curve}<g transform="translate(1 0)">{curve}<path d="M9 1h-9"/></g><path d="M1 1h9" stroke="red"/>'
    assert len(read(body).painting.strokes) == 8
    assert len(read(body, no_repeats=True).painting.strokes) == 5


def test_specks_are_left_out_on_request(read: Read) -> None:
    body = '<path d="M1 1h.5"/><path d="M2 2z"/><path d="M5 5h3"/>'
    assert len(read(body).painting.strokes) == 3
    assert points(read(body, shortest=0.001)) == [[[5, 5], [8, 5]]]


def test_the_order_is_quick_unless_that_of_the_file_is_kept(read: Read) -> None:
    body = "".join(f'<path d="M{x} 1v9"/>' for x in (5, 50, 6, 51, 7, 52))
    assert [line[0][0] for line in points(read(body))] == [5, 50, 6, 51, 7, 52]
    assert [line[0][0] for line in points(read(body, keep_order=False))] == [5, 6, 7, 50, 51, 52]


def test_fills_are_hatched_in_their_own_colour_under_their_outlines(read: Read) -> None:
    drawing = read(SQUARE.format("red") + '<path d="M60 10h20" stroke="blue" fill="none"/>', hatch=0.002, hatch_angle=0)
    assert labels(drawing) == ["#ff0000", "#0000ff"]
    hatches = [line for line in points(drawing) if len(line) == 2 and line[0][0] < 50]
    assert [line[0][1] for line in hatches] == [11, 13, 15, 17, 19, 21, 23, 25, 27, 29]
    assert all(sorted(x for x, _ in line) == [20, 40] for line in hatches)
    assert [line[0][0] for line in hatches[:4]] == [20, 40, 20, 40], "to and fro"


def test_white_fills_and_no_fills_are_not_hatched(read: Read) -> None:
    body = SQUARE.format("white") + SQUARE.format("none") + SQUARE.format("#fff")
    assert len(read(body, hatch=0.001).painting.strokes) == 3


def test_in_layers_a_fill_of_another_colour_has_a_pen_of_its_own(read: Read) -> None:
    shape = '<rect width="9" height="9" fill="{}" stroke="black"/>'
    body = "".join(
        f'<g inkscape:groupmode="layer" inkscape:label="{name}">{shape.format(fill)}</g>'
        for name, fill in (("one", "red"), ("two", "black"))
    )
    assert labels(read(body, hatch=0.002)) == ["one #ff0000", "one #000000", "two #000000"]


@pytest.mark.parametrize(("rule", "share"), [("evenodd", 300), ("nonzero", 400)])
def test_hatches_follow_the_rule_of_the_fill(read: Read, rule: str, share: float) -> None:
    body = f'<path fill-rule="{rule}" d="M10 10h20v20h-20zM15 15h10v10h-10z"/>'
    drawn = sum(np.hypot(*np.diff(line, axis=0).T).sum() for line in millimetres(read(body, hatch=0.0005)))
    assert drawn - 120 == pytest.approx(share / 0.5, rel=0.02)


def test_hatches_are_cut_by_clips(read: Read) -> None:
    clip = '<clipPath id="c"><rect x="0" y="0" width="30" height="50"/></clipPath>'
    body = f'{clip}<g clip-path="url(#c)">{SQUARE.format("black")}</g>'
    assert max(line[:, 0].max() for line in millimetres(read(body, hatch=0.001))) == pytest.approx(30)


@pytest.mark.parametrize(
    ("options", "fault"),
    [
        ({"size": (30.0, 0.1)}, "size is 30000 mm on a side; it must be between 5 mm and 20 m"),
        ({"size": (0.1, 0.004)}, "size is 4 mm on a side; it must be between 5 mm and 20 m"),
        ({"margin": 0.03}, "margin is 30 mm; it must be below 25 mm, half of the sheet's shorter side"),
        ({"margin": float("nan")}, "margin is nan mm"),
        ({"hatch": 1e-6}, "hatch is 0.001 mm"),
        ({"hatch": 1e-3, "hatch_angle": float("inf")}, "hatch_angle is inf"),
        ({"margin": 30.0}, "margin is 30000 mm; it must be from 0 to 20000 mm"),
        ({"shortest": -1.0}, "shortest is -1000 mm"),
        ({"shortest": 30.0}, "shortest is 30000 mm; it must be from 0 to 20000 mm"),
        ({"shortest": 1.0}, "all of it is shorter than 1000 mm; shortest must be less"),
    ],
)
def test_options_out_of_their_range_are_refused(read: Read, options: dict[str, object], fault: str) -> None:
    with pytest.raises(InputError, match=r"cannot draw|must be") as refused:
        read('<path d="M0 0h9"/>', **options)
    assert fault in str(refused.value)


BODIES = {
    "units": '<rect x="1cm" y="10" width="10%" height="5mm"/><circle cx="50%" cy="50%" r="9"/>',
    "transforms": '<g transform="rotate(20 30 20)">'
    '<path transform="translate(9 3) scale(.7 1.2)" d="M1 1q9-4 20 9t9 3"/></g>',
    "arcs": '<path d="M10 30a20 9 30 1 1 30 5A9 9 0 0 0 60 20z"/><ellipse cx="70" cy="25" rx="20" ry="9"/>',
    "rounded": '<rect x="5" y="5" width="40" height="30" rx="9" ry="4"/><polygon points="60,5 90,40 50,45"/>',
    "uses": '<defs><path id="a" d="M0 0c9 0 9 9 20 9s9-9 3-9z"/></defs>'
    '<use href="#a" x="9" y="9" transform="scale(1.5)"/>',
    "off": '<path d="M-20 20C50 5 90 5 130 40"/><polyline points="10,10 200,20 10,30 -40,70"/>',
    "styles": '<g style="stroke:red"><line x1="1" y1="1" x2="90" y2="49"/></g><path d="M0 0zM5 5h9m3 3v9"/>',
}  # fmt: skip


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("page", ['width="100mm" height="50mm" viewBox="0 0 100 50"', 'viewBox="-10 -20 200 90"', ""])
def test_what_vpype_reads_lies_within_two_hundredths_of_a_millimetre(tmp_path: Path, name: str, page: str) -> None:
    file = tmp_path / "drawing.svg"
    file.write_text(f"<svg {SPACES} {page}>{BODIES[name]}</svg>")
    theirs, width, height = vpype.read_svg(str(file), quantization=0.05)
    unit = 25.4 / 96
    ours = read_drawing(file, DrawingOptions(keep_order=True))
    assert ours.painting.sheet.width == pytest.approx(1e-3 * unit * width, abs=1e-6)
    assert ours.painting.sheet.height == pytest.approx(1e-3 * unit * height, abs=1e-6)
    lines = [unit * np.stack([line.real, line.imag], axis=1) for line in theirs if len(line) > 1]
    found = [line for line in millimetres(ours) if np.ptp(line, axis=0).max() > 1e-3]
    assert _farthest(found, lines) < 0.02
    assert _farthest(lines, found) < 0.02


def _farthest(lines: list[Floats], others: list[Floats]) -> float:
    """The greatest distance of a point of the lines from the others, millimetres."""
    import shapely

    there = shapely.union_all([shapely.LineString(line) for line in others])
    return float(shapely.distance(shapely.points(np.concatenate(lines)), there).max())
