from collections.abc import Callable
from pathlib import Path

import pytest
import vpype

from maulstick.drawing.options import DrawingOptions
from maulstick.drawing.pens import LayerName
from maulstick.drawing.read import read_drawing
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import write_painting
from maulstick.painting.svg import AXIDRAW_SPEED, axidraw_svg, painting_svg
from tests.drawing.conftest import Read, labels, points


def layer(label: str, body: str) -> str:
    return f'<g inkscape:groupmode="layer" inkscape:label="{label}">{body}</g>'


def path(x: float, colour: str = "black") -> str:
    return f'<path d="M{x} 1L{x} 9" fill="none" stroke="{colour}"/>'


@pytest.mark.parametrize(
    ("label", "expected"),
    [
        ("outlines", LayerName(name="outlines")),
        ("3 outlines", LayerName(number=3, name="outlines")),
        ("12", LayerName(number=12, name="12")),
        ("2+S50+D250 fine red", LayerName(number=2, speed=50, delay=0.25, name="fine red")),
        (" !5+h30 +s500 loud", LayerName(number=5, pauses=True, speed=100, height=True, name="loud")),
        ("+S0 slow", LayerName(speed=1, name="slow")),
        ("2 plus +S50", LayerName(number=2, name="plus +S50")),
        ("tab\tand\nline", LayerName(name="tab and line")),
        ("0.5 mm black", LayerName(number=0, name="0.5 mm black")),
        ("!2B", LayerName(number=2, pauses=True, name="2B")),
        ("9" * 5000, LayerName(number=999999999, name="9" * 5000)),
        (f"1+D{'9' * 400} slow", LayerName(number=1, delay=999999999 * 1e-3, name=f"{'9' * 391} slow")),
        ("", LayerName()),
        (None, LayerName()),
    ],
)
def test_a_layers_name_is_taken_apart_at_axidraws_codes(label: str | None, expected: LayerName) -> None:
    assert LayerName.of(label) == expected


def test_layers_are_pens_in_the_order_of_their_numbers(read: Read) -> None:
    body = (
        layer("10 last", path(1, "red"))
        + layer("sketch", path(2))
        + layer("2 first", f"<g>{path(3)}</g>" + layer("inner", path(4, "blue")) + path(5, "blue"))
    )
    drawing = read(body)
    assert labels(drawing) == ["first #0000ff", "last #ff0000", "sketch #000000"]
    assert [line[0][0] for line in points(drawing)] == [3, 4, 5, 1, 2]


def test_a_layer_that_begins_with_a_per_cent_sign_is_not_plotted_whatever_is_in_it(read: Read) -> None:
    drawing = read(layer("% notes", f"<text>words</text>{path(1)}") + layer("a", path(2)))
    assert labels(drawing) == ["a #000000"]


def test_a_layer_in_another_is_not_plotted_either_if_its_name_begins_so(read: Read) -> None:
    drawing = read(layer("a", path(1) + layer("%b", path(2)) + layer("c", path(3))))
    assert [line[0][0] for line in points(drawing)] == [1, 3]
    assert labels(drawing) == ["a #000000"]


def test_a_layers_speed_is_that_of_its_strokes(read: Read) -> None:
    strokes = read(layer("1+S50", path(1)) + layer("2", path(2))).painting.strokes
    assert strokes[0].speed == (AXIDRAW_SPEED / 2,) * 2
    assert strokes[1].speed is None


def test_what_codes_ask_for_that_is_not_done_is_said(read: Read) -> None:
    assert [note[:2] for note in read(layer("!1+H30", path(1)) + layer("2+D9", path(2))).notes] == ["+H", "+D"]
    assert read(layer("!1 alone", path(1))).notes == (
        "! in the name of a layer that is alone is passed over: there is no pen to change",
    )


def test_without_layers_groups_at_the_top_are_pens(read: Read) -> None:
    drawing = read(f'<g id="one">{path(1)}<g>{path(2, "red")}</g></g><g id="two">{path(3)}</g>{path(4)}')
    assert labels(drawing) == ["one #000000", "two #000000", "#000000"]


