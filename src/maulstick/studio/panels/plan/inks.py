"""Choice of the inks that a plan is drawn in: one, and others beside it."""

from typing import Any

from nicegui import ui
from nicegui.elements.mixins.value_element import ValueElement


class InkChoice:
    """Fields for an ink, and for more inks. first: the field that has one.  fields: all of them.

    kept: what the page keeps.
    """

    def __init__(self, kept: dict[str, Any]) -> None:
        self.first = ui.color_input("The ink").bind_value(kept, "ink")
        self._more = ui.input_chips("More inks", new_value_mode="add-unique").bind_value(kept, "more_inks")
        self._more.classes("whole hinted").props("hint='As red or #a04020 and Enter, each with a pen of its own.'")
        self.fields: tuple[ValueElement[Any], ...] = (self.first, self._more)

    @property
    def colours(self) -> str:
        """Colours of all inks, as `PlanOptions.ink` takes them."""
        return ",".join((str(self.first.value), *self._more.value))

    def show(self, in_ink: bool) -> None:
        """Show the fields where the plan is in ink, and not in paints."""
        self.first.visible = self._more.visible = in_ink
