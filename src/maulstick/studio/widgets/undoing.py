"""Offer to undo what was just done."""

from collections.abc import Callable

from nicegui import Client, html, ui
from nicegui.element import Element

_SECONDS = 20.0  # for which the offer is shown: enough to notice a mistake


def offer_undo(client: Client, done: str, undo: Callable[[], object]) -> None:
    """Show on a client's page what was done, with a button that undoes it."""
    with _place(client), html.div().classes("undo").props('role="status"') as bar:
        ui.label(done)

        def take_back() -> None:
            undo()
            bar.delete()

        ui.button("Undo", icon="undo", on_click=take_back).props("flat no-caps")
        ui.timer(_SECONDS, bar.delete, once=True)


def _place(client: Client) -> Element:
    """Find or make the element of a page that holds all such offers."""
    there: Element | None = next((element for element in client.layout if "undos" in element.classes), None)
    if there is None:
        with client.layout:
            there = html.div().classes("undos")
    return there
