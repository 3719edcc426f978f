"""Paintings of a few strokes, small enough for tests of machines."""

from collections.abc import Iterable

import numpy as np

from maulstick.painting.brush import Brush
from maulstick.painting.painting import Paint, Painting, Provenance, Sheet, Stroke
from tests.support.nominal import nominal

WIDTH, HEIGHT = 0.06, 0.04
RED, BLUE = (0.8, 0.1, 0.1), (0.1, 0.2, 0.7)


def line(
    number: int,
    start: tuple[float, float] = (0.01, 0.01),
    end: tuple[float, float] = (0.03, 0.01),
    *,
    paint: int = 0,
    pressure: tuple[float, float] = (0.5, 0.5),
    speed: float | None = None,
    points: int = 5,
) -> Stroke:
    """A straight stroke whose pressure changes evenly."""
    trajectory = np.linspace([*start, pressure[0]], [*end, pressure[1]], points)
    return Stroke(
        id=number,
        paint=paint,
        trajectory=tuple(map(tuple, trajectory.tolist())),
        speed=None if speed is None else (speed,) * points,
    )


def painting_of(
    strokes: Iterable[Stroke],
    brushes: Iterable[Brush] = (nominal("marker"),),
    size: tuple[float, float] = (WIDTH, HEIGHT),
) -> Painting:
    """Return a painting of the strokes on a small sheet; paints are red and blue in turn, and so are their brushes."""
    tools = list(brushes)
    strokes = tuple(strokes)
    needed = 1 + max((stroke.paint for stroke in strokes), default=0)
    colours = [RED, BLUE]
    return Painting(
        sheet=Sheet(width=size[0], height=size[1]),
        provenance=Provenance(version="1"),
        brushes={brush.name: brush for brush in tools},
        paints=tuple(Paint(colour=colours[i % 2], brush=tools[i % len(tools)].name) for i in range(needed)),
        strokes=strokes,
    )


SIX = painting_of(
    line(10 + i, (0.01, 0.005 * (i + 1)), (0.01 + 0.005 * (i + 1), 0.005 * (i + 1)), paint=i // 3) for i in range(6)
)
"""Strokes 10 to 15, one below the other and each longer than the one before: three red ones, three blue."""
