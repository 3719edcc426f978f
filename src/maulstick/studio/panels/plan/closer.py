"""Closer look at a plan: it fills the window, zoomed and moved, beside its picture or another plan."""

from dataclasses import dataclass
from typing import Self

from nicegui import html, ui

from maulstick.painting.raster import parse_size
from maulstick.studio.state.plans import Plan
from maulstick.studio.widgets.brushes import is_pen
from maulstick.studio.widgets.zoom import ZoomedSheet
from maulstick.studio.workers.planner import TARGET

_LINES = "painting.svg"


@dataclass(frozen=True)
class Shown:
    """Picture on a page. source, lines: addresses of it as painted, and as sharp lines, "" where there are none."""

    title: str
    source: str
    lines: str = ""

    @classmethod
    def strokes(cls, plan: Plan, title: str) -> Self:
        """Return the strokes of a plan."""
        lines = f"/file/plans/{plan.name}/{_LINES}?{plan.planned}" if (plan.folder / _LINES).is_file() else ""
        return cls(title, f"/picture/plans/{plan.name}/preview.png?{plan.planned}", lines)

    @classmethod
    def target(cls, plan: Plan) -> Self:
        """Return the picture that a plan is of."""
        return cls("its picture", f"/picture/plans/{plan.name}/{TARGET}")


class CloserLook:
    """Dialog, open at once, with a plan and what it is compared with, if anything."""

    def __init__(self, plan: Plan, title: str, other: Shown | None) -> None:
        self._strokes, self._other = Shown.strokes(plan, title), other
        with ui.dialog(value=True).props("full-width full-height") as dialog, html.div().classes("sheet closer"):
            dialog.on("hide", dialog.delete).props["aria-label"] = f"A closer look at {title}"
            tools = ui.element().classes("line")
            parted = html.label().classes("weight")
            self._sheet = ZoomedSheet(
                parse_size(plan.request.options.size), f"{title}, which arrow keys move, and + and - zoom"
            )
            with tools:
                html.h2(title)
                self._sheet.buttons()
                self._lines = ui.checkbox("As sharp lines", value=_draws_lines(plan), on_change=self._show)
                ui.button("Close", icon="close", on_click=dialog.close).props("flat").classes("last")
            with parted:
                ui.label("" if other is None else f"This or {other.title}")
                split = html.input_(type="range", min=0, max=100).props("value=50")
                split.on("input", js_handler=self._sheet.parting())
        self._lines.props["title"] = "Each stroke as a line of its mean width, sharp however near"
        self._lines.visible, parted.visible = bool(self._strokes.lines), other is not None
        self._show()

    def _show(self) -> None:
        strokes, other = self._strokes, self._other
        sharp = bool(self._lines.visible and self._lines.value)
        above = "" if other is None else (sharp and other.lines) or other.source
        self._sheet.show(
            strokes.lines if sharp else strokes.source,
            f"The strokes of {strokes.title}",
            above,
            "" if other is None else other.title,
        )


def _draws_lines(plan: Plan) -> bool:
    """Return whether a plan is for a pen, or for a brush that is held as one: then its lines are as it is painted."""
    options = plan.request.options
    return is_pen(options.brush) or options.held_pressure is not None
