"""Choice of what a plan is drawn with: one brush or pen, and in colours further brushes beside it."""

from typing import Any

from nicegui import ui
from nicegui.elements.mixins.value_element import ValueElement

from maulstick.jobs.plan.options import PlanOptions
from maulstick.studio.widgets.brushes import brushes_for, is_pen

_USUAL = PlanOptions().brush


class BrushChoice:
    """Fields for a brush or a pen, and for more brushes. first: the field that has one.  fields: all of them."""

    def __init__(self) -> None:
        self.first = ui.select({}, label="Brush or pen").classes("whole")
        self._more = ui.select({}, label="More brushes", multiple=True, value=[]).classes("whole hinted")
        self._more.props("use-chips hint='The broadest paints first, the finest last.'")
        self.fields: tuple[ValueElement[Any], ...] = (self.first, self._more)
        self._offered = dict[str, str]()
        self.first.on_value_change(lambda: self._offer_more(self._more.value))

    @property
    def names(self) -> str:
        """Names of all that are chosen, as `PlanOptions.brush` takes them, the one of the first field first."""
        return ",".join((str(self.first.value), *self._more.value))

    @property
    def used(self) -> str:
        """Names of those that the plan is drawn with: where more are not asked for, the first."""
        return self.names if self._more.visible else str(self.first.value)

    def offer(self, machine: str, chosen: str) -> bool:
        """Offer what a machine of a kind draws with; return whether that has pens.

        chosen: names with commas between them; those that are offered are chosen, or else the usual one.
        """
        self._offered = brushes_for(machine)
        names = [name for name in chosen.split(",") if name in self._offered] or [_USUAL]
        self.first.set_options(self._offered, value=names[0])
        self._offer_more(names[1:])
        return any(map(is_pen, self._offered))

    def show(self, in_ink: bool) -> None:
        """Show the field for more brushes in paints, where the first is a brush. in_ink: whether there are none."""
        self._more.visible = not in_ink and not is_pen(str(self.first.value))

    def _offer_more(self, chosen: list[str]) -> None:
        """Offer all brushes but the first beside it; those of the chosen ones are chosen that are offered."""
        others = {name: words for name, words in self._offered.items() if not is_pen(name) and name != self.first.value}
        self._more.set_options(others, value=[name for name in dict.fromkeys(chosen) if name in others])


def are_offered(machine: str, names: str) -> bool:
    """Return whether a machine of a kind can draw with all of the names, which have commas between them."""
    return brushes_for(machine).keys() >= {*names.split(",")}
