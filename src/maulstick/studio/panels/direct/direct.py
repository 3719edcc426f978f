"""Panel on which a person directs a finished plan: its strokes on a large canvas, and what can be done with them."""

from pathlib import Path
from typing import Any

from nicegui import background_tasks, events, html, ui

from maulstick.errors import InputError, MaulstickError
from maulstick.robot.journal import journal_of, was_begun
from maulstick.studio.panels.direct.canvas import CHOOSE, DRAW, SAYING, TOOLS, StrokeCanvas, numbers_of
from maulstick.studio.panels.direct.chosen import ChosenStrokes
from maulstick.studio.panels.direct.photograph import ask_for_photograph
from maulstick.studio.panels.direct.places import Places
from maulstick.studio.panels.plan.exporting import ExportDialog
from maulstick.studio.state.directing import Directing
from maulstick.studio.state.plan import Plan
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.titles import file_name
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.wording import error_text
from maulstick.studio.workers.kept import SETTLED
from maulstick.studio.workers.planner import TARGET
from maulstick.studio.workers.stroke_marks import ShownSheet

_STYLE = Path(__file__).with_name("direct.css")
_CLOSER = Path(__file__).parents[1] / "plan" / "closer.css"  # of the dialog that saves
_NOW = "edited.json"  # file in a plan's folder: the painting with all acts, when it was saved last
_MOST_NUMBERS = 60_000  # of a stroke that is drawn, three a point
_KEYS = {
    "V, H, B": "choose, look around, draw",
    "R, P": "a region, bare paper",
    "I, G": "importance, a guide",
    "Space": "hold it to look around",
    "+ - 0 1": "nearer, farther, all, true size",
    "M": "the loupe",
    ". and ,": "the next stroke, the one before; with Shift as well",
    "Ctrl A, N": "choose all, none",
    "Arrows": "move by 1 mm, with Shift 0.1 mm",
    "[ and ]": "turn by 5°, with Shift 1°",
    "L, Delete": "lock or unlock, take out",
    "Ctrl Z, Y": "undo, redo",
}
"""Keys of the canvas, and what they do."""


def build(studio: Studio, name: str) -> None:
    """Build the panel of the plan of that name."""
    studio.plans.look_again()
    ui.timer(SETTLED, studio.plans.be_ready, immediate=False)
    ui.add_css(_STYLE)
    ui.add_css(_CLOSER)
    try:
        directing, plan = studio.directing(name), studio.plans.of(name)
    except InputError as error:
        html.h1("There is nothing to direct")
        html.p(f"{error_text(error)[0].upper()}{error_text(error)[1:]}.").classes("hint")
        ui.button("Go to the plans", icon="arrow_back", on_click=lambda: ui.navigate.to("/plan")).props("outline")
        return
    title = studio.plans.titles().get(name, name)
    with ui.element().classes("line"):
        html.h1(f"Direct {title}")
        ui.button("All plans", icon="arrow_back", on_click=lambda: ui.navigate.to("/plan")).props("flat")
    place = ui.element().classes("desk directing")
    with place:
        reading = ui.label("Reading the strokes …").classes("hint").props('role="status"')

    async def lay_out() -> None:
        try:
            sheet = await directing.sheet()
        except MaulstickError as error:
            reading.set_text(error_text(error))
            return
        if not place.is_deleted:
            place.clear()
            with place:
                _Directed(studio, plan, directing, sheet, title)

    background_tasks.create(lay_out(), context=place)

    def look() -> None:
        """Load the page again where the plan is gone, or goes on: what is done here would be done to other strokes."""
        try:
            is_same = studio.directing(name) is directing
        except InputError:
            is_same = False
        if not is_same:
            ui.navigate.reload()

    shown_by(place, studio.plans.changed, look)


