"""Panel where paintings are planned: the form on the left, the plans on the right."""

from collections.abc import Mapping
from pathlib import Path

from nicegui import html, ui

from maulstick.studio.panels.plan.card import PlanCard
from maulstick.studio.panels.plan.form import PlanForm
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.showing import shown_by

_STYLE = Path(__file__).with_name("plan.css")


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the panel. query: `style` is chosen first."""
    ui.add_css(_STYLE)
    html.h1("Plan a painting")
    html.p(
        "Choose a picture, and a hand: somebody's way of drawing. Watch the strokes find their places, "
        "and stop whenever you like it."
    ).classes("hint")
    with ui.element().classes("desk"):
        with ui.element().classes("side"):
            PlanForm(studio, query.get("style", ""))
        with ui.element().classes("wide"):
            _plans(studio)


def _plans(studio: Studio) -> None:
    """Show one card per plan, the newest first; a card stays in place while others come and go."""
    plans = studio.plans
    shown: dict[str, PlanCard] = {}
    nothing = html.p("Nothing is planned yet. Your plans will stand here side by side.").classes("hint")
    grid = ui.element().classes("plans")

    def refresh() -> None:
        nothing.visible = not plans.plans
        for name in [name for name in shown if shown[name].plan is not plans.plans.get(name)]:
            shown.pop(name).delete()
        for name, plan in plans.plans.items():
            if name not in shown:
                with grid:
                    shown[name] = PlanCard(studio, plan)
                shown[name].come_first()
            shown[name].show()

    shown_by(grid, plans.changed, refresh)
