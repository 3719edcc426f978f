from pathlib import Path

import numpy as np
import pytest
from defusedxml import EntitiesForbidden
from scipy.spatial.distance import cdist
from svgelements import Matrix

from maulstick.drawing.options import DrawingOptions
from maulstick.drawing.read import read_drawing
from maulstick.errors import InputError
from maulstick.painting.painting import Stroke
from maulstick.painting.refined import refined
from maulstick.painting.svg import painting_svg
from maulstick.recording.files.page import Page
from maulstick.recording.files.svg_ink import read_svg
from maulstick.storage.arrays import Floats
from tests.painting.test_painting import CURVE, a_painting

SHEET = 'width="100mm" height="50mm" viewBox="0 0 100 50"'


def svg(body: str, root: str = SHEET) -> Page:
    spaces = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
    return read_svg(f"<svg {spaces} {root}>{body}</svg>".encode())


def strokes(body: str, root: str = SHEET) -> list[Floats]:
    """The x, y of each stroke, in millimetres."""
    page = svg(body, root)
    assert page.unit is not None
    return [np.round(1e3 * page.unit * stroke[:, 1:3], 6) for stroke in page.strokes]


def ends(body: str, root: str = SHEET) -> list[list[list[float]]]:
    return [stroke[[0, -1]].tolist() for stroke in strokes(body, root)]


def test_lines_and_polylines_keep_their_points() -> None:
    body = '<line x1="1" y1="2" x2="3" y2="4"/><polyline points="0,0 5,0 5,7"/><polygon points="0,0 5,0 5,7"/>'
    expected = [[[1, 2], [3, 4]], [[0, 0], [5, 0], [5, 7]], [[0, 0], [5, 0], [5, 7], [0, 0]]]
    assert [stroke.tolist() for stroke in strokes(body)] == expected


def test_there_are_no_times_and_no_pressure() -> None:
    page = svg('<path d="M0 0L9 9"/>')
    assert np.isnan(page.strokes[0][:, [0, 3]]).all()
    assert page.kind == "SVG"


def test_each_subpath_is_a_stroke_and_a_closed_one_returns_to_its_start() -> None:
    body = '<path d="M1 1H5V5z m10 0l1 1M20 20"/>'
    assert [stroke.tolist() for stroke in strokes(body)] == [[[1, 1], [5, 1], [5, 5], [1, 1]], [[11, 1], [12, 2]]]


@pytest.mark.parametrize(
    ("path", "end"),
    [
        ("C10 20 30 20 40 10", [40, 10]),
        ("Q25 30 40 10", [40, 10]),
        ("A15 15 0 0 0 40 10", [40, 10]),
        ("S30 0 40 9", [40, 9]),
    ],
)
def test_curves_are_sampled_finely_between_their_ends(path: str, end: list[float]) -> None:
    (stroke,) = strokes(f'<path d="M10 10{path}"/>')
    assert stroke[[0, -1]].tolist() == [[10, 10], end]
    turns = np.abs(np.diff(np.unwrap(np.arctan2(*np.diff(stroke, axis=0).T))))
    assert turns.max() < 0.2, "no corner"


