import numpy as np
import pytest

from maulstick.drawing.read import Drawing
from maulstick.errors import InputError
from tests.drawing.conftest import PAGE, Read, millimetres, points

LINE = '<path d="M1 2L3 4"/>'


@pytest.mark.parametrize(
    ("page", "scale"),
    [
        ('width="100mm" height="50mm" viewBox="0 0 100 50"', 1),
        ('width="10cm" height="5cm" viewBox="0 0 100 50"', 1),
        ('width="4in" height="2in" viewBox="0 0 100 50"', 1.016),
        ('width="288pt" height="144pt" viewBox="0 0 100 50"', 1.016),
        ('width="24pc" height="12pc" viewBox="0 0 100 50"', 1.016),
        ('width="384px" height="192px" viewBox="0 0 100 50"', 1.016),
        ('width="384" height="192" viewBox="0 0 100 50"', 1.016),
        ('width="384"  viewBox="0 0 100 50"', 1.016),
        ('width="100%" height="100%" viewBox="0 0 100 50"', 25.4 / 96),
        ('viewBox="0 0 100 50"', 25.4 / 96),
        ('width="300" height="200"', 25.4 / 96),
        ("", 25.4 / 96),
    ],
)
def test_a_page_has_its_own_units(read: Read, page: str, scale: float) -> None:
    (line,) = millimetres(read(LINE, page))
    assert line == pytest.approx(scale * np.array([[1, 2], [3, 4]]), abs=1e-3)


def test_a_page_that_says_no_size_is_said_to_have_none(read: Read) -> None:
    assert read(LINE).notes == ()
    (note,) = read(LINE, "").notes
    assert note == "the file does not say how large its page is; it is drawn on 264.583 x 264.583 mm"


def test_a_viewbox_of_another_shape_is_centred_as_its_aspect_says(read: Read) -> None:
    square = 'width="100mm" height="50mm" viewBox="10 10 10 10" '
    line = '<path d="M10 10L20 20"/>'
    assert points(read(line, square)) == [[[25, 0], [75, 50]]]
    assert points(read(line, square + 'preserveAspectRatio="xMinYMin"')) == [[[0, 0], [50, 50]]]
    assert points(read(line, square + 'preserveAspectRatio="none"')) == [[[0, 0], [100, 50]]]


def test_shapes_take_units_and_percentages_of_the_outer_viewport(read: Read) -> None:
    body = '<line x1="10%" y1="10%" x2="1cm" y2="96px"/>'
    unit = 96 / 25.4  # a user unit is a millimetre, so a centimetre of CSS is as many units as pixels
    assert points(read(body, 'width="1000mm" height="500mm" viewBox="0 0 1000 500"')) == [
        [[100, 50], [round(10 * unit, 2), 96]]
    ]
    (circle,) = millimetres(read('<circle cx="50%" cy="50%" r="10%"/>'))
    assert np.hypot(*(circle - [50, 25]).T) == pytest.approx(np.hypot(100, 50) / 2**0.5 / 10, abs=0.02)


def test_a_percentage_after_a_nested_svg_is_again_of_the_outer_one(read: Read) -> None:
    body = (
        '<svg x="10" y="10" width="20" height="20" viewBox="0 0 2 2"><line x2="50%" y2="50%"/></svg>'
        '<line x2="50%" y2="50%"/>'
    )
    assert points(read(body)) == [[[10, 10], [20, 20]], [[0, 0], [50, 25]]]


def test_what_lies_outside_a_nested_svg_is_cut_unless_it_overflows(read: Read) -> None:
    nested = '<svg x="10" y="10" width="20" height="20" {}><line x1="-5" x2="50" y1="5" y2="5"/></svg>'
    assert points(read(nested.format(""))) == [[[10, 15], [30, 15]]]
    assert points(read(nested.format('overflow="visible"'))) == [[[5, 15], [60, 15]]]


NESTED = '<svg id="s" x="10" y="5" width="20" height="20" viewBox="0 0 10 10" {}><path d="M1 2L6 2"/></svg>'
HALF = '<clipPath id="c"><rect width="4" height="9"/></clipPath>'


