"""Map of strokes on the page: each can be chosen by pointer or keyboard, and is then shown large."""

from pathlib import Path
from typing import final

import numpy as np
from nicegui import events, html, ui

from maulstick.storage.arrays import Floats, Ints
from maulstick.studio.workers.style_work import Map

WIDE, HIGH = 1400, 1000
"""Size of the map's drawing, in its own units."""

_CLOSE = 1.15  # size of the largest stroke over its share of the map; above 1 since most strokes are smaller
_LARGEST = 125.0  # units: the largest stroke at most
_MARGIN = 30.0  # units around the map
_LARGE_WIDE, _LARGE_HIGH, _LARGE_MARGIN = 600, 300, 40  # units of the drawing of the chosen stroke
_BAR = 0.01  # metres: usual length of the scale bar
_NOTHING = f'<svg viewBox="0 0 {_LARGE_WIDE} {_LARGE_HIGH}" aria-hidden="true"></svg>'
_DIRECTIONS = {"left": (-1, 0), "right": (1, 0), "up": (0, -1), "down": (0, 1)}  # of the arrow keys; y is down
_SCRIPT = Path(__file__).with_name("map.js")


@final
class StrokeMap:
    """Map, and above it the chosen stroke."""

    def __init__(self, found: Map) -> None:
        self._map = found
        html.p(
            "Strokes that are alike lie close together; which side they lie on means nothing. "
            "Tap one to see it large, or go from one to the next with the arrow keys."
        ).classes("hint")
        if len(found.names) > 1:
            self._legend()
        with ui.element().classes("large-stroke line").props('aria-live="polite"'):
            self._large = ui.html(_NOTHING, sanitize=False).classes("drawn")
            self._told = ui.label("No stroke is chosen yet.").classes("hint figure")
        script = _SCRIPT.read_text()
        drawn = ui.html(map_svg(found), sanitize=False).classes("stroke-map")
        for kind in ("click", "keydown"):
            drawn.on(kind, js_handler=script)
        drawn.on("focusin", self._choose, js_handler=script)
        shown, strokes = len(found.whose), found.strokes
        if shown < strokes:
            html.p(f"The map shows {shown} of {strokes} strokes.").classes("hint")

    def _legend(self) -> None:
        with html.ul().classes("legend").props('aria-label="Colours of the hands"'):
            for number, name in enumerate(self._map.names):
                html.li(name).classes(f"whose-{number}")

    def _choose(self, event: events.GenericEventArguments) -> None:
        number = event.args
        if type(number) is int and 0 <= number < len(self._map.whose):
            self._large.set_content(large_svg(self._map.paths[number], int(self._map.whose[number])))
            self._told.set_text(description_of(self._map, number))


def map_svg(found: Map) -> str:
    """Draw the map as SVG; it contains numbers alone, no text that a user gave."""
    count = len(found.whose)
    size = min(_LARGEST, _CLOSE * float(np.sqrt(WIDE * HIGH / count)))
    room = np.array([WIDE, HIGH]) - size - 2 * _MARGIN
    centres = found.places * room + np.array([WIDE, HIGH]) / 2
    near = neighbours(centres)
    spot = min(size, _least_distance(centres)) / 2  # so that none lies on another
    spots = [
        f'<circle data-stroke="{number}" cx="{x:.1f}" cy="{y:.1f}" r="{spot:.1f}"/>'
        for number, (x, y) in enumerate(centres)
    ]
    strokes = [
        f'<path class="whose-{whose}" data-stroke="{number}" tabindex="{0 if number == 0 else -1}" role="button" '
        + " ".join(f'data-{way}="{to}"' for way, to in zip(_DIRECTIONS, near[number], strict=True))
        + f' aria-label="Stroke {number + 1} of {count}, {1e3 * length:.3g} millimetres" d="{_line(path)}"/>'
        for number, (whose, length, path) in enumerate(
            zip(found.whose, found.lengths, found.glyphs * size + centres[:, None], strict=True)
        )
    ]
    return (
        f'<svg viewBox="0 0 {WIDE} {HIGH}" role="group" aria-label="Map of the strokes">'
        f'<g class="spots">{"".join(spots)}</g><g>{"".join(strokes)}</g><path class="chosen"/></svg>'
    )


def neighbours(centres: Floats) -> Ints:
    """Index of the nearest of the places (N, 2) left, right, above and below each, (N, 4); its own where none is."""
    apart = centres[None] - centres[:, None]
    distances = np.linalg.norm(apart, axis=2)
    found = np.tile(np.arange(len(centres))[:, None], len(_DIRECTIONS))
    for column, direction in enumerate(_DIRECTIONS.values()):
        along = apart @ np.array(direction, dtype=np.float64)
        lies_there = (along > 0) & (along >= distances / np.sqrt(2) - 1e-9)
        nearest = np.where(lies_there, distances, np.inf).argmin(axis=1)
        found[:, column] = np.where(lies_there.any(axis=1), nearest, found[:, column])
    return found


def _least_distance(centres: Floats) -> float:
    apart = np.linalg.norm(centres[None] - centres[:, None], axis=2)
    np.fill_diagonal(apart, np.inf)
    return float(apart.min())


def large_svg(path: Floats, whose: int) -> str:
    """Draw a stroke (n, 2), metres, as large as fits, as SVG with a scale bar of 1, 10 or 100 mm."""
    low, extent = path.min(axis=0), np.ptp(path, axis=0).clip(min=1e-6)
    room = np.array([_LARGE_WIDE - 2 * _LARGE_MARGIN, _LARGE_HIGH - 2.5 * _LARGE_MARGIN])
    scale = float((room / extent).min())
    drawn = (path - low - extent / 2) * scale + np.array([_LARGE_WIDE / 2, _LARGE_MARGIN + room[1] / 2])
    bar = max((length for length in (_BAR / 10, _BAR, 10 * _BAR) if length * scale < 0.7 * room[0]), default=_BAR / 10)
    y, end = _LARGE_HIGH - _LARGE_MARGIN / 2, _LARGE_MARGIN + bar * scale
    return (
        f'<svg viewBox="0 0 {_LARGE_WIDE} {_LARGE_HIGH}" role="img" aria-label="The stroke, large">'
        f'<path class="whose-{whose}" d="{_line(drawn)}"/>'
        f'<circle class="start" cx="{drawn[0, 0]:.1f}" cy="{drawn[0, 1]:.1f}" r="7"/>'
        f'<path class="bar" d="M{_LARGE_MARGIN} {y:.1f}H{end:.1f}"/>'
        f'<text x="{end + 10:.1f}" y="{y + 6:.1f}">{1e3 * bar:.0f} mm</text></svg>'
    )


def description_of(found: Map, number: int) -> str:
    """Describe a stroke for people."""
    speed, pressure = found.speeds[number], found.pressure[number]
    facts = [
        f"Stroke {number + 1} of {len(found.whose)}, by {found.names[found.whose[number]]}",
        f"{1e3 * found.lengths[number]:.3g} mm long",
        *([] if np.isnan(speed) else [f"drawn at {1e3 * speed:.3g} mm per second"]),
        *([] if np.isnan(pressure) else [f"pen pressure {100 * pressure:.0f} %"]),
    ]
    return ", ".join(facts)


def _line(path: Floats) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in path)
