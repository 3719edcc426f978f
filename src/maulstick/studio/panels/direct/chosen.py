"""Strokes that are chosen on the canvas: what they are, in words, and what can be done with them."""

from collections.abc import Awaitable, Callable
from typing import Any

from nicegui import events, html, ui

from maulstick.storage.text import counted
from maulstick.studio.panels.direct.canvas import StrokeCanvas
from maulstick.studio.workers.stroke_marks import ShownPaint, ShownSheet

_MOST_TOLD = 3  # paints that are named one by one


class ChosenStrokes:
    """Part of the panel about what is chosen. edit: does an edit.  took: called where another paint is taken."""

    def __init__(
        self,
        sheet: ShownSheet,
        canvas: StrokeCanvas,
        edit: Callable[[dict[str, Any]], Awaitable[None]],
        took: Callable[[], object],
    ) -> None:
        self._sheet, self._edit = sheet, edit
        self._ids: list[int] = []
        self._locked = 0
        self.root = ui.element().classes("sheet")
        with self.root:
            self._said = ui.label().classes("said").props('role="status"')
            with ui.element().classes("acts"):
                ui.button("All").props("flat").on("click", js_handler=canvas.calling("chooseAll"))
                self._none = ui.button("None").props("flat")
                self._none.on("click", js_handler=canvas.calling("chooseNone"))
            with ui.element().classes("acts"):
                self._lock = ui.button("Lock", icon="lock", on_click=lambda: self.do("lock")).props("outline")
                self._remove = ui.button("Take out", icon="delete", on_click=lambda: self.do("remove")).props("outline")
            paints = {index: f"{index + 1}: {told(paint)}" for index, paint in enumerate(sheet.paints)}
            with ui.element().classes("line taken"):
                self._swatch = ui.element().classes("swatch").props("aria-hidden=true")
                self._paint = ui.select(paints, label="Paint", value=0 if paints else None, on_change=took)
                self._paint.classes("grow")
            self._repaint = ui.button("Give them this paint", icon="format_paint", on_click=self._give).props("outline")
            self._draws = html.p("Strokes that you draw are painted with the others of this paint.").classes("hint")
        self.show_paint(draws=False)
        self._show(set())

    @property
    def paint(self) -> int:
        """Index of the paint that is taken."""
        return int(self._paint.value or 0)

    def show_paint(self, *, draws: bool) -> None:
        """Show the paint that is taken. draws: whether the pointer draws with it."""
        self._draws.visible = draws
        if self._sheet.paints:
            self._swatch.style(f"background: {self._sheet.paints[self.paint].colour}")

    def take(self, event: events.GenericEventArguments) -> None:
        """Take from the page what is chosen."""
        sent = event.args if isinstance(event.args, dict) else {}
        ids, paints = sent.get("ids"), sent.get("paints")
        self._ids = [each for each in ids if isinstance(each, int)] if isinstance(ids, list) else []
        locked = sent.get("locked")
        self._locked = locked if isinstance(locked, int) else 0
        there = range(len(self._sheet.paints))
        self._show({each for each in paints if each in there} if isinstance(paints, list) else set())

    async def do(self, what: str) -> None:
        """Lock what is chosen, or unlock it where all of it is locked, or take it out. what: "lock" or "remove"."""
        if self._ids:
            kind = "unlock" if what == "lock" and self._locked == len(self._ids) else what
            await self._edit({"kind": kind, "strokes": self._ids})

    async def _give(self) -> None:
        await self._edit({"kind": "repaint", "strokes": self._ids, "paint": self.paint})

    def _show(self, paints: set[int]) -> None:
        self._said.text = chosen_in_words(
            len(self._ids), [self._sheet.paints[each] for each in sorted(paints)], self._locked
        )
        self._lock.text = "Unlock" if self._ids and self._locked == len(self._ids) else "Lock"
        self._lock.props(f"icon={'lock_open' if self._lock.text == 'Unlock' else 'lock'}")
        for button in (self._lock, self._remove, self._repaint, self._none):
            button.set_enabled(bool(self._ids))


def told(paint: ShownPaint) -> str:
    """Return a paint in words: its colour, with its name where it has one, and its brush."""
    return f"{paint.label}, {paint.brush}"


def chosen_in_words(strokes: int, paints: list[ShownPaint], locked: int) -> str:
    """Return what is chosen: so many strokes of these paints, so many of them locked."""
    if not strokes:
        return "Nothing is chosen. Click on a stroke, or drag a line around several."
    what = counted(strokes, "stroke")
    if not locked:
        how = ""
    elif locked == strokes:
        how = "; locked"
    else:
        how = f"; {locked} locked"
    if len(paints) > _MOST_TOLD:
        return f"{what} of {len(paints)} paints{how}"
    return f"{what}: {' and '.join(told(paint) for paint in paints)}{how}"