def test_a_nested_svg_is_clipped_in_its_own_units(read: Read) -> None:
    assert points(read(HALF + NESTED.format('clip-path="url(#c)"'))) == [[[12, 9], [18, 9]]]
    of_box = HALF.replace("<clipPath", '<clipPath clipPathUnits="objectBoundingBox"').replace('width="4"', 'width=".4"')
    assert points(read(of_box + NESTED.format('clip-path="url(#c)"').replace("6 2", "6 3")))[0][1] == [16, 9.8]


@pytest.mark.parametrize("tag", ["svg", "symbol"])
def test_a_viewport_that_is_used_keeps_its_place_its_transform_and_its_clip(read: Read, tag: str) -> None:
    def used(attributes: str) -> list[list[list[float]]]:
        nested = NESTED.format(attributes).replace("svg", tag)
        return points(read(f'{HALF}<defs>{nested}</defs><use href="#s" x="30" width="40" height="40"/>'))

    assert used("") == [[[44, 13], [64, 13]]]
    assert used('transform="translate(0 10)"') == [[[44, 23], [64, 23]]]
    assert used('clip-path="url(#c)"') == [[[44, 13], [56, 13]]]


def test_a_length_that_is_none_counts_as_left_out(read: Read) -> None:
    assert points(read('<svg x="a lot" width="auto" height="">' + LINE + "</svg>")) == [[[1, 2], [3, 4]]]


def test_nested_transforms_apply_from_the_inside_out(read: Read) -> None:
    body = (
        '<g transform="translate(50 10)"><g transform="rotate(90)"><g transform="scale(2) skewX(45)">'
        '<path transform="matrix(1 0 0 1 1 0)" d="M0 0L3 1"/></g></g></g>'
    )
    # (0, 0) -> (1, 0) -> skewed (1, 0) -> (2, 0) -> turned (0, 2); (3, 1) -> (4, 1) -> (5, 1) -> (10, 2) -> (-2, 10)
    assert points(read(body)) == [[[50, 12], [48, 20]]]


@pytest.mark.parametrize(
    ("origin", "expected"),
    [
        ("", [[20, 5], [25, 5]]),
        ('transform-origin=" "', [[20, 5], [25, 5]]),
        ('transform-origin="oops"', [[20, 5], [25, 5]]),
        ('transform-origin="50 20"', [[45, 15], [50, 15]]),
        ('style="transform:scale(.5);transform-origin:50px 20px"', [[45, 15], [50, 15]]),
        ('transform-origin="50% 20 0"', [[45, 15], [50, 15]]),
        ('transform-origin="center"', [[45, 17.5], [50, 17.5]]),
        ('transform-origin="bottom right"', [[70, 30], [75, 30]]),
        ('transform-origin="top"', [[45, 5], [50, 5]]),
    ],
)
def test_a_transform_has_an_origin(read: Read, origin: str, expected: list[list[float]]) -> None:
    assert points(read(f'<path d="M40 10H50" transform="scale(.5)" {origin}/>')) == [expected]


def test_an_origin_in_the_box_of_a_shape_is_said_to_be_passed_over(read: Read) -> None:
    turned = read('<path d="M40 10H50" transform="scale(.5)" style="transform-origin:center;transform-box:fill-box"/>')
    assert turned.notes == ("passed over: transform-box",)


def test_what_is_used_lies_where_it_is_used_and_what_is_only_defined_nowhere(read: Read) -> None:
    body = (
        '<defs><g id="a"><path d="M0 0L1 0"/><path d="M0 1L1 1"/></g></defs>'
        '<symbol id="b" viewBox="0 0 10 10"><path d="M0 0L10 10"/></symbol>'
        '<use xlink:href="#a" x="5" y="5" transform="scale(2)"/>'
        '<use href="#b" x="40" y="10" width="20" height="20"/>'
    )
    expected = [[[10, 10], [12, 10]], [[10, 12], [12, 12]], [[40, 10], [60, 30]]]
    assert points(read(body)) == expected


def test_of_elements_with_one_id_the_first_is_used(read: Read) -> None:
    body = '<defs><path id="a" d="M0 0h9"/><path id="a" d="M0 0v9"/></defs><use href="#a"/>'
    assert points(read(body)) == [[[0, 0], [9, 0]]]


def test_hidden_elements_are_left_out_by_attribute_style_and_style_sheet(read: Read) -> None:
    body = (
        "<style>/* x */ .off, text { display: none } #gone{visibility:hidden}</style>"
        f'<g display="none">{LINE}</g><g style="display:none">{LINE}</g><g class="no off">{LINE}</g>'
        f'<g id="gone">{LINE}<path style="visibility:visible" d="M9 9L8 8"/></g><text>left out</text>'
    )
    assert points(read(body)) == [[[9, 9], [8, 8]]]


