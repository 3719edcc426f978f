import math
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import vpype

from maulstick.painting.brush import load_brush
from maulstick.painting.fields import Point
from maulstick.painting.painting import Paint, Painting, Provenance, Sheet, Stroke
from maulstick.painting.refined import refined
from maulstick.painting.svg import axidraw_svg, flattened_note, painting_svg
from maulstick.strokes.refine import refine
from tests.support.nominal import nominal
from tests.support.robot.small_paintings import line as straight
from tests.support.robot.small_paintings import painting_of

SVG = "{http://www.w3.org/2000/svg}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
PX_PER_METRE = 96 / 0.0254
HALF_A_STEP = 0.5e-6  # metres: coordinates have three decimals of a millimetre
CURVE: tuple[Point, ...] = ((0.01, 0.02, 0.0), (0.03, 0.04, 0.5), (0.1, 0.05, 1.0))
LINE: tuple[Point, ...] = ((0.15, 0.15, 0.25), (0.123456, 0.1, 0.75))
DOT: tuple[Point, ...] = ((0.05, 0.06, 1.0),)


def a_painting(*strokes: tuple[int, tuple[Point, ...]]) -> Painting:
    bent = nominal("round").model_copy(update={"m_x": 2.0, "b_x": 0.05})
    return Painting(
        sheet=Sheet(width=0.2, height=0.16, paper=(1.0, 1.0, 0.8)),
        provenance=Provenance(version="1"),
        brushes={"round <bent>": bent, "pen": nominal("fineliner")},
        paints=(
            Paint(colour=(0.0, 0.0, 0.0), brush="pen"),
            Paint(colour=(1.0, 0.0, 0.0), brush="round <bent>"),
            Paint(colour=(0.0, 0.5, 1.0), brush="pen"),
        ),
        strokes=tuple(Stroke(id=10 + i, paint=p, trajectory=t) for i, (p, t) in enumerate(strokes)),
    )


PAINTING = a_painting((1, CURVE), (1, LINE), (0, LINE), (2, DOT), (2, CURVE))


def layers(painting: Painting) -> list[ElementTree.Element]:
    return ElementTree.fromstring(painting_svg(painting).encode()).findall(f"{SVG}g")


def test_the_page_is_as_large_as_the_canvas_in_millimetres() -> None:
    root = ElementTree.fromstring(painting_svg(PAINTING).encode())
    assert (root.get("width"), root.get("height"), root.get("viewBox")) == ("200mm", "160mm", "0 0 200 160")
    assert root.get("style") == "background-color:#ffffcc"


def test_a_paint_is_a_layer_in_the_order_of_first_use() -> None:
    assert [layer.get(f"{INKSCAPE}groupmode") for layer in layers(PAINTING)] == ["layer"] * 3
    assert [layer.get(f"{INKSCAPE}label") for layer in layers(PAINTING)] == [
        "1 #ff0000 round <bent>",
        "2 #000000 pen",
        "3 #0080ff pen",
    ]
    assert [[path.get("stroke") for path in layer] for layer in layers(PAINTING)] == [
        ["#ff0000"] * 2,
        ["#000000"],
        ["#0080ff"] * 2,
    ]


def test_a_paint_taken_up_again_is_another_layer_so_that_painting_order_is_kept() -> None:
    painting = a_painting((0, LINE), (1, LINE), (0, CURVE))
    assert [[path.get("id") for path in layer] for layer in layers(painting)] == [
        ["stroke-10"],
        ["stroke-11"],
        ["stroke-12"],
    ]
    assert len({layer.get("id") for layer in layers(painting)}) == 3


def test_a_stroke_is_one_open_path_along_its_commanded_centre_line() -> None:
    path = layers(PAINTING)[0][0]  # its brush is bent, and that must not show
    assert path.tag == f"{SVG}path"
    (line,) = refine([np.array(CURVE)])
    first, *rest = (f"{1e3 * x:.3f},{1e3 * y:.3f}" for x, y, _ in line)
    assert path.get("d") == f"M {first} L {' '.join(rest)}"
    assert " 30.000,40.000 " in path.get("d", "")
    assert len(line) > len(CURVE)
    assert path.get("fill") == "none"
    assert (path.get("stroke-linecap"), path.get("stroke-linejoin")) == ("round", "round")


def test_a_stroke_is_as_wide_as_its_mean_mark() -> None:
    brush = PAINTING.brushes["round <bent>"]
    widths = [float(path.get("stroke-width", "nan")) for path in layers(PAINTING)[0]]
    expected = [2e3 * np.mean([brush.alpha * p + brush.beta for _, _, p in points]) for points in (CURVE, LINE)]
    assert widths == pytest.approx(expected, abs=1e-3)
    assert layers(PAINTING)[1][0].get("stroke-width") == "0.300"


def test_a_stroke_that_goes_nowhere_is_a_dot_that_can_be_seen() -> None:
    assert layers(PAINTING)[2][0].get("d") == "M 50.000,60.000 L 50.010,60.000"
    still = layers(a_painting((0, DOT * 4)))[0][0]
    assert still.get("d") == "M 50.000,60.000 L 50.010,60.000"


def test_an_empty_painting_is_an_empty_page() -> None:
    assert layers(a_painting()) == []


