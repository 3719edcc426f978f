"""Panel where paintings are planned: the form on the left, the plans on the right."""

from collections.abc import Mapping
from pathlib import Path

from nicegui import html, ui

from maulstick.studio.panels.plan.cards import PlanCards
from maulstick.studio.panels.plan.form import PlanForm
from maulstick.studio.state.studio import Studio
from maulstick.studio.workers.kept import SETTLED

_STYLE = Path(__file__).with_name("plan.css")
_CLOSER = Path(__file__).with_name("closer.css")


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the panel. query: `style` is chosen first."""
    studio.plans.look_again()
    ui.timer(SETTLED, studio.plans.be_ready, immediate=False)
    ui.add_css(_STYLE)
    ui.add_css(_CLOSER)
    with ui.element().classes("desk plan-desk") as desk:
        with ui.element().classes("intro"):
            html.h1("Plan a painting")
            html.p(
                "Choose a picture, and a hand: somebody's way of drawing. Watch the strokes find their places, "
                "and stop whenever you like it."
            ).classes("hint")
        with ui.element().classes("side"):
            with ui.element().classes("fields"):
                form = PlanForm(studio, query.get("style", ""), desk)
            form.add_button()
        with ui.element().classes("wide"):
            PlanCards(studio, again=form.fill)