def test_what_is_wholly_transparent_is_left_out_but_clips(read: Read) -> None:
    clip = '<clipPath id="c"><rect opacity="0" width="2" height="9"/></clipPath>'
    gone = f'<path opacity="0" d="M9 9h9"/><g style="opacity:0%"><text>left out</text>{LINE}</g>'
    symbol = f'<symbol id="s" opacity="0">{LINE}</symbol><use href="#s"/>'
    assert points(read(f'{clip}{gone}{symbol}<path opacity=".1" clip-path="url(#c)" d="M0 1h9"/>')) == [
        [[0, 1], [2, 1]]
    ]


@pytest.mark.parametrize("scale", ["0", "0 1", "2 0"])
def test_what_is_scaled_to_nothing_is_left_out(read: Read, scale: str) -> None:
    assert points(read(f'<g transform="scale({scale})"><path d="M8 8h9"/></g>{LINE}')) == [[[1, 2], [3, 4]]]


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        ('<rect x="1" y="2" width="3" height="4"/>', [[1, 2], [4, 2], [4, 6], [1, 6], [1, 2]]),
        ('<polygon points="1,2 3e0 4 5+6 7"/>', [[1, 2], [3, 4], [5, 6], [1, 2]]),
        ('<polyline points="1,2 3,4 5 6 7"/>', [[1, 2], [3, 4], [5, 6]]),
        ('<path d="M1 1H5V5z"/>', [[1, 1], [5, 1], [5, 5], [1, 1]]),
        ('<path d="m1 1h4v4zl9 9"/>', [[1, 1], [5, 1], [5, 5], [1, 1], [10, 10]]),
        ('<path d="M1 1 A 0 5 0 0 0 9 9"/>', [[1, 1], [9, 9]]),
    ],
)
def test_shapes_of_straight_lines_keep_their_points(read: Read, shape: str, expected: list[list[float]]) -> None:
    assert points(read(shape)) == [expected]


@pytest.mark.parametrize(
    ("shape", "centre", "radii"),
    [
        ('<circle cx="50" cy="25" r="24"/>', (50, 25), (24, 24)),
        ('<ellipse cx="50" cy="25" rx="40" ry="5"/>', (50, 25), (40, 5)),
        ('<path d="M26 25a24 24 0 1 1 0 .0001z"/>', (50, 25), (24, 24)),
    ],
)
def test_arcs_are_flattened_to_two_hundredths_of_a_millimetre(
    read: Read, shape: str, centre: tuple[float, float], radii: tuple[float, float]
) -> None:
    (line,) = millimetres(read(shape))
    middles = (line[1:] + line[:-1]) / 2
    unit = (np.concatenate([line, middles]) - centre) / radii
    assert np.abs(np.hypot(*unit.T) - 1).max() * min(radii) < 0.02
    assert len(line) < 300


def test_a_rounded_rectangle_has_round_corners_where_only_one_radius_is_given(read: Read) -> None:
    (line,) = millimetres(read('<rect x="10" y="10" width="40" height="20" ry="5"/>'))
    corner = line[(line[:, 0] < 15) & (line[:, 1] < 15)]
    assert np.hypot(*(corner - 15).T) == pytest.approx(5, abs=0.02)


def test_an_ellipse_without_a_radius_is_none_and_one_that_names_one_is_a_circle(read: Read) -> None:
    assert len(read('<ellipse cx="50" cy="25" rx="0" ry="9"/>' + LINE).painting.strokes) == 1
    (circle,) = millimetres(read('<ellipse cx="50" cy="25" ry="9"/>'))
    assert np.hypot(*(circle - [50, 25]).T) == pytest.approx(9, abs=0.02)


def test_a_curve_is_drawn_as_finely_on_a_large_sheet_as_on_a_small_one(read: Read) -> None:
    circle = '<circle cx="50" cy="25" r="20"/>'
    small, large = (len(millimetres(read(circle, size=size))[0]) for size in ((0.1, 0.05), (1.6, 0.8)))
    assert large / small == pytest.approx(4, rel=0.1)