@pytest.mark.parametrize(
    "painting", [PAINTING, a_painting((0, LINE), (1, DOT), (0, CURVE))], ids=["grouped", "alternating"]
)
def test_vpype_reads_the_same_page_layers_and_lengths(tmp_path: Path, painting: Painting) -> None:
    path = tmp_path / "painting.svg"
    path.write_text(painting_svg(painting), encoding="utf-8")
    document = vpype.read_multilayer_svg(str(path), quantization=0.1)
    assert document.page_size == pytest.approx((0.2 * PX_PER_METRE, 0.16 * PX_PER_METRE), rel=1e-6)
    assert sorted(document.layers) == list(range(1, painting.paint_changes() + 2))
    lines = [line for number in sorted(document.layers) for line in document.layers[number]]
    assert len(lines) == len(painting.strokes)
    for line, stroke in zip(lines, refined(painting).strokes, strict=True):
        commanded = sum(math.dist(a[:2], b[:2]) for a, b in pairwise(stroke.trajectory))
        length = np.abs(np.diff(line)).sum() / PX_PER_METRE
        assert length == pytest.approx(max(commanded, 1e-5), abs=2 * len(stroke.trajectory) * HALF_A_STEP)
        x, y, _ = stroke.trajectory[0]
        assert (line[0].real, line[0].imag) == pytest.approx(
            (x * PX_PER_METRE, y * PX_PER_METRE), abs=HALF_A_STEP * PX_PER_METRE
        )


def test_a_layer_is_called_by_the_name_of_its_paint() -> None:
    named = PAINTING.paints[1].model_copy(update={"name": "cadmium <red>"})
    found = layers(PAINTING.model_copy(update={"paints": (PAINTING.paints[0], named, PAINTING.paints[2])}))
    assert [layer.get(f"{INKSCAPE}label") for layer in found] == [
        "1 cadmium <red> #ff0000 round <bent>",
        "2 #000000 pen",
        "3 #0080ff pen",
    ]


def axidraw_labels(*strokes: Stroke) -> list[str | None]:
    painting = PAINTING.model_copy(update={"strokes": strokes})
    found = ElementTree.fromstring(axidraw_svg(painting).encode()).findall(f"{SVG}g")
    return [layer.get(f"{INKSCAPE}label") for layer in found]


def test_the_axidraws_software_pauses_before_each_paint_but_the_first() -> None:
    assert axidraw_labels(*PAINTING.strokes) == ["1 #ff0000 round <bent>", "!2 #000000 pen", "!3 #0080ff pen"]


def test_a_layer_has_a_code_for_what_all_its_strokes_agree_on() -> None:
    light, deep = (tuple((x, y, pressure) for x, y, _ in LINE) for pressure in (0.25, 1.0))
    slow = Stroke(id=1, paint=1, trajectory=light, speed=(0.02, 0.02))
    assert axidraw_labels(slow) == ["1+S10+H30 #ff0000 round <bent>"]
    assert axidraw_labels(slow, Stroke(id=2, paint=1, trajectory=deep, speed=(0.02, 0.02))) == [
        "1+S10 #ff0000 round <bent>"
    ]
    assert axidraw_labels(slow, Stroke(id=2, paint=1, trajectory=light, speed=(0.02, 0.03))) == [
        "1+H30 #ff0000 round <bent>"
    ]
    assert axidraw_labels(slow, Stroke(id=2, paint=1, trajectory=light)) == ["1+H30 #ff0000 round <bent>"]
    assert axidraw_labels(slow, Stroke(id=2, paint=2, trajectory=deep, speed=(5.0, 5.0))) == [
        "1+S10+H30 #ff0000 round <bent>",
        "!2+S100 #0080ff pen",  # its mark is the same at any pressure
    ]


def test_but_for_its_labels_the_drawing_is_the_same_for_an_axidraw() -> None:
    assert axidraw_svg(PAINTING).replace('label="!', 'label="') == painting_svg(PAINTING)


def test_pressure_that_a_stroke_varies_is_said_to_be_lost() -> None:
    varied, steady = straight(1, pressure=(0, 1)), straight(2, pressure=(0.5, 0.5), paint=1)
    assert flattened_note(painting_of([steady])) == ""
    assert flattened_note(painting_of([varied], [load_brush("fineliner")])) == "", "whose mark it does not change"
    said = flattened_note(painting_of([varied, steady, straight(7, pressure=(1, 0))]))
    assert said == (
        "stroke 1 and 1 more vary the pressure, which an SVG cannot say: the pen's height is one for each layer"
    )


def test_pressure_that_varies_from_stroke_to_stroke_of_a_layer_is_said_to_be_lost() -> None:
    light, deep = straight(1, pressure=(0.25, 0.25)), straight(2, pressure=(1, 1))
    assert flattened_note(painting_of([light, deep])).startswith("stroke 1 and 1 more vary the pressure")
    assert flattened_note(painting_of([light, deep.model_copy(update={"paint": 1})])) == "", "each layer has its height"


def test_a_layer_has_the_height_of_its_pen_where_nobody_sees_what_its_pressure_varies() -> None:
    light, deeper = (tuple((x, y, pressure) for x, y, _ in LINE) for pressure in (0.245, 0.255))
    strokes = Stroke(id=1, paint=1, trajectory=light), Stroke(id=2, paint=1, trajectory=deeper)
    assert axidraw_labels(*strokes) == ["1+H30 #ff0000 round <bent>"]
