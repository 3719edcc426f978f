"""Closer look at a plan: it fills the window, zoomed and moved, beside its picture or another plan."""

from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

from nicegui import background_tasks, html, ui

from maulstick.errors import MaulstickError
from maulstick.painting.raster import parse_size
from maulstick.studio.state.plan import Plan
from maulstick.studio.widgets.brushes import is_pen
from maulstick.studio.widgets.zoom import ZoomedSheet
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.plan_pictures import FIRST, LARGE, keep_large_picture
from maulstick.studio.workers.planner import TARGET

_LINES = "painting.svg"


@dataclass(frozen=True)
class Shown:
    """Picture on a page. source, lines: addresses of it as painted, and as sharp lines, "" where there are none.

    folder: of a plan, of which a larger picture can be made.
    """

    title: str
    source: str
    lines: str = ""
    folder: Path | None = None

    @classmethod
    def strokes(cls, plan: Plan, title: str) -> Self:
        """Return the strokes of a plan."""
        lines = f"/file/plans/{plan.name}/{_LINES}?{plan.planned}" if (plan.folder / _LINES).is_file() else ""
        return cls(title, f"/picture/plans/{plan.name}/{FIRST}?{plan.planned}", lines, plan.folder)

    @property
    def larger(self) -> Self:
        """The same with its larger picture."""
        return replace(self, source=self.source.replace(FIRST, LARGE))

    @classmethod
    def target(cls, plan: Plan) -> Self:
        """Return the picture that a plan is of."""
        return cls("its picture", f"/picture/plans/{plan.name}/{TARGET}")


class CloserLook:
    """Dialog, open at once, with a plan and what it is compared with, if anything."""

    def __init__(self, desk: Desk, plan: Plan, title: str, other: Shown | None) -> None:
        self._desk, self._strokes, self._other = desk, Shown.strokes(plan, title), other
        self._is_enlarged = False
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
                self._told = ui.label().classes("hint").props('role="status"')
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
        if not sharp and not self._is_enlarged:
            self._is_enlarged = True
            background_tasks.create(self._enlarge(), context=self._sheet)
        above = "" if other is None else (sharp and other.lines) or other.source
        self._sheet.show(
            strokes.lines if sharp else strokes.source,
            f"The strokes of {strokes.title}",
            above,
            "" if other is None else other.title,
        )

    async def _enlarge(self) -> None:
        """Show larger pictures of the plans once there are some; where there can be none, the first ones do."""
        self._told.set_text("Drawing it larger …")
        try:
            self._strokes = await self._larger(self._strokes)
            self._other = None if self._other is None else await self._larger(self._other)
        finally:
            if not self._sheet.is_deleted:
                self._told.set_text("")
                self._show()

    async def _larger(self, shown: Shown) -> Shown:
        if shown.folder is None:
            return shown
        with suppress(MaulstickError):
            return shown.larger if await self._desk.do(keep_large_picture, shown.folder) else shown
        return shown


def _draws_lines(plan: Plan) -> bool:
    """Return whether a plan is for a pen, or for a brush that is held as one: then its lines are as it is painted."""
    options = plan.request.options
    return is_pen(options.brush) or options.held_pressure is not None
