"""Question for the photograph of a sheet, over which the rest of a plan is planned."""

from collections.abc import Awaitable, Callable

from nicegui import events, html, ui

from maulstick.studio.state.studio import Studio


def ask_for_photograph(studio: Studio, plan: Callable[[events.ClickEventArguments, str], Awaitable[None]]) -> None:
    """Ask in a dialog, open at once, which picture is the photograph. plan: called with the name of one."""
    with (
        ui.dialog(value=True).props('aria-label="A photograph of the sheet"') as dialog,
        html.div().classes("sheet saves"),
    ):
        html.h2("Plan over a photograph")
        html.p(
            "Draw on the sheet, if you like, take a photograph of it, and bring that under “Plan”, cut at the sheet's "
            "edges. What the machine has painted is planned no more; the rest goes on over what is there."
        ).classes("hint")
        chosen = ui.select(studio.gallery.titles(), label="Photograph of the sheet").props("outlined")
        with ui.element().classes("line end"):
            ui.button("Leave it", on_click=dialog.close).props("flat")
            go = ui.button("Plan the rest", icon="auto_awesome_mosaic")
            go.on_click(lambda event: plan(event, str(chosen.value))).bind_enabled_from(chosen, "value", bool)
    dialog.on("hide", dialog.delete)