@pytest.mark.parametrize(
    ("smooth", "plain"),
    [
        ("Q10 9 20 0S30 9 40 0", "Q10 9 20 0C20 0 30 9 40 0"),
        ("q10 9 20 0t9-.5e1s10 9 20 0", "Q10 9 20 0T29 -5C29 -5 39 4 49 -5"),
        ("C0 9 20 9 20 0T40 0", "C0 9 20 9 20 0Q20 0 40 0"),
        ("C0 9 20 9 20 0S30 9 40 0t20 5t9 9", "C0 9 20 9 20 0S30 9 40 0Q40 0 60 5T69 14"),
    ],
)
def test_a_smooth_curve_takes_no_direction_of_a_curve_of_another_kind(tmp_path: Path, smooth: str, plain: str) -> None:
    drawn = []
    for path in (
        f'<path transform="translate(5 20)" stroke="black" fill="none" d="M0 0{data}"/>' for data in (smooth, plain)
    ):
        (tmp_path / "drawing.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {SHEET}>{path}</svg>')
        (stroke,) = read_drawing(tmp_path / "drawing.svg").painting.strokes
        drawn.append([*strokes(path), 1e3 * np.array(stroke.trajectory)[:, :2]])
    for ours, theirs in zip(*drawn, strict=True):
        apart = cdist(ours, theirs)
        assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 0.5


def test_a_circle_is_within_ten_micrometres_of_itself() -> None:
    (stroke,) = strokes('<circle cx="50" cy="25" r="20"/>')
    assert np.linalg.norm(stroke - [50, 25], axis=1) == pytest.approx(20, abs=0.01)
    middles = (stroke[1:] + stroke[:-1]) / 2
    assert np.linalg.norm(middles - [50, 25], axis=1) == pytest.approx(20, abs=0.01)
    assert stroke[-1].tolist() == stroke[0].tolist()


def test_transforms_of_groups_and_shapes_are_applied() -> None:
    body = '<g transform="translate(10 20)"><g transform="scale(2)"><path transform="rotate(90)" d="M0 0L3 0"/></g></g>'
    assert ends(body) == [[[10, 20], [10, 26]]]


@pytest.mark.parametrize(
    "shape",
    [
        '<rect x="20" y="10" width="30" height="10"/>',
        '<rect x="20" y="10" width="30" height="10" rx="3"/>',
        '<circle cx="40" cy="20" r="10"/>',
        '<ellipse cx="40" cy="20" rx="10" ry="5"/>',
        '<path d="M20 10A9 5 30 0 1 40 20"/>',
        '<line x1="20" y1="10" x2="40" y2="30"/>',
    ],
)
@pytest.mark.parametrize(
    "transform",
    ["rotate(30)", "skewX(20)", "scale(-1 1) translate(-90)", "scale(1 .5) rotate(40)", "matrix(1 .2 -.3 1 9 2)"],
)
def test_every_shape_is_moved_as_its_points_are(shape: str, transform: str) -> None:
    (still,), (moved,) = strokes(shape), strokes(f'<g transform="{transform}">{shape}</g>')
    m = Matrix(transform)
    there = still @ [[m.a, m.b], [m.c, m.d]] + [m.e, m.f]
    apart = cdist(moved, there)
    assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 0.5
    assert moved[[0, -1]] == pytest.approx(there[[0, -1]], abs=1e-5)


def test_what_is_used_is_drawn_where_it_is_used_and_nowhere_else() -> None:
    defined = '<defs><path id="a" d="M0 0L1 1"/></defs><symbol id="b"><path d="M0 0L2 0"/></symbol>'
    assert ends(defined + '<use href="#a" x="5"/><use xlink:href="#b" y="7"/>') == [[[5, 0], [6, 1]], [[0, 7], [2, 7]]]


@pytest.mark.parametrize("name", ["defs", "symbol", "clipPath", "mask", "marker", "pattern"])
def test_what_is_only_referred_to_is_no_stroke(name: str) -> None:
    assert ends(f'<{name} id="a"><path d="M0 0L9 9"/></{name}><path d="M0 0L1 1"/>') == [[[0, 0], [1, 1]]]


def test_what_is_not_displayed_is_no_stroke() -> None:
    body = '<g style="display:none"><path d="M0 0L9 9"/></g><path display="none" d="M0 0L8 8"/><path d="M0 0L1 1"/>'
    assert ends(body) == [[[0, 0], [1, 1]]]


@pytest.mark.parametrize(
    "hidden", ['visibility="hidden"', 'style="visibility: hidden"', 'visibility="collapse"', 'visibility="HIDDEN"']
)
def test_what_is_hidden_is_no_stroke_but_what_shows_in_a_hidden_group_is(hidden: str) -> None:
    body = f'<g {hidden}><path d="M0 0L9 9"/><path visibility="visible" d="M0 0L1 1"/></g><path {hidden} d="M0 0L8 8"/>'
    assert ends(body) == [[[0, 0], [1, 1]]]


@pytest.mark.parametrize(
    ("root", "end"),
    [
        ('width="5in" height="5in" viewBox="0 0 50 50"', [2.54, 5.08]),
        ('width="10cm" height="10cm" viewBox="0 0 1000 1000"', [0.1, 0.2]),
        ('width="72pt" height="6pc"', [25.4 / 96, 25.4 / 48]),
        ('width="96" height="96px"', [25.4 / 96, 25.4 / 48]),
        ('width="100mm" height="50mm" viewBox="-1 -2 100 50"', [2, 4]),
    ],
)
def test_lengths_are_as_the_document_says(root: str, end: list[float]) -> None:
    assert strokes('<path d="M0 0L1 2"/>', root)[0][-1] == pytest.approx(end, abs=1e-5)


def test_the_page_is_the_sheet() -> None:
    page = svg('<path d="M0 0L1 2"/>')
    assert page.size is not None
    assert page.unit is not None
    assert np.array(page.size) * page.unit == pytest.approx([0.1, 0.05])


@pytest.mark.parametrize(
    "root", ["", 'width="100%" height="100%" viewBox="0 0 9 9"', 'viewBox="0 0 9 9"', 'width="9mm"']
)
def test_without_lengths_the_unit_and_the_page_are_unknown(root: str) -> None:
    page = svg('<path d="M0 0L1 2"/>', root)
    assert (page.unit, page.size) == (None, None)


def test_a_path_is_drawn_as_far_as_it_can_be_read() -> None:
    assert ends('<path d="M0 0L1 1 foo L9 9"/>') == [[[0, 0], [1, 1]]]


def test_a_drawing_without_paths_is_refused_with_the_remedy() -> None:
    for body in ("", "<text>cat</text>", '<image href="cat.png" width="9" height="9"/>', '<path d="M1 1"/>'):
        with pytest.raises(InputError, match="there is no path or shape in it; convert text and objects to paths in"):
            svg(body)


@pytest.mark.parametrize("root", [SHEET, 'viewBox="0 0 100 50"', 'width="100" height="50"'])
def test_a_rectangle_that_is_the_pages_paper_is_no_stroke(root: str) -> None:
    line, paper = '<path d="M3 4L60 4"/>', '<rect width="{}" height="50" fill="white" {}/>'
    for covers in (paper.format("100%", ""), paper.format("100", 'stroke="none"'), paper.format("120", "")):
        assert len(svg(covers + line, root).strokes) == 1
    for drawn in (paper.format("90", ""), paper.format("100", 'stroke="black"')):
        assert len(svg(drawn + line, root).strokes) == 2
    with pytest.raises(InputError, match="there is nothing but the page's paper in it; convert text and objects to"):
        svg(paper.format("100", ""), root)


def test_rules_for_the_outermost_element_count_for_what_is_in_it() -> None:
    frame, root = '<rect width="100" height="50"/>', f'{SHEET} id="page" class="a"'
    for selector in ("svg", ".a", "#page", "svg.a"):
        assert len(svg(f"<style>{selector} {{ stroke: black }}</style>{frame}", root).strokes) == 1
        for rule in ("visibility: hidden", "display: none"):
            with pytest.raises(InputError, match="there is no path or shape in it"):
                svg(f"<style>{selector} {{ {rule} }}</style>{frame}", root)


def test_where_no_page_is_stated_no_rectangle_is_its_paper() -> None:
    assert len(svg('<rect width="2000" height="2000" fill="white"/>', "").strokes) == 1


def test_a_dot_is_a_stroke_of_one_point() -> None:
    assert [stroke.tolist() for stroke in strokes('<path d="M3 4L3 4"/>')] == [[[3, 4]]]


def test_entities_are_refused() -> None:
    for entity in ('"M0 0"', 'SYSTEM "file:///etc/hostname"'):
        with pytest.raises(EntitiesForbidden):
            read_svg(f"<!DOCTYPE svg [<!ENTITY a {entity}>]><svg>&a;</svg>".encode())


def test_a_use_that_repeats_itself_without_end_is_refused() -> None:
    with pytest.raises(InputError, match="a <use> in it uses itself; take that out"):
        svg('<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/></g>')


def test_uses_that_multiply_are_refused_before_they_are_drawn() -> None:
    doubling = "".join(f'<g id="a{i}"><use href="#a{i - 1}"/><use href="#a{i - 1}"/></g>' for i in range(1, 60))
    with pytest.raises(InputError, match="its shapes come to over 12 MiB, counting every <use> of them; split it"):
        svg(f'<path id="a0" d="M0 0L1 1"/>{doubling}')


LINE = '<path d="M10 10H20"/>'


@pytest.mark.parametrize(
    ("style", "expected"),
    [
        ("translate: 5px 1px", [[15, 11], [25, 11]]),
        ("scale: 2", [[20, 20], [40, 20]]),
        ("rotate: 90deg; transform-origin: 10px 10px", [[10, 10], [10, 20]]),
        ("transform: scale(2); transform-origin: 10px 0", [[10, 20], [30, 20]]),
        ("transform: translate(1px, 2px); translate: 10%", [[21, 12], [31, 12]]),
        ("transform: translate(1em, 2px)", [[26, 12], [36, 12]]),
        ("translate: 5px; display: none", None),
    ],
)
@pytest.mark.parametrize("is_ruled", [True, False])
def test_elements_are_moved_and_hidden_by_their_styles_as_in_drawings(
    tmp_path: Path, style: str, expected: list[list[float]] | None, is_ruled: bool
) -> None:
    ruled = f'<style>g.a > g {{ {style} }}</style><g class="a"><g>{LINE}</g></g>'
    body = (ruled if is_ruled else f'<g style="{style}">{LINE}</g>') + '<path d="M0 0H1"/>'
    (tmp_path / "drawing.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {SHEET}>{body}</svg>')
    drawn = read_drawing(tmp_path / "drawing.svg", DrawingOptions(keep_order=True)).painting.strokes
    seen = [np.round(1e3 * np.array(stroke.trajectory)[[0, -1], :2], 3).tolist() for stroke in drawn]
    assert ends(body) == seen == [*([] if expected is None else [expected]), [[0, 0], [1, 0]]]


def test_percentages_of_moves_are_of_the_viewport_that_an_element_lies_in() -> None:
    inner = f'<svg width="50" height="50" viewBox="0 0 100 100"><g style="translate: 10% 20%">{LINE}</g></svg>'
    symbol = f'<symbol id="s" viewBox="0 0 40 40"><g style="translate: 50%">{LINE}</g></symbol>'
    assert ends(inner) == [[[10, 15], [15, 15]]]
    assert ends(f'{symbol}<use xlink:href="#s" width="40" height="40"/>') == [[[30, 10], [40, 10]]]


@pytest.mark.parametrize(
    ("symbol", "use"),
    [
        ('viewBox="0 0 40 40"', ""),
        ('viewBox="0 0 40 40"', 'x="5" y="10%" width="20" height="1em"'),
        ('viewBox="10 5 40 40" x="3" y="2" width="30" height="30"', 'transform="rotate(10)" x="7"'),
        ('viewBox="10 5 40 40" width="30" height="30"', 'style="translate: 5px" height="10"'),
        ('viewBox="0 0 40 40" preserveAspectRatio="none"', 'width="20" height="10"'),
        ('x="3" y="2"', 'x="7"'),
        ('viewBox="0 0 40 40"', 'width="0"'),
        ('viewBox="0 0 0 40"', 'x="4"'),
    ],
)
def test_a_symbol_is_drawn_where_and_as_large_as_in_drawings(tmp_path: Path, symbol: str, use: str) -> None:
    whole = 'overflow="visible"'  # drawings end at its edges
    body = f'<symbol id="s" {whole} {symbol}>{LINE}</symbol><use href="#s" {use}/><path d="M0 0H1"/>'
    (tmp_path / "drawing.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {SHEET}>{body}</svg>')
    drawn = read_drawing(tmp_path / "drawing.svg", DrawingOptions(keep_order=True)).painting.strokes
    seen = [np.round(1e3 * np.array(stroke.trajectory)[[0, -1], :2], 3).tolist() for stroke in drawn]
    assert np.round(ends(body), 3).tolist() == seen
    assert len(seen) == (1 if use == 'width="0"' else 2)


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ('<line x1="1em" y1="1rem" x2="2em" y2="2ex"/>', [[16, 16], [32, 16]]),
        ('<line x1="10%" y1="10%" x2="50%" y2="10%"/>', [[10, 5], [50, 5]]),
        ('<line x1="10" y1="what" x2="20"/>', [[10, 0], [20, 0]]),
        ('<use href="#line" x="1em"/>', [[26, 10], [36, 10]]),
        (f'<g transform="translate(1em,2)">{LINE}</g>', [[26, 12], [36, 12]]),
        ('<svg x="10%" y="3" width="50" height="20"><use href="#line"/></svg>', [[20, 13], [30, 13]]),
        ('<svg x="7" y="3" width="50" height="20"><line x2="10%" y2="10%"/></svg>', [[7, 3], [12, 5]]),
        ('<svg x="7" y="3"><line x2="10%" y2="10%"/></svg>', [[7, 3], [17, 8]]),
        ('<svg width="9" height="9" viewBox="0 0 9 9"/><line x2="10%" y2="10%"/>', [[0, 0], [10, 5]]),
        (
            '<svg width="0" height="9" viewBox="0 0 9 9"><path d="M0 0H1"/></svg><use href="#line"/>',
            [[10, 10], [20, 10]],
        ),
        (f'<g transform="rotate(90)"><g style="transform: translate(8px, 2%)">{LINE}</g></g>', [[-11, 18], [-11, 28]]),
    ],
)
def test_places_are_those_that_a_browser_takes(body: str, expected: list[list[float]]) -> None:
    assert ends(f'<defs><path id="line" d="M10 10H20"/></defs>{body}') == [expected]


@pytest.mark.parametrize("radii", ['ry="5"', 'rx="5"', 'rx="auto" ry="5"', 'rx="-1" ry="10%"'])
def test_a_radius_that_is_left_out_is_the_other(radii: str) -> None:
    (ellipse,) = strokes(f'<ellipse cx="20" cy="20" {radii}/>')
    assert np.linalg.norm(ellipse - [20, 20], axis=1) == pytest.approx(5, abs=0.01)
    (rect,) = strokes(f'<rect width="10" height="10" {radii}/>')
    assert np.linalg.norm(rect - [5, 5], axis=1) == pytest.approx(5, abs=0.01)


@pytest.mark.parametrize("shape", ['circle r="-3"', 'rect width="-5" height="9"', 'rect width="5"', 'ellipse cx="9"'])
def test_what_has_no_size_is_not_drawn(shape: str) -> None:
    assert ends(f"<{shape}/>{LINE}") == ends(LINE)


def test_a_rectangle_takes_no_place_and_no_size_of_what_it_lies_in() -> None:
    (drawn,) = strokes('<svg x="10" y="20" width="30" height="20"><rect width="5" height="4"/><rect height="4"/></svg>')
    assert drawn[:3].tolist() == [[10, 20], [15, 20], [15, 24]]


@pytest.mark.parametrize(
    ("root", "size"),
    [
        ('width="10em" height="5em"', (160, 80)),
        ('width="10 mm" height="1e1mm"', (9600 / 254, 9600 / 254)),
        ('width="auto" height="auto"', None),
        ('width="what" height="9"', None),
    ],
)
def test_sides_of_the_page_are_in_any_unit_or_unknown(root: str, size: tuple[float, float] | None) -> None:
    page = svg(LINE, f'{root} viewBox="0 0 100 50"')
    assert (page.unit is None) == (size is None)
    assert page.size == (None if size is None else pytest.approx(size))


@pytest.mark.parametrize("root", ["", 'width="100%" height="100%"'])
def test_percentages_of_moves_on_a_page_without_a_size_are_of_a_thousand_pixels_as_those_of_shapes(root: str) -> None:
    body = f'<g style="translate: 10% 20%">{LINE}</g><line x1="10%" y1="20%" x2="20%" y2="20%"/>'
    moved, line = (stroke[[0, -1], 1:3].tolist() for stroke in svg(body, root).strokes)
    assert moved == [[110, 210], [120, 210]]
    assert line == [[100, 200], [200, 200]]


def test_another_kind_of_document_is_refused() -> None:
    with pytest.raises(InputError, match="its outermost element is <html>; it must be <svg>"):
        read_svg(b"<html/>")


def test_what_maulstick_draws_it_reads_again() -> None:
    painting = a_painting([Stroke(id=i, paint=i, trajectory=CURVE) for i in range(2)])
    page = read_svg(painting_svg(painting).encode())
    assert page.unit is not None
    for stroke, drawn in zip(page.strokes, refined(painting).trajectories(), strict=True):
        assert page.unit * stroke[:, 1:3] == pytest.approx(drawn[:, :2], abs=1e-6)
