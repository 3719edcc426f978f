"""Sheet on the page to draw on with a stylus, a finger or a mouse."""

import asyncio
from collections.abc import Callable
from typing import final

from nicegui import events
from nicegui.element import Element

from maulstick.errors import InputError
from maulstick.studio.state.drawing import Drawing
from maulstick.studio.wording import error_text
from maulstick.studio.workers.drawn_sheet import MOST_OF_A_STROKE, DrawnStroke, in_mm

_AT_ONCE = 50_000  # points per message, so that the page stays responsive while a full sheet loads


@final
class DrawingSheet(Element, component="pen.js"):
    """Sheet that draws at once in the browser, sends each finished stroke, and shows the strokes of other pages.

    say: called for each stroke with the reason why it is refused, or with "" where it is kept.
    """

    def __init__(self, drawing: Drawing, say: Callable[[str], None]) -> None:
        super().__init__()
        self._drawing, self._say = drawing, say
        self._is_ready = False
        self._drawn_here: object = None
        self._heard = set[object]()  # ids of strokes that came from here; they come again if the page is not told
        width, height = drawing.size
        self._props.update(width=in_mm(width), height=in_mm(height), longest=MOST_OF_A_STROKE, rubs=False)
        self.on("ready", self._show_all, [])
        self.on("stroke", self._add)
        self.on("rub", self._rub)
        self.on("undo", drawing.undo, [])
        self.on("redo", drawing.redo, [])
        drawing.added.subscribe(self._show, unsubscribe_on_delete=False)  # `_handle_delete` does
        drawing.removed.subscribe(self._drop, unsubscribe_on_delete=False)

    def rub_out(self, rubs: bool) -> None:
        """Switch to rubbing strokes out, or to drawing."""
        self._props["rubs"] = rubs

    async def _show_all(self) -> None:
        """Send all strokes, in several messages; strokes added or removed meanwhile are sent as usual."""
        if self._is_ready:
            return
        self._is_ready = True
        part: list[tuple[int, list[float]]] = []
        for id, stroke in list(self._drawing.strokes.items()):
            if id not in self._drawing.strokes:
                continue
            part.append((id, _shown(stroke)))
            if sum(len(points) for _, points in part) > 3 * _AT_ONCE:
                self.run_method("show", part)
                part = []
                await asyncio.sleep(0)
        self.run_method("show", part)

    def _add(self, event: events.GenericEventArguments) -> None:
        sent = event.args if isinstance(event.args, dict) else {}
        self._drawn_here = id = sent.get("id")
        try:
            if not (type(id) is int and id in self._heard):
                self._drawing.add(id, sent.get("points"))
        except InputError as error:
            self.run_method("drop", id)
            self._say(error_text(error))
        else:
            self._heard.add(id)
            self.run_method("heard", id)
            self._say("")
        finally:
            self._drawn_here = None

    def _rub(self, event: events.GenericEventArguments) -> None:
        sent = event.args if isinstance(event.args, dict) else {}
        self._drawing.rub_out(id := sent.get("id"), sent.get("swipe"))
        self.run_method("drop", id)  # also where another page was sooner, so that it is not asked for again

    def _show(self, id: int, stroke: DrawnStroke) -> None:
        if self._is_ready and id != self._drawn_here:
            self.run_method("show", [(id, _shown(stroke))])

    def _drop(self, id: int) -> None:
        self.run_method("drop", id)

    def _handle_delete(self) -> None:
        self._drawing.added.unsubscribe(self._show)
        self._drawing.removed.unsubscribe(self._drop)
        super()._handle_delete()


def _shown(stroke: DrawnStroke) -> list[float]:
    """List x, y and pressure of all points, one after the other, as pen.js takes them."""
    points: list[float] = stroke.points[:, 1:4].ravel().tolist()
    return points
