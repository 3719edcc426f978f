"""Choices that few plans need: the paper, the look of another picture, paints out of the tubes, and several tries."""

from pathlib import Path
from typing import Any

from nicegui import html, ui
from nicegui.elements.mixins.value_element import ValueElement

from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.request import MOST_TRIES
from maulstick.studio.state.settings import WHITE
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.number_field import NumberField
from maulstick.studio.widgets.showing import shown_by

_FIRST_VALUES = {"under": "", "look": ""}  # of what is for one picture, and is not kept for others
_USUAL = PlanOptions()


class MoreChoices:
    """Fields that are closed at first.

    kept: what the page keeps.  fields: those whose values are kept for other plans, `tries` among them.
    """

    def __init__(self, studio: Studio, kept: dict[str, Any]) -> None:
        self._studio, self._kept = studio, kept
        for name, value in _FIRST_VALUES.items():
            kept.setdefault(name, value)
        self.root = ui.expansion("More: paper, look, tubes, tries").classes("more")
        with self.root:
            with ui.element().classes("numbers"):
                self._paper = ui.color_input("Colour of the paper").bind_value(kept, "paper").classes("whole")
                self._under = ui.select({}, label="Or a photograph of it").bind_value(kept, "under").classes("whole")
                self._look = ui.select({}, label="With the look of").bind_value(kept, "look").classes("whole")
                self.tries = NumberField("Tries, the best one is kept", min=1, max=MOST_TRIES)
                self.tries.bind_value(kept, "tries").classes("whole")
            self._unmixed = ui.checkbox("Only the paints of your tubes, unmixed").bind_value(kept, "unmixed")
            html.p("Bring photographs and other pictures above, under “What to paint”; tubes stand under Mix.").classes(
                "hint"
            )
        self.fields: tuple[ValueElement[Any], ...] = (self._paper, self._unmixed, self.tries)
        shown_by(self.root, studio.gallery.changed, self._offer)
        shown_by(self.root, studio.mixing.changed, self._offer)

    def options(self, in_ink: bool) -> dict[str, Any]:
        """Return the options of these fields by their names. in_ink: whether the plan is in ink, and not in paints."""
        paper, under, look = (str(field.value or "") for field in (self._paper, self._under, self._look))
        tubes = self._studio.mixing.tubes_file if self._unmixed.value and not in_ink else None
        return {
            "paper": _USUAL.paper if paper.lower() == WHITE else paper,
            "background": self._studio.gallery.path(under) if under else None,
            "look": self._studio.gallery.path(look) if look else None,
            **({} if tubes is None else {"paints_from": tubes, "paints": None}),
        }

    def fill(self, options: PlanOptions) -> None:
        """Show the pictures that a plan was asked for; those that are not here any more are left out."""
        self._kept["under"], self._kept["look"] = self._name(options.background), self._name(options.look)

    def _offer(self) -> None:
        titles = self._studio.gallery.titles()
        for field, none in ((self._under, "No photograph"), (self._look, "No other picture")):
            field.set_options({"": none, **titles}, value=field.value if field.value in titles else "")
        self._unmixed.visible = self._studio.mixing.tubes_file is not None

    def _name(self, path: Path | None) -> str:
        gallery = self._studio.gallery
        return next((name for name in gallery.names() if gallery.path(name) == path), "")
