"""Line of a plan's card for a note, with a star for the best ones."""

from nicegui import html, ui

from maulstick.studio.state.plan import Plan
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.titles import MOST_OF_A_NOTE, clean_title, label_of


class NoteLine:
    """Field whose text is kept with the plan once a person leaves it, and a button for the star."""

    def __init__(self, studio: Studio, plan: Plan) -> None:
        self._plans, self._plan = studio.plans, plan
        with html.div().classes("line note"):
            self._star = ui.button(icon="star_outline", on_click=self._turn).props("flat round dense")
            self._star.tooltip("Mark this plan as one of the best")
            self._field = ui.input(placeholder="Your note on this plan").props(f"dense maxlength={MOST_OF_A_NOTE}")
            self._field.props('aria-label="Your note"').classes("note-text")
            self._field.on("blur", self._keep).on("keydown.enter", self._keep)
        self._shown: str | None = None

    def show(self) -> None:
        """Show the note and the star, which another page may have changed."""
        label = label_of(self._plan.folder)
        self._star.props["icon"] = "star" if label.starred else "star_outline"
        self._star.props["aria-label"] = "Take the star away" if label.starred else "Give it a star"
        if label.note != self._shown:  # else somebody may be typing
            self._shown = label.note
            self._field.set_value(label.note)

    def _keep(self) -> None:
        if (typed := str(self._field.value or "")) != self._shown:
            self._plans.relabel(self._plan, note=clean_title(typed, MOST_OF_A_NOTE))

    def _turn(self) -> None:
        self._plans.relabel(self._plan, starred=not label_of(self._plan.folder).starred)