@pytest.mark.parametrize("rest", ["L oops", "x 9 9", "; L 9 9", "L Infinity 9", "L 9"])
def test_faulty_path_data_is_drawn_up_to_the_fault_and_said(read: Read, rest: str) -> None:
    drawing = read(f'<path d="M1 1L2 2{rest}"/><path d="none"/>')
    assert points(drawing) == [[[1, 1], [2, 2]]]
    assert drawing.notes == ("paths with faulty data are drawn up to the fault: 1",)


@pytest.mark.parametrize(
    ("given", "drawn"),
    [
        ("nan,5 10,10 20,20 30,10", []),
        ("1,2 3,4 5,oops 7,8", [[1, 2], [3, 4]]),
        ("1,2,,3,4", []),
        ("1,2 3,4 5", [[1, 2], [3, 4]]),
    ],
)
def test_faulty_points_are_drawn_up_to_the_fault_and_said(read: Read, given: str, drawn: list[list[float]]) -> None:
    drawing = read(f'{LINE}<polyline points="{given}"/><polygon points="{given}"/>')
    polygon = [*drawn, *drawn[:1]]
    assert points(drawing) == [[[1, 2], [3, 4]], *([drawn, polygon] if drawn else [])]
    assert drawing.notes == ("paths with faulty data are drawn up to the fault: 2",)


def test_points_may_be_parted_in_any_way_that_svg_knows(read: Read) -> None:
    drawing = read('<polyline points="&#10; 1 , 12+.5.25,&#9;3e0+4 "/>')
    assert drawing.notes == ()
    assert points(drawing) == [[[1, 12], [0.5, 0.25], [3, 4]]]


def test_only_the_first_way_of_a_switch_that_a_pen_can_draw_is_drawn(read: Read) -> None:
    html = '<foreignObject><p xmlns="http://www.w3.org/1999/xhtml">words</p></foreignObject>'
    assert points(read(f'<switch>{html}{LINE}<path d="M0 0L9 9"/></switch>')) == [[[1, 2], [3, 4]]]


@pytest.mark.parametrize(
    ("body", "fault"),
    [
        ('<text id="title">words</text>', "it has text ('title'); a pen draws paths: make them in Inkscape by"),
        ('<flowRoot id="title"><flowPara>words</flowPara></flowRoot>', "it has text ('title'); a pen draws paths"),
        ('<image href="a.png"/>', "it has a picture; a pen draws paths: trace it in Inkscape by"),
        ('<use href="other.svg#a"/>', "it uses 'other.svg#a' of another file; copy that into the drawing"),
        ('<g id="a"><use href="#a"/></g>', "a <use> in it uses itself"),
        ('<path d="M0 0L1e300 5"/>', "a point in it has no place"),
        ("", "there is no path or shape in it that can be seen"),
        ('<path d="M200 0L300 5"/>', "nothing of it lies on its sheet of 100 x 50 mm; margin 0 scales it"),
        ("<g>" * 150 + LINE + "</g>" * 150, "its groups and uses lie more than 100 deep"),
        ("<g>" * 9000 + LINE + "</g>" * 9000, "it is nested too deeply, or refers to itself"),
        ('<clipPath id="c" clip-path="url(#c)"><path d="M0 0h9v9z"/></clipPath><g clip-path="url(#c)">' + LINE + "</g>",
         "the clip 'c' in it clips itself"),
    ],
)  # fmt: skip
def test_what_a_pen_cannot_draw_is_refused_in_a_sentence(read: Read, body: str, fault: str) -> None:
    with pytest.raises(InputError, match=r"^cannot draw .*drawing\.svg: ") as refused:
        read(body)
    assert fault in str(refused.value)
    assert "\n" not in str(refused.value)


def test_uses_that_multiply_are_refused_before_they_fill_the_memory(read: Read) -> None:
    layers = [f'<g id="g{i + 1}">{f"""<use href="#g{i}"/>""" * 10}</g>' for i in range(9)]
    with pytest.raises(InputError, match="its shapes come to over 64 MiB, counting every <use> of them"):
        read(f'<defs><g id="g0">{LINE}</g>{"".join(layers)}</defs><use href="#g9"/>')


BOX = '<rect x="20" y="30" width="40" height="10" fill="none" stroke="black"/>'


def box_of(drawing: Drawing) -> list[float]:
    """Left, top, width and height of a drawing's strokes, millimetres."""
    reached = np.concatenate(millimetres(drawing))
    low = reached.min(axis=0)
    return [*low.tolist(), *(reached.max(axis=0) - low).tolist()]


