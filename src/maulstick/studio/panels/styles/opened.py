"""Close look at a style: its sheet, and the map of its strokes."""

from dataclasses import replace

from nicegui import html, ui

from maulstick.studio.panels.styles.map import StrokeMap
from maulstick.studio.panels.styles.shown import AS_TURNED, about, address_of, sheet_picture, shown_later
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.renaming import ask_for_title
from maulstick.studio.workers.style_work import Map


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
        html.h1(entry.title).classes("title")
        ui.button("Paint with this hand", icon="brush", on_click=lambda: ui.navigate.to(f"/plan?style={name}"))
        if not entry.is_built_in:
            _rename_button(studio, name)
            ui.button("Delete", icon="delete", on_click=lambda: styles.delete(name)).props("outline")
    if entry.card is not None:
        html.p(f"{about(entry.card)}; from {entry.card.source}").classes("hint long")

    def show_map(found: Map) -> StrokeMap:
        return StrokeMap(replace(found, names=(entry.title,)))

    with ui.element().classes("halves"):
        with html.section().classes("sheet"):
            html.h2("The hand, and Maulstick in that hand")
            html.p(AS_TURNED).classes("hint")
            shown_later(
                "Drawing its sheet …",
                lambda: styles.sheet(name),
                lambda path: sheet_picture(path, f"Strokes by {entry.title}, and below them strokes drawn like them"),
            )
        with html.section().classes("sheet"):
            html.h2("Its strokes, sorted by likeness")
            shown_later("Finding out which strokes are alike …", lambda: styles.map_of([name]), show_map)
    return back


def _rename_button(studio: Studio, name: str) -> None:
    page, title = ui.context.client, studio.styles.own_title(name)

    async def rename(typed: str) -> None:
        new = await studio.styles.rename(name, typed)
        with page:  # what was shown of it may be gone
            ui.navigate.to(address_of([new]))
            ui.notify(f"{title} is called {studio.styles.title(new)} now. Plans that ask for it still find it.")

    ui.button("Rename", icon="edit", on_click=lambda: ask_for_title(title, rename)).props("outline")