def test_groups_that_nobody_named_or_that_are_very_many_are_no_pens(read: Read) -> None:
    assert labels(read("".join(f"<g>{path(x)}</g>" for x in (1, 2, 3)))) == ["#000000"]
    assert labels(read("".join(f'<g id="g{x}">{path(x)}</g>' for x in range(50)))) == ["#000000"]


@pytest.mark.parametrize(
    "colour",
    [
        "#f00", "red", "rgb(255,0,0)", "RGB( 255 , 0, 0 )", "rgb(255 0 0)", "rgb(255 0 0 / 50%)", "rgb(254.9,0.2,0)",
        "rgb(100% 0% 0%)", "rgba(255,0,0,.5)", "hsl(0,100%,50%)", "hsl(0deg 100% 50%)", "#ff0000 icc-color(a,1)",
        "url(#gradient) rgb(255 0 0)", "hsl(1turn 100 50)", "hwb(0 0% 0%)", "rgb(255,/* red */0,0)", "rgb(300 -5 0)",
    ],
)  # fmt: skip
def test_a_colour_is_the_same_in_all_forms_that_programs_write(read: Read, colour: str) -> None:
    drawing = read(f'<path stroke="{colour}" d="M0 9h9"/>')
    assert (drawing.painting.paints[0].hex, drawing.notes) == ("#ff0000", ())


@pytest.mark.parametrize("colour", ["rgb(255 0 0 / 0%)", "rgba(255,0,0,0)", "#f000", "hsl(0 100% 50% / 0)"])
def test_a_colour_that_nobody_sees_is_none(read: Read, colour: str) -> None:
    assert read(f'<path stroke="{colour}" fill="blue" d="M0 9h9"/>').painting.paints[0].hex == "#0000ff"


@pytest.mark.parametrize("colour", ["#12", "#12345", "#gg0000", "rgb(1 2)", "hsl(red)", "var(--ink)", "lab(50 40 20)"])
def test_a_faulty_colour_is_named(read: Read, colour: str) -> None:
    assert f"the colour '{colour}' is taken for black" in read(f'<path stroke="{colour}" d="M0 9h9"/>').notes[0]
    unseen = read(f'<path stroke="#f00" fill="{colour}" fill-opacity="0" d="M0 9h9"/>')
    assert (unseen.painting.paints[0].hex, unseen.notes) == ("#ff0000", ())


def test_initial_colours_are_those_of_what_says_none(read: Read) -> None:
    initial = read('<g stroke="#f00"><path stroke="initial" fill="#00f" d="M0 9h9v9"/></g>')
    assert ([paint.hex for paint in initial.painting.paints], initial.notes) == (["#0000ff"], ())
    inherits = read('<g stroke="#f00"><path stroke="unset" d="M0 9h9"/></g>')
    assert (inherits.painting.paints[0].hex, inherits.notes) == ("#ff0000", ())


@pytest.mark.parametrize("colour", ["black", "#000", "rgb(0 0 0)", "url(#gradient)", "currentColor"])
def test_black_is_no_colour_that_is_not_known(read: Read, colour: str) -> None:
    drawing = read(f'<path stroke="{colour}" d="M0 9h9"/>')
    assert (drawing.painting.paints[0].hex, drawing.notes) == ("#000000", ())


def test_a_colour_of_a_form_that_is_not_read_is_black_and_a_note_names_it(read: Read) -> None:
    lines = ("stroke", "rebeccapurple"), ("stroke", "oklch(60% 0.2 30)"), ("fill", "lab(50% 40 20)")
    hidden = (
        '<clipPath id="c"><path fill="var(--hue)" d="M0 0h90v90z"/></clipPath><path clip-path="url(#c)" d="M0 5h9"/>'
    )
    assert read(hidden).notes == ()
    drawing = read("".join(f'<path {name}="{value}" d="M0 {9 * i}h9"/>' for i, (name, value) in enumerate(lines)))
    assert [paint.hex for paint in drawing.painting.paints] == ["#663399", "#000000"]
    assert drawing.notes == (
        "the colour 'oklch(60% 0.2 30)' is taken for black, as all are but #rrggbb, rgb(), hsl(), hwb() and names; "
        "write it as #rrggbb",
    )


