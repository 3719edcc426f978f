"""A painting as SVG for plotters, Inkscape and vpype: real millimetres, a layer a paint, an open path a stroke."""

from itertools import groupby
from xml.etree import ElementTree

import numpy as np

from maulstick.medium import Brush
from maulstick.painting import Paint, Painting, Stroke, hex_colour

_DOT = 0.01  # mm: the length of a path that stands for one point, so that no program drops it


def painting_svg(painting: Painting) -> str:
    """The commanded centre lines of `painting` in painting order, millimetres, each as wide as its mean mark.

    There is a layer for every run of strokes of one paint: as many layers as paints where a paint is taken up once.
    A layer's label begins with its number, which vpype and plotters' drivers go by.
    """
    width, height = (f"{1e3 * side:.6g}" for side in (painting.canvas.width, painting.canvas.height))
    root = ElementTree.Element(
        "svg",
        {
            "xmlns": "http://www.w3.org/2000/svg",
            "xmlns:inkscape": "http://www.inkscape.org/namespaces/inkscape",
            "width": f"{width}mm",
            "height": f"{height}mm",
            "viewBox": f"0 0 {width} {height}",
            "style": f"background-color:{hex_colour(painting.canvas.paper)}",
        },
    )
    for number, (index, run) in enumerate(groupby(painting.strokes, key=lambda stroke: stroke.paint), start=1):
        paint = painting.paints[index]
        layer = ElementTree.SubElement(
            root,
            "g",
            {
                "id": f"layer-{number}",
                "inkscape:groupmode": "layer",
                "inkscape:label": f"{number} {paint.label} {paint.brush}",
            },
        )
        for stroke in run:
            ElementTree.SubElement(layer, "path", _path(stroke, paint, painting.brushes[paint.brush]))
    ElementTree.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'


def _path(stroke: Stroke, paint: Paint, brush: Brush) -> dict[str, str]:
    trajectory = np.array(stroke.trajectory)
    half_width = brush.half_width(trajectory[:, 2]).clip(min=0).mean()
    points = [f"{1e3 * x:.3f},{1e3 * y:.3f}" for x, y in trajectory[:, :2].tolist()]
    if len(set(points)) == 1:
        x, y = 1e3 * trajectory[0, :2]
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
