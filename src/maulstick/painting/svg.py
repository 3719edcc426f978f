"""SVG files for plotters, Inkscape and vpype: real millimetres, one layer per paint, one open path per stroke."""

import re
from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from typing import Final
from xml.etree import ElementTree

import numpy as np

from maulstick.painting.brush import Brush
from maulstick.painting.painting import Paint, Painting, Stroke, hex_colour
from maulstick.painting.refined import refined
from maulstick.storage.arrays import Floats

AXIDRAW_SPEED: Final = 0.2
"""Metres per second that +S100 in a layer's name stands for."""

OWN_LAYER: Final = re.compile(r"layer-[0-9]+")
"""Ids of layers that are written here: the colour and the brush stand after the name in their labels."""

_STEADY = 0.02  # range of pressure within a layer that nobody sees
_DOT = 0.01  # mm: the length of a path that stands for one point, so that no program drops it
_AXIDRAW_TOUCH = 40  # per cent of the servo's way: the usual height at which a pen just touches


def painting_svg(painting: Painting) -> str:
    """Return an SVG of the commanded centre lines in painting order, millimetres, each as wide as its mean mark.

    The lines are `refined`. There is one layer per run of strokes of one paint: as many layers as paints where each is
    taken up once.
    A layer's label begins with its number, by which vpype and plotters' drivers sort.
    """
    return _svg(painting, lambda number, paint, brush, run: f"{number} {paint.label} {paint.brush}")


def axidraw_svg(painting: Painting) -> str:
    """Return the same SVG as `painting_svg`, with labels at which AxiDraw's own software pauses for the next pen.

    Before its name a label has `!` to pause, and its number. Where all strokes of the layer agree, `+S` and their speed
    in per cent of 0.2 m/s follow, and for a brush whose mark depends on pressure `+H` and the pen's height in per cent
    of the servo's way: 40, which is usual, to just touch, 0 for the highest pressure
    (https://wiki.evilmadscientist.com/AxiDraw_Layer_Control).
    """
    return _svg(painting, _coded_label)


def flattened_note(painting: Painting) -> str:
    """Return a sentence that says which strokes lose the pressure that their layer varies in an SVG, or ""."""
    varying = [
        stroke.id
        for _, brush, run in _layers(painting)
        if brush.pressure_matters and np.ptp(_pressures(run)) > _STEADY
        for stroke in run
    ]
    if not varying:
        return ""
    which = f"stroke {varying[0]}" + (f" and {len(varying) - 1} more" if len(varying) > 1 else "")
    verb = "vary" if len(varying) > 1 else "varies"
    return f"{which} {verb} the pressure, which an SVG cannot say: the pen's height is one for each layer"


def _layers(painting: Painting) -> Iterator[tuple[Paint, Brush, tuple[Stroke, ...]]]:
    """Yield the runs of strokes of one paint, with that and its brush."""
    for index, strokes in groupby(painting.strokes, key=lambda stroke: stroke.paint):
        paint = painting.paints[index]
        yield paint, painting.brushes[paint.brush], tuple(strokes)


def _pressures(run: Sequence[Stroke]) -> Floats:
    return np.array([pressure for stroke in run for _, _, pressure in stroke.trajectory])


def _coded_label(number: int, paint: Paint, brush: Brush, run: Sequence[Stroke]) -> str:
    pause = "!" if number > 1 else ""
    speeds = {speed for stroke in run for speed in stroke.speed or (None,)}
    pressures = _pressures(run)
    codes = ""
    if len(speeds) == 1 and (speed := speeds.pop()) is not None:
        codes += f"+S{min(max(round(100 * speed / AXIDRAW_SPEED), 1), 100)}"
    if brush.pressure_matters and np.ptp(pressures) <= _STEADY:
        codes += f"+H{round(_AXIDRAW_TOUCH * (1 - pressures.mean()))}"
    return f"{pause}{number}{codes} {paint.label} {paint.brush}"


def _svg(painting: Painting, label: Callable[[int, Paint, Brush, Sequence[Stroke]], str]) -> str:
    width, height = (f"{1e3 * side:.6g}" for side in (painting.sheet.width, painting.sheet.height))
    root = ElementTree.Element(
        "svg",
        {
            "xmlns": "http://www.w3.org/2000/svg",
            "xmlns:inkscape": "http://www.inkscape.org/namespaces/inkscape",
            "width": f"{width}mm",
            "height": f"{height}mm",
            "viewBox": f"0 0 {width} {height}",
            "style": f"background-color:{hex_colour(painting.sheet.paper)}",
        },
    )
    lines = {stroke.id: np.array(stroke.trajectory)[:, :2] for stroke in refined(painting).strokes}
    for number, (paint, brush, run) in enumerate(_layers(painting), start=1):
        layer = ElementTree.SubElement(
            root,
            "g",
            {
                "id": f"layer-{number}",
                "inkscape:groupmode": "layer",
                "inkscape:label": label(number, paint, brush, run),
            },
        )
        for stroke in run:
            ElementTree.SubElement(layer, "path", _path(stroke, lines[stroke.id], paint, brush))
    ElementTree.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'


def _path(stroke: Stroke, line: Floats, paint: Paint, brush: Brush) -> dict[str, str]:
    half_width = brush.half_width(np.array(stroke.trajectory)[:, 2]).clip(min=0).mean()
    points = [f"{1e3 * x:.3f},{1e3 * y:.3f}" for x, y in line.tolist()]
    if len(set(points)) == 1:
        x, y = 1e3 * line[0]
        points = [points[0], f"{x + _DOT:.3f},{y:.3f}"]
    return {
        "id": f"stroke-{stroke.id}",
        "d": f"M {points[0]} L {' '.join(points[1:])}",
        "fill": "none",
        "stroke": paint.hex,
        "stroke-width": f"{2e3 * half_width:.3f}",
        "stroke-linecap": "round",
        "stroke-linejoin": "round",
    }
