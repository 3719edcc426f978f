"""Regions and guides on the canvas of a plan: a list, what is said of the chosen one, and options of the tools."""

from nicegui import events, html, ui

from maulstick.errors import MaulstickError
from maulstick.studio.panels.direct.canvas import IMPORTANCE, SAYING, StrokeCanvas, numbers_of
from maulstick.studio.panels.direct.region_fields import RegionFields
from maulstick.studio.state.directing import Directing
from maulstick.studio.state.plan import Plan
from maulstick.studio.state.saying import BROADEST, THINNEST
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.typed_numbers import number
from maulstick.studio.state.versions import without_own_places
from maulstick.studio.widgets.number_field import NumberField
from maulstick.studio.workers.said import MOST_IMPORTANCE
from maulstick.studio.workers.stroke_marks import ShownSheet

_MOST_NUMBERS = 40_000  # of a line, two a point
_TIMES = 3.0  # how much more counts at first what is painted with the brush of importance
_BROAD, _SHARE = 20.0, 0.15  # its width at first, at most, in millimetres and in shares of the sheet's shorter side
_HINTS = {
    "region": "Drag a line around an area. What you say of it below holds there, over what lies under it.",
    "bare": "Drag a line around an area where no ink may lie.",
    IMPORTANCE: "Paint over what matters more. It takes the place of a region that lies under it.",
    "guide": "Drag a line along the way that strokes near it should take.",
}
"""What each tool does."""


class Places:
    """Part of the panel about regions and guides. plan, sheet: that they are said of."""

    def __init__(
        self, studio: Studio, plan: Plan, directing: Directing, canvas: StrokeCanvas, sheet: ShownSheet
    ) -> None:
        self._saying, self._canvas = directing.saying, canvas
        self._usual_broad = round(min(_BROAD, _SHARE * min(sheet.width, sheet.height)), 1)
        self._chosen: int | None = None
        self._rows: list[tuple[int, str, str, bool]] = []
        self._buttons: dict[int, ui.button] = {}
        self.root = ui.element().classes("sheet places")
        with self.root:
            self._hint = ui.label().classes("hint")
            with ui.element().classes("numbers") as self._brush:
                self._times = NumberField("Counts", value=_TIMES, min=0, max=MOST_IMPORTANCE, suffix="times")
                self._broad = NumberField("Brush", value=self._usual_broad, min=0, max=1e3 * BROADEST, suffix="mm")
                self._broad.on_value_change(self.show)
            if (foreign := without_own_places(plan.request, plan.folder).options.regions) is not None:
                told = f"This plan has the regions of {foreign.name}; those painted here take their place."
                html.p(told).classes("hint")
            self._list = html.ul().classes("said-places").props('aria-label="Regions and guides"')
            self._fields = RegionFields(studio, plan, self._say)
        canvas.on("said", self._draw)
        canvas.on("region", self._clicked)
        self.take_up("")

    def _fill(self) -> None:
        """Show in fields of the brush of importance that a person has cleared what holds then."""
        self._times.value = _TIMES if self._times.value is None else self._times.value
        self._broad.value = self._usual_broad if self._broad.value is None else self._broad.value

    def take_up(self, tool: str) -> None:
        """Show what is needed for a tool of `SAYING`, or nothing for another one."""
        self.root.visible = tool in SAYING
        self._hint.text = _HINTS.get(tool, "")
        self._brush.visible = tool == IMPORTANCE

    def show(self) -> None:
        """Show what is said now, here and on the canvas."""
        said = self._saying.now
        if self._chosen not in [each.id for each in (*said.regions, *said.guides)]:
            self._chosen = None
        seen = max(self._broad.value or self._usual_broad, 1e3 * THINNEST)  # also while a minus sign is typed
        self._canvas.show_places(said, self._chosen, seen)
        rows = [(each.id, each.name, each.colour, each.bare) for each in reversed(said.regions)]  # the topmost first
        rows += [(guide.id, f"Guide {place}", "", False) for place, guide in enumerate(said.guides, start=1)]
        if rows != self._rows:  # or what has the keyboard's focus would lose it
            self._rows = rows
            self._buttons = {}
            self._list.clear()
            with self._list:
                for id, name, colour, is_bare in rows:
                    self._buttons[id] = self._row(id, name, colour, is_bare=is_bare)
        for id, button in self._buttons.items():
            button.props["aria-pressed"] = "true" if id == self._chosen else "false"
        self._fields.show(next((each for each in said.regions if each.id == self._chosen), None))

    async def take_out(self) -> None:
        """Take out what is chosen."""
        if self._chosen is not None:
            await self._saying.take_out(self._chosen)

    def _row(self, id: int, name: str, colour: str, *, is_bare: bool) -> ui.button:
        """Make the row of a region or a guide; return the button that chooses it."""
        with html.li(), ui.element().classes("line row"):
            button = ui.button(on_click=lambda: self._choose(id)).props("flat align=left").classes("grow")
            with button:
                swatch = ui.element().classes("swatch").props("aria-hidden=true")
                if is_bare:
                    swatch.classes("bare").style(f"border-color: {colour}")
                elif colour:
                    swatch.style(f"background: {colour}")
                else:
                    swatch.classes("guide")
                ui.label(name).classes("name")
            away = ui.button(icon="delete", on_click=lambda: self._saying.take_out(id)).props("flat round dense")
            away.tooltip("Take it out").props["aria-label"] = f"Take out {name}"
        return button

    def _choose(self, id: int | None) -> None:
        self._chosen = None if id == self._chosen else id
        self.show()

    def _clicked(self, event: events.GenericEventArguments) -> None:
        self._chosen = event.args if isinstance(event.args, int) else None
        self.show()

    async def _say(self) -> None:
        """Say of the chosen region what is in its fields; what cannot be said is shown as it was."""
        if self._chosen is None:
            return
        try:
            await self._saying.change(self._chosen, **self._fields.values())
        except MaulstickError:
            self._fields.show(None)
            self.show()
            raise

    async def _draw(self, event: events.GenericEventArguments) -> None:
        sent = event.args if isinstance(event.args, dict) else {}
        points = [1e-3 * each for each in numbers_of(sent.get("points"), _MOST_NUMBERS)]
        try:
            self._chosen = await self._drawn(str(sent.get("tool")), points)
        except MaulstickError:
            self._canvas.run_method("run", "giveUp")
            raise
        self.show()

    async def _drawn(self, tool: str, points: list[float]) -> int:
        """Say what a line of a tool says; return the id of the region or the guide."""
        if tool == "guide":
            return await self._saying.guide(points)
        if tool == IMPORTANCE:
            self._fill()
            times = number(self._times.value, "how much it counts", 0, MOST_IMPORTANCE, "times")
            return await self._saying.emphasise(points, 1e-3 * (self._broad.value or 0), times)
        return await self._saying.enclose(points, bare=tool == "bare")
