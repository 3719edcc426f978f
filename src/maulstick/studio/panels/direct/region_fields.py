"""Fields for what is said of one region of a plan."""

from collections.abc import Awaitable, Callable
from typing import Any

from nicegui import ui
from nicegui.elements.mixins.value_element import ValueElement

from maulstick.jobs.plan.options import LARGEST_HAND, LEAST_HAND
from maulstick.jobs.plan.region_descriptions import ALONG_GUIDES
from maulstick.robot.machines import kind_of
from maulstick.studio.state.plan import Plan
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.titles import MOST_LETTERS
from maulstick.studio.state.typed_numbers import number
from maulstick.studio.widgets.brushes import brushes_for
from maulstick.studio.widgets.number_field import NumberField
from maulstick.studio.workers.said import MOST_DEGREES, MOST_IMPORTANCE, SOFTEST, SaidRegion

_AS_THE_PLAN = "As in the plan"
_ONE_WAY = "one"
_WAYS = {"": "As the hand draws", _ONE_WAY: "One direction", ALONG_GUIDES: "Along the guides"}


class RegionFields:
    """Fields of the chosen region; they are hidden while there is none. say: says what is in them."""

    def __init__(self, studio: Studio, plan: Plan, say: Callable[[], Awaitable[None]]) -> None:
        self._studio, self._say, options = studio, say, plan.request.options
        self._brushes_of = {} if options.ink is not None else brushes_for(kind_of(options.robot or ""))
        self._shown: SaidRegion | None = None
        with ui.element().classes("fields-of-region") as self._root:
            self._name = ui.input("Name").props(f"maxlength={MOST_LETTERS}")
            self._bare = ui.checkbox("Bare paper: no ink here")
            with ui.element().classes("numbers") as self._inked:
                self._style = ui.select({}, label="Hand").classes("whole")
                self._size = NumberField("Size of the hand", min=0, max=LARGEST_HAND, step=0.1, suffix="times")
                self._importance = NumberField("Counts", min=0, max=MOST_IMPORTANCE, suffix="times")
                self._brush = ui.select({}, label="Brushes", multiple=True).classes("whole").props("use-chips")
                self._way = ui.select(_WAYS, label="Direction of strokes").classes("whole")
                self._degrees = NumberField("Clockwise from the right", min=-MOST_DEGREES, max=MOST_DEGREES, suffix="°")
                self._soft = NumberField("Soft edge", min=0, max=1e3 * SOFTEST, suffix="mm")
                self._degrees.classes("whole")
                self._soft.classes("whole")
        self._brush.visible = bool(self._brushes_of)
        for field in (self._name, self._size, self._importance, self._degrees, self._soft):
            field.on("blur", self._keep)
            field.on("keydown.enter", self._keep)
        for choice in (self._bare, self._style, self._brush, self._way):
            choice.on_value_change(self._keep)

    def show(self, region: SaidRegion | None) -> None:
        """Show what is said of a region, or hide the fields; what is typed stays where nothing else is said of it."""
        if region is not None and region == self._shown:
            return
        self._root.visible = region is not None
        self._shown = None  # or each field that is set would say it again
        if region is None:
            return
        hands = {"": _AS_THE_PLAN, **self._studio.styles.titles()}
        if region.style is not None:
            hands.setdefault(region.style, region.style)
        self._style.set_options(hands, value=region.style or "")
        brushes = [] if region.brush is None else region.brush.split(",")
        self._brush.set_options({**dict.fromkeys(brushes), **self._brushes_of}, value=brushes)
        way = "" if region.direction is None else ALONG_GUIDES if region.direction == ALONG_GUIDES else _ONE_WAY
        values: dict[ValueElement[Any], Any] = {
            self._name: region.name,
            self._bare: region.bare,
            self._size: region.hand_size or 1.0,
            self._importance: region.importance,
            self._way: way,
            self._degrees: region.direction if way == _ONE_WAY else 0.0,
            self._soft: 1e3 * region.soft,
        }
        for field, value in values.items():
            field.value = value
        self._inked.visible = not region.bare
        self._degrees.visible = way == _ONE_WAY
        self._shown = region

    async def _keep(self) -> None:
        if (region := self._shown) is not None:
            self._fill(region)
            await self._say()

    def _fill(self, region: SaidRegion) -> None:
        """Show in fields that a person has cleared what holds then."""
        empty: dict[ValueElement[Any], Any] = {
            self._name: region.name,
            self._size: 1.0,
            self._importance: region.importance,
            self._degrees: 0.0,
            self._soft: 0.0,
        }
        for field, value in empty.items():
            if field.value in (None, ""):
                field.value = value

    def values(self) -> dict[str, Any]:
        """Return what the fields say, by the names of `SaidRegion`. Raises InputError for a number out of its range."""
        size = number(self._size.value, "the size of the hand", LEAST_HAND, LARGEST_HAND, "times")
        degrees = number(self._degrees.value, "the direction", -MOST_DEGREES, MOST_DEGREES, "degrees")
        direction: object = {"": None, _ONE_WAY: degrees}.get(self._way.value, ALONG_GUIDES)
        return {
            "name": self._name.value,
            "bare": bool(self._bare.value),
            "style": self._style.value or None,
            "hand_size": None if size == 1 else size,
            "brush": ",".join(self._brush.value) or None,
            "importance": number(self._importance.value, "how much it counts", 0, MOST_IMPORTANCE, "times"),
            "direction": direction,
            "soft": 1e-3 * number(self._soft.value, "the width of the soft edge", 0, 1e3 * SOFTEST, "mm"),
        }
