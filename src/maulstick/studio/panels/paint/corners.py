"""Corners of the sheet in the camera's photograph, which a person drags into place."""

from collections.abc import Callable
from math import isfinite
from pathlib import Path
from typing import final

from nicegui import events, html, ui
from nicegui.element import Element

from maulstick.jobs.paint.options import PaintOptions
from maulstick.painting.raster import parse_size
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.showing import as_source
from maulstick.studio.workers.camera_work import Corners, SeenSheet

_HOW = (
    "Drag each number onto its corner of the sheet: 1 is the upper left one of the plan, and 2 the upper right one. Or "
    "take one by Tab, and move it by arrow keys, finely with Shift."
)


@final
class SheetCorners(Element, component="corners.js"):
    """Photograph with four corners that are dragged. source: its address.  corners: where they are now."""

    def __init__(self, source: str, corners: Corners) -> None:
        super().__init__()
        self.corners = corners
        self._props.update(source=source, corners=[list(corner) for corner in corners])
        self.on("placed", self._take)

    def _take(self, event: events.GenericEventArguments) -> None:
        self.corners = corners_of(event.args) or self.corners


class CornersForm:
    """Form that says how the chosen camera finds the sheet, by tags or by corners, and lets a person show them.

    camera: returns its spec, or None where there is none to be shown anything.  plan: returns the name of the plan.
    touched: called after a person has changed anything.
    """

    def __init__(
        self, studio: Studio, camera: Callable[[], str | None], plan: Callable[[], str], touched: Callable[[], object]
    ) -> None:
        self._studio, self._camera, self._plan, self._touched = studio, camera, plan, touched
        with ui.element().classes("by-corners") as self.root:
            self._told = ui.label().classes("hint")
            with ui.element().classes("line"):
                self._show_it = ui.button("Show it the corners", icon="crop_free", on_click=self._see)
                self._show_it.props("outline no-caps")
                self._by_tags = ui.button("Use the tags", on_click=self._forget).props("flat no-caps")

    def show(self) -> None:
        """Show how the camera that is now chosen finds the sheet of the plan that is now chosen."""
        path = self._path
        self.root.visible = path is not None
        if path is not None:
            self._by_tags.visible = path.is_file()
            found = "the corners that you showed it" if path.is_file() else "the tags beside it"
            self._told.set_text(f"The camera finds the sheet by {found}.")

    def applied(self, options: PaintOptions, before: PaintOptions | None) -> PaintOptions:
        """Return the options with the camera's view of the sheet. before: of an earlier run that goes on."""
        path = self._path
        return options if path is None or options.camera is None else with_view(options, path, before)

    @property
    def _path(self) -> Path | None:
        camera, sheet = self._camera(), self._sheet
        return None if camera is None or sheet is None else self._studio.camera_views.path(camera, sheet).absolute()

    @property
    def _sheet(self) -> tuple[float, float] | None:
        plan = self._studio.plans.plans.get(self._plan())
        return None if plan is None else parse_size(plan.request.options.size)

    async def _see(self) -> None:
        camera, sheet = self._camera(), self._sheet
        if camera is None or sheet is None:
            return
        self._show_it.props("loading")
        try:
            seen = await self._studio.camera_views.see(camera, sheet)
        finally:
            self._show_it.props(remove="loading")
        with self.root:
            self._ask(camera, sheet, seen)

    def _ask(self, camera: str, sheet: tuple[float, float], seen: SeenSheet) -> None:
        with ui.dialog(value=True).props("full-width") as dialog, html.div().classes("sheet shows-corners"):
            dialog.on("hide", dialog.delete).props["aria-label"] = "The corners of the sheet"
            html.h2("The corners of the sheet")
            ui.label(_HOW).classes("hint")
            marked = SheetCorners(as_source(seen.photograph), seen.corners)

            async def keep() -> None:
                await self._studio.camera_views.keep(camera, sheet, seen, marked.corners)
                dialog.close()
                self._touched()

            with ui.element().classes("line end"):
                ui.button("Leave it", on_click=dialog.close).props("flat")
                ui.button("Keep these corners", icon="check", on_click=keep)

    def _forget(self) -> None:
        camera, sheet = self._camera(), self._sheet
        if camera is not None and sheet is not None:
            self._studio.camera_views.throw_away(camera, sheet)
            self._touched()


def with_view(options: PaintOptions, path: Path, before: PaintOptions | None) -> PaintOptions:
    """Return options with the view in the file `path`, where there is one.

    before: of an earlier run, whose own view stays, unless it was that file, which is gone.
    """
    if path.is_file():
        return options.model_copy(update={"view": path})
    return options.model_copy(update={"view": None}) if before is not None and before.view == path else options


def corners_of(sent: object) -> Corners | None:
    """Return the corners that a browser sent, or None where they are none."""
    if not isinstance(sent, list) or len(sent) != 4 or not all(isinstance(each, list) for each in sent):
        return None
    places = [[float(x) for x in place if isinstance(x, int | float) and isfinite(x) and 0 <= x <= 1] for place in sent]
    return tuple((place[0], place[1]) for place in places) if all(len(place) == 2 for place in places) else None
