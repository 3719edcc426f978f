"""Canvas of a plan: its strokes as vectors, which a person zooms, chooses, moves and adds to."""

from collections.abc import Iterable
from math import isfinite
from pathlib import Path
from typing import Any, Final, final

from nicegui import ui
from nicegui.element import Element

from maulstick.studio.workers.said import Said, Spot
from maulstick.studio.workers.stroke_marks import ShownSheet

CHOOSE: Final = "choose"
"""Tool that chooses strokes by clicks and lassos, and moves them."""

DRAW: Final = "draw"
"""Tool that draws strokes."""

TOOLS: Final = {CHOOSE: "Choose", "pan": "Look around", DRAW: "Draw"}
"""Tools of the canvas with their labels."""

IMPORTANCE: Final = "importance"
"""Tool that paints with a broad brush what counts more."""

SAYING: Final = {"region": "Region", "bare": "Bare paper", IMPORTANCE: "Importance", "guide": "Guide"}
"""Tools that say something of a place on the sheet, with their labels."""

_SCRIPTS = Path(__file__).with_name("view")
_BUTTONS: Final = (
    ("", "zoom_in", "Nearer (+)", "nearer"),
    ("", "zoom_out", "Farther (-)", "farther"),
    ("1:1", None, "True size: a millimetre is a millimetre (1)", "showTrueSize"),
    ("", "fit_screen", "All of it (0)", "fit"),
    ("", "search", "Loupe, four times nearer, where the pointer is (M)", "magnify"),
)
"""Buttons by text, icon, what they do in words and by key, and the method of stage.js for it."""


@final
class StrokeCanvas(Element, component="view/canvas.js"):
    """Canvas with the strokes of a plan. name: of the plan.  picture: address of what it is of, "" for none.

    It emits `chosen` (ids, paints, locked), `moved` (strokes, by, turn), `drawn` (paint, points), all in millimetres,
    `said` (tool, points) for a line that says something of a place, `region` (id) for one that is clicked,
    `ask` for what a key asks for, and `refused`.
    """

    def __init__(self, name: str, sheet: ShownSheet, version: int, picture: str, label: str) -> None:
        super().__init__()
        self.add_resource(_SCRIPTS)
        self._props.update(source=f"/strokes/{name}", version=version, picture=picture, label=label)
        self._props.update(wide=sheet.width, high=sheet.height, paper=sheet.paper, tool=CHOOSE, paint=0)
        self._props["colours"] = [paint.colour for paint in sheet.paints]
        self._props["halfWidths"] = [list(paint.half_widths) for paint in sheet.paints]
        self._props.update(said={"regions": [], "guides": []}, saidChosen=-1, broad=1)

    def show(self, version: int) -> None:
        """Show the strokes after so many acts."""
        self._props["version"] = version

    def take_up(self, tool: str, paint: int) -> None:
        """Let the pointer be a tool of `TOOLS`, which draws with the paint of this index."""
        self._props.update(tool=tool, paint=paint)

    def show_places(self, said: Said, chosen: int | None, broad: float) -> None:
        """Show regions and guides. chosen: id of one.  broad: width of the brush of importance, millimetres."""
        regions = [
            {
                **region.model_dump(include={"id", "name", "colour", "bare"}),
                "rings": [_flat(ring) for rings in region.area for ring in rings],
            }
            for region in said.regions
        ]
        guides = [{"id": guide.id, "line": _flat(guide.line)} for guide in said.guides]
        now = {"said": {"regions": regions, "guides": guides}, "saidChosen": -1 if chosen is None else chosen}
        self._props.update(now, broad=broad)

    def buttons(self) -> None:
        """Make the buttons that zoom."""
        for text, icon, words, method in _BUTTONS:
            button = ui.button(text, icon=icon).props("flat round dense").tooltip(words)
            button.on("click", js_handler=self.calling(method)).props["aria-label"] = words.partition(" (")[0]

    def calling(self, method: str, given: str = "") -> str:
        """Return the script of an event that calls a method of stage.js. given: a script for its argument."""
        more = f", {given}" if given else ""
        return f"(event) => runMethod({self.id}, 'run', ['{method}'{more}])"


def _flat(line: Iterable[Spot]) -> list[float]:
    """Return points, metres, as x, y, x, … in millimetres."""
    return [round(1e3 * each, 3) for spot in line for each in spot]


def numbers_of(sent: Any, most: int) -> list[float]:
    """Return the finite numbers that a page sent, at most so many; [] where it sent anything else."""
    if not isinstance(sent, list) or len(sent) > most:
        return []
    numbers = [float(each) for each in sent if isinstance(each, int | float) and isfinite(each)]
    return numbers if len(numbers) == len(sent) else []