class _Directed:
    """Canvas of a plan with its tools beside it."""

    def __init__(self, studio: Studio, plan: Plan, directing: Directing, sheet: ShownSheet, title: str) -> None:
        self._studio, self._plan, self._directing = studio, plan, directing
        self._tool, self._makes_version = CHOOSE, False
        picture = f"/picture/plans/{plan.name}/{TARGET}" if (plan.folder / TARGET).is_file() else ""
        side = ui.element().classes("side")
        with ui.element().classes("wide"):
            label = f"The strokes of {title}: , and . choose one after the other, + and - zoom, arrow keys move"
            self._canvas = StrokeCanvas(plan.name, sheet, directing.version, picture, label)
        with side:
            self._tools(picture)
            self._history()
            self._chosen = ChosenStrokes(sheet, self._canvas, self._edit, self._show_tool)
            self._places = Places(studio, plan, directing, self._canvas, sheet)
            self._versions()
            self._keys()
        self._canvas.on("chosen", self._chosen.take)
        self._canvas.on("moved", self._move)
        self._canvas.on("drawn", self._draw)
        self._canvas.on("ask", self._asked)
        self._canvas.on("refused", lambda event: ui.notify(str(event.args), type="negative"))
        shown_by(self._canvas, directing.changed, self._show)

    def _tools(self, picture: str) -> None:
        canvas = self._canvas
        with ui.element().classes("sheet"):
            self._tools_of = [self._toggle(TOOLS, "Tool"), self._toggle(SAYING, "Say something of a place")]
            self._tools_of[0].value = CHOOSE
            with ui.element().classes("zooms"):
                canvas.buttons()
            if picture:
                with html.label().classes("weight"):
                    ui.label("Strokes or picture")
                    fader = html.input_(type="range", min=0, max=100).props("value=0")
                    fader.on("input", js_handler=canvas.calling("fade", "Number(event.target.value) / 100"))
            marks = ui.checkbox("Mark what is locked", value=True)
            marks.on("update:model-value", js_handler=canvas.calling("showLocks", "event"))
            regions = ui.checkbox("Show regions and guides", value=True)
            regions.on("update:model-value", js_handler=canvas.calling("showRegions", "event"))

    def _toggle(self, tools: dict[str, str], label: str) -> ui.toggle:
        toggle = ui.toggle(tools, on_change=lambda event: self._take_up(event.value)).props("spread no-caps")
        toggle.props["aria-label"] = label
        return toggle

    def _history(self) -> None:
        with ui.element().classes("acts"):
            self._undo = ui.button("Undo", icon="undo", on_click=self._directing.undo).props("outline")
            self._redo = ui.button("Redo", icon="redo", on_click=self._directing.redo).props("outline")

    def _versions(self) -> None:
        again = ui.button("Plan again around this", icon="auto_awesome_mosaic", on_click=self._plan_again)
        again.tooltip("A new version: what is locked stays as it is, the rest is planned on from where it is")
        if was_begun(journal_of(self._plan.folder / "painting.json")):
            over = ui.button("Plan over a photograph …", icon="photo_camera", on_click=self._ask_for_photograph)
            over.props("outline").tooltip("A new version of what is not painted yet, over what is on the sheet by now")
        keep = ui.button("Keep as a version", icon="content_copy", on_click=self._keep).props("outline")
        keep.tooltip("A new version with the strokes as they are now, to be painted without planning")
        ui.button("Save this as it is …", icon="download", on_click=self._save).props("outline")

    async def _save(self) -> None:
        """Offer the painting with all acts as a file, without planning."""
        await self._directing.write(now := self._plan.folder / _NOW)
        with self._canvas:
            ExportDialog(self._studio.desk, now, file_name(self._plan.title, ""))

    async def _plan_again(self, event: events.ClickEventArguments) -> None:
        await self._make_version(event)

    async def _keep(self, event: events.ClickEventArguments) -> None:
        await self._make_version(event, is_kept=True)

    def _ask_for_photograph(self) -> None:
        with self._canvas:
            ask_for_photograph(self._studio, lambda event, name: self._make_version(event, photograph=name))

    async def _make_version(
        self, event: events.ClickEventArguments, *, is_kept: bool = False, photograph: str = ""
    ) -> None:
        if self._makes_version:  # by the first click of two
            return
        self._makes_version, button = True, event.sender
        button.props("loading")
        try:
            await self._studio.version_of(self._plan.name, is_kept=is_kept, photograph=photograph)
        finally:
            button.props(remove="loading")
            self._makes_version = False
        if not self._canvas.is_deleted:  # with the panel
            ui.navigate.to("/plan")

    def _keys(self) -> None:
        with ui.expansion("Keys", icon="keyboard").props("dense"), html.dl().classes("keys"):
            for key, what in _KEYS.items():
                html.dt(key)
                html.dd(what)

    def _show(self) -> None:
        self._canvas.show(self._directing.version)
        self._undo.set_enabled(self._directing.can_undo)
        self._redo.set_enabled(self._directing.can_redo)
        self._places.show()

    def _take_up(self, tool: str | None) -> None:
        """Take up a tool of either toggle; what the other one shows is laid down."""
        if tool is None or tool == self._tool:
            return
        self._tool = tool
        for toggle, tools in zip(self._tools_of, (TOOLS, SAYING), strict=True):
            toggle.value = tool if tool in tools else None
        self._chosen.root.visible = tool in TOOLS
        self._places.take_up(tool)
        self._show_tool()

    def _show_tool(self) -> None:
        self._chosen.show_paint(draws=self._tool == DRAW)
        self._canvas.take_up(self._tool, self._chosen.paint)

    async def _edit(self, edit: dict[str, Any]) -> None:
        try:
            await self._directing.edit(edit)
        except MaulstickError:
            self._canvas.run_method("run", "giveUp")
            raise

    async def _move(self, event: events.GenericEventArguments) -> None:
        sent = event.args if isinstance(event.args, dict) else {}
        by = [1e-3 * each for each in numbers_of(sent.get("by"), 2)]
        await self._edit({"kind": "move", "strokes": sent.get("strokes"), "by": by, "turn": sent.get("turn")})

    async def _draw(self, event: events.GenericEventArguments) -> None:
        sent = event.args if isinstance(event.args, dict) else {}
        points = numbers_of(sent.get("points"), _MOST_NUMBERS)
        metres = [each if i % 3 == 2 else 1e-3 * each for i, each in enumerate(points)]
        try:
            await self._directing.draw(self._chosen.paint, metres)
        except MaulstickError:
            self._canvas.run_method("run", "giveUp")
            raise

    async def _asked(self, event: events.GenericEventArguments) -> None:
        """Do what a key asks for."""
        match event.args:
            case "undo":
                await self._directing.undo()
            case "redo":
                await self._directing.redo()
            case "remove" | "lock":
                await self._chosen.do(event.args)
            case "take_out":
                await self._places.take_out()
            case tool if tool in TOOLS or tool in SAYING:
                self._take_up(tool)