def test_without_groups_colours_are_pens(read: Read) -> None:
    drawing = read(
        f'<g id="all">{path(1, "red")}{path(2)}{path(3, "#F00")}<rect width="9" height="9" fill="blue"/></g>'
    )
    assert labels(drawing) == ["#ff0000", "#000000", "#0000ff"]


def test_the_brush_is_as_wide_as_most_of_the_lines(read: Read) -> None:
    thin, wide = ('<path d="M1 1h{}" stroke="black" stroke-width="{}"/>'.format(*each) for each in ((5, 0.2), (9, 0.8)))
    (brush,) = read(thin + f'<g transform="scale(.5)">{wide}</g>' + thin).painting.brushes.values()
    assert (brush.name, brush.beta) == ("fineliner 0.2 mm", 1e-4)
    (usual,) = read('<path d="M1 1h9"/>').painting.brushes.values()
    assert usual.name == "fineliner"


@pytest.mark.parametrize("svg", [painting_svg, axidraw_svg])
def test_names_of_layers_stay_as_they_are_however_often_a_drawing_is_exported_and_read(
    read: Read, tmp_path: Path, svg: Callable[[Painting], str]
) -> None:
    painting = read(layer("1 bright ochre", path(1, "#d09a5a")) + layer("2", path(5, "#123456"))).painting
    assert [paint.name for paint in painting.paints] == ["bright ochre", "2"]
    ochre, blue = painting.paints
    painting = painting.model_copy(update={"paints": (ochre, blue.model_copy(update={"name": "my #123456 mix"}))})
    once = svg(painting)
    (tmp_path / "again.svg").write_text(once)
    assert svg(read_drawing(tmp_path / "again.svg", DrawingOptions(keep_order=True)).painting) == once


def test_names_of_layers_stay_as_they_are_where_vpype_passes_them_on(read: Read, tmp_path: Path) -> None:
    painting = read(layer("1 bright ochre", path(1, "#d09a5a")) + layer("2 #123456", path(5, "#123456"))).painting
    (tmp_path / "ours.svg").write_text(painting_svg(painting))
    document = vpype.read_multilayer_svg(str(tmp_path / "ours.svg"), quantization=0.1)
    with (tmp_path / "theirs.svg").open("w") as file:
        vpype.write_svg(file, document, source_string="vpype read ours.svg write theirs.svg\n")  # as its command does
    passed_on = read_drawing(tmp_path / "theirs.svg", DrawingOptions(keep_order=True)).painting
    assert [paint.name for paint in passed_on.paints] == [paint.name for paint in painting.paints]


def test_what_somebody_else_writes_after_a_layers_colour_stays_in_its_name(read: Read) -> None:
    painting = read(layer("1 #ff0000 leaves", path(1, "#ff0000")) + layer("oak #0000ff", path(2, "#0000ff"))).painting
    assert [paint.name for paint in painting.paints] == ["#ff0000 leaves", "oak #0000ff"]


def test_an_svg_that_we_have_written_is_read_as_the_same_strokes(read: Read, tmp_path: Path) -> None:
    first = read(layer("1+S50 red", path(1, "red")) + layer("2 blue", path(2, "blue"))).painting
    write_painting(first, tmp_path / "painting.json")
    assert '"literal": true' in (tmp_path / "painting.json").read_text()
    (tmp_path / "again.svg").write_text(axidraw_svg(first))
    again = read_drawing(tmp_path / "again.svg", DrawingOptions(keep_order=True)).painting
    assert [stroke.trajectory for stroke in again.strokes] == [stroke.trajectory for stroke in first.strokes]
    assert [stroke.speed for stroke in again.strokes] == [stroke.speed for stroke in first.strokes]
