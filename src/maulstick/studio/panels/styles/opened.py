"""Close look at a style: its sheet, and the map of its strokes."""

from nicegui import html, ui

from maulstick.errors import MaulstickError
from maulstick.studio.panels.styles.map import StrokeMap
from maulstick.studio.panels.styles.shown import AS_TURNED, about, address_of, sheet_picture, shown_later
from maulstick.studio.state.studio import Studio
from maulstick.studio.wording import error_text


def show_opened(studio: Studio, name: str) -> ui.element:
    """Build the close look; return the element to focus."""
    styles = studio.styles
    entry = styles.entry(name)
    back = (
        ui.button("All hands", icon="arrow_back", on_click=lambda: ui.navigate.to(address_of([])))
        .props("flat")
        .classes("back")
    )
    with ui.element().classes("line"):
        html.h1(name).classes("title")
        ui.button("Paint with this hand", icon="brush", on_click=lambda: ui.navigate.to(f"/plan?style={name}"))
        if not entry.is_built_in:
            rename = _rename_dialog(studio, name)
            ui.button("Rename", icon="edit", on_click=rename.open).props("outline")
            ui.button("Delete", icon="delete", on_click=lambda: styles.delete(name)).props("outline")
    if entry.card is not None:
        html.p(f"{about(entry.card)}; from {entry.card.source}").classes("hint long")
    with ui.element().classes("halves"):
        with html.section().classes("sheet"):
            html.h2("The hand, and Maulstick in that hand")
            html.p(AS_TURNED).classes("hint")
            shown_later(
                "Drawing its sheet …",
                lambda: styles.sheet(name),
                lambda path: sheet_picture(path, f"Strokes by the hand {name}, and below them strokes drawn like them"),
            )
        with html.section().classes("sheet"):
            html.h2("Its strokes, sorted by likeness")
            shown_later("Finding out which strokes are alike …", lambda: styles.map_of([name]), StrokeMap)
    return back


def _rename_dialog(studio: Studio, name: str) -> ui.dialog:
    async def rename() -> None:
        page, new = ui.context.client, (field.value or "").strip()
        try:
            await studio.styles.rename(name, new)
        except MaulstickError as error:
            field.error = error_text(error)
            return
        with page:  # this dialog is gone
            ui.navigate.to(address_of([new]))
            ui.notify(f"{name} is called {new} now. Plans that ask for {name} still find it.")

    with ui.dialog() as dialog, ui.card().classes("sheet rename"):
        dialog.props(f'aria-label="Another name for {name}"')
        html.h2(f"Another name for {name}")
        field = ui.input("New name", value=name).props(
            'autofocus hide-bottom-space maxlength=40 hint="Letters a to z, digits and -"'
        )
        field.on("keydown.enter", rename)
        with ui.element().classes("line acts"):
            ui.button("Rename", on_click=rename)
            ui.button("Leave it", on_click=dialog.close).props("flat")
    return dialog