@pytest.mark.parametrize(
    ("style", "expected"),
    [
        ("rotate: 90deg; transform-origin: 50px 40px", [50, 10, 10, 40]),
        ("rotate: -.25turn; transform-origin: 50px 20px", [60, 10, 10, 40]),
        ("rotate: Z 100GRAD; transform-origin: 50px 40px", [50, 10, 10, 40]),
        ("rotate: 90deg z; transform-origin: 50px 40px", [50, 10, 10, 40]),
        ("rotate: 0 0 1 90deg; transform-origin: 50px 40px", [50, 10, 10, 40]),
        ("rotate: 90deg 0  0 1; transform-origin: 50px 40px", [50, 10, 10, 40]),
        ("rotate: z 90deg z", [20, 30, 40, 10]),
        ("rotate: 90", [20, 30, 40, 10]),
        ("scale: 1.5 50%", [30, 15, 60, 5]),
        ("scale: 50%", [10, 15, 20, 5]),
        ("scale: 2px", [20, 30, 40, 10]),
        ("translate: 10px 5px", [30, 35, 40, 10]),
        ("translate: 10%", [30, 30, 40, 10]),
        ("translate: 10 5", [20, 30, 40, 10]),
        ("translate: 1E1 5px", [20, 30, 40, 10]),
        ("translate: none; rotate: none; scale: none", [20, 30, 40, 10]),
        ("transform: translate(-20px, -30px); scale: 1 2; translate: 3px", [3, 0, 40, 20]),
    ],
)
def test_an_element_is_moved_by_the_properties_for_each_kind_of_move_as_in_a_browser(
    read: Read, style: str, expected: list[float]
) -> None:
    assert box_of(read(f'<g style="{style}">{BOX}</g>')) == pytest.approx(expected, abs=1e-3)
    ruled = f"<style>g {{ {style} }}</style><g>{BOX}</g>"
    assert box_of(read(ruled)) == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize(
    ("outer", "expected"),
    [
        ("translate: 10px 5px", [40, 40, 40, 10]),
        ("translate: 5px -10px; scale: .5", [17.5, 0, 20, 5]),
        ("", [20, 30, 40, 10]),
    ],
)
def test_a_move_that_is_inherited_is_the_parents_own_and_made_twice(
    read: Read, outer: str, expected: list[float]
) -> None:
    inner = BOX.replace("/>", ' style="translate: inherit; scale: unset"/>')
    assert box_of(read(f'<g style="{outer}">{inner}</g>')) == pytest.approx(expected, abs=1e-3)


def test_there_are_no_attributes_of_these_names(read: Read) -> None:
    assert box_of(read(f'<g translate="10 5" rotate="40" scale="2">{BOX}</g>')) == pytest.approx([20, 30, 40, 10])


@pytest.mark.parametrize(
    ("page", "expected"),
    [
        ('transform="translate(10 5)"', [22.6458, 31.3229, 40, 10]),  # in pixels, after the viewBox
        ('transform="rotate(180)"', [40, 10, 40, 10]),
        ('style="rotate: 180deg"', [40, 10, 40, 10]),
        ('transform="scale(.5)" transform-origin="0 0"', [10, 15, 20, 5]),
    ],
)
def test_the_whole_drawing_is_moved_about_the_middle_of_its_page_as_in_a_browser(
    read: Read, page: str, expected: list[float]
) -> None:
    assert box_of(read(BOX, f"{PAGE} {page}")) == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("hidden", ['display="NONE"', 'style="display: None"', 'style="visibility:HIDDEN"'])
def test_words_of_any_case_hide(read: Read, hidden: str) -> None:
    assert len(points(read(f'<g {hidden}>{BOX}</g><path d="M1 1h9" stroke="black"/>'))) == 1


def test_what_is_visible_again_is_drawn_in_any_case_and_as_at_first(read: Read) -> None:
    for visible in ("VISIBLE", "initial"):
        assert points(read(f'<g visibility="hidden"><g style="visibility:{visible}">{BOX}</g></g>'))


def test_a_quarter_of_a_millimetre_is_a_unit(read: Read) -> None:
    page = 'width="400Q" height="200q" viewBox="0 0 100 50"'
    assert box_of(read(BOX, page)) == pytest.approx([20, 30, 40, 10], abs=1e-3)
