"""What was done can be undone for a while."""

from collections.abc import Callable

from nicegui import Client, html, ui
from nicegui.element import Element

_SECONDS = 20.0


def offer_undo(client: Client, done: str, undo: Callable[[], object]) -> None:
    """Say what was done on a client's page, with a button that undoes it."""
    with _place(client), html.div().classes("undo").props('role="status"') as bar:
        ui.label(done)

        def take_back() -> None:
            undo()
            bar.delete()

        ui.button("Undo", icon="undo", on_click=take_back).props("flat no-caps")
        ui.timer(_SECONDS, bar.delete, once=True)


def _place(client: Client) -> Element:
    """Where such offers stand on a page, one below the other."""
    there: Element | None = next((element for element in client.layout if "undos" in element.classes), None)
    if there is None:
        with client.layout:
            there = html.div().classes("undos")
    return there
