"""Order of strokes, beside vpype's linesort; for robot.py.

name: `one_ink` in that style; `one_ink_directed` the same, where no stroke may be drawn backwards; `colours` in 12
    paints, and `colours_mixed` the same strokes in an order that heeds no paint, of which every overlap binds.
    `franka` is that arm in franky-sim.
metres: of pen-up travel between strokes, without the way to the first.
seconds_to_order: of `tour` for one ink; of all that `sequenced` does for colours.
vpype_metres, vpype_seconds: of `linesort --two-opt`; of `linesort --no-flip` for directed strokes, since --two-opt
    draws strokes backwards even beside --no-flip.
paint_changes_before, paint_changes: of colours.
estimated_s, simulated_s: seconds of the first `timed` strokes in that order, by `seconds_of` and by a Grbl that steps
    acceleration and junction deviation at 1 kHz, its pen lifted by a servo (by height for `one_ink_directed`).
"""

import time
from collections.abc import Iterator

import numpy as np
import vpype
import vpype_cli
from clocks import SERVO, on_franka, on_grbl
from photographs import laid_out

from maulstick.ordering.sequence import sequenced
from maulstick.ordering.tour import pen_up, tour
from maulstick.painting.brush import load_brush
from maulstick.painting.painting import Painting
from maulstick.planning.from_picture import as_painting, problem_of, provenance_of
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.style import load_style

SIZES = (400, 2_000, 10_000)
STYLES = ("loops", "hatching")
HOME = (0.0, 0.0)
TIMED, TIMED_ON_AN_ARM = 200, 20
STEPS = 40  # of planning: strokes lie where tone and edges want them from the first
Row = dict[str, object]


def planned(strokes: int, style_name: str, brush_name: str, paints: int | None) -> Painting:
    """The astronaut, 160 mm high, in one ink or in so many paints."""
    layout, brush = laid_out("astronaut", 512), load_brush(brush_name)
    style = load_style(style_name, layout.canvas)
    options = PlannerSettings(strokes=strokes, exact=True, paints=paints, steps=STEPS)
    return as_painting(
        plan(problem_of(layout, (brush,), style, options), options), layout, (brush,), style, provenance_of(options)
    )


def ends_of(painting: Painting) -> np.ndarray:
    """(N, 2, 2) metres where strokes start and end."""
    return painting.trajectories()[:, [0, -1], :2]


def travel(ends: np.ndarray) -> float:
    """Pen-up metres between strokes in their order."""
    return float(np.linalg.norm(ends[1:, 0] - ends[:-1, 1], axis=1).sum())


def by_vpype(ends: np.ndarray, options: str) -> tuple[float, float]:
    """Pen-up metres after linesort, and its seconds."""
    document = vpype.Document(vpype.LineCollection([stroke @ np.array([1, 1j]) for stroke in ends]))
    started = time.perf_counter()
    ordered = vpype_cli.execute(f"linesort {options}", document)
    return ordered.pen_up_length(), time.perf_counter() - started


def one_ink(ends: np.ndarray, style_name: str, reversible: bool) -> Row:
    """A row of strokes in one ink, of which all may be drawn backwards, or none."""
    started = time.perf_counter()
    way = tour(ends, np.full(len(ends), reversible), HOME)
    seconds = time.perf_counter() - started
    first = ends[way.order[0], int(way.turned[0])]
    metres = pen_up(ends, way, HOME) - float(np.hypot(*(first - HOME)))
    vpype_metres, vpype_seconds = by_vpype(ends, "--two-opt" if reversible else "--no-flip")
    return {
        "name": "one_ink" if reversible else "one_ink_directed",
        "style": style_name,
        "strokes": len(ends),
        "metres": metres,
        "seconds_to_order": seconds,
        "vpype_metres": vpype_metres,
        "vpype_seconds": vpype_seconds,
    }


def colours(painting: Painting, name: str) -> Row:
    """A row of strokes in many paints."""
    started = time.perf_counter()
    ordered = sequenced(painting, HOME)
    seconds = time.perf_counter() - started
    return {
        "name": name,
        "strokes": len(painting.strokes),
        "metres_before": travel(ends_of(painting)),
        "metres": travel(ends_of(ordered)),
        "seconds_to_order": seconds,
        "paint_changes_before": painting.paint_changes(),
        "paint_changes": ordered.paint_changes(),
    }


def mixed(painting: Painting) -> Painting:
    """The same strokes in a random order."""
    order = np.random.default_rng(0).permutation(len(painting.strokes))
    return painting.model_copy(update={"strokes": tuple(painting.strokes[i] for i in order)})


def timed(row: Row, painting: Painting, reversible: bool) -> Row:
    """The row, with how long the first strokes take."""
    ordered = sequenced(painting, HOME)
    estimated, simulated = on_grbl(ordered, TIMED, SERVO if reversible else None)
    return {**row, "timed": TIMED, "estimated_s": estimated, "simulated_s": simulated}


def rows(quick: bool) -> Iterator[Row]:
    """All rows; the smallest paintings alone where it must be quick."""
    for strokes in SIZES[:1] if quick else SIZES:
        for style_name in STYLES:
            painting = planned(strokes, style_name, "fineliner", None)
            for reversible in (True, False):
                yield timed(one_ink(ends_of(painting), style_name, reversible), painting, reversible)
        painting = planned(strokes, "loops", "marker", 12)
        yield colours(painting, "colours")
        yield colours(mixed(painting), "colours_mixed")
    estimated, simulated = on_franka(sequenced(planned(400, "loops", "fineliner", None), HOME), TIMED_ON_AN_ARM)
    yield {"name": "franka", "strokes": TIMED_ON_AN_ARM, "estimated_s": estimated, "simulated_s": simulated}
