"""Dialog that asks for another title of a thing."""

from collections.abc import Awaitable, Callable
from inspect import isawaitable

from nicegui import html, ui

from maulstick.errors import MaulstickError
from maulstick.studio.state.titles import MOST_LETTERS
from maulstick.studio.wording import error_text


def rename_button(title: str, rename: Callable[[str], Awaitable[object] | None], hint: str = "") -> ui.button:
    """Make a small button that asks for another title.

    title: of the thing at present.  rename: called with what was typed; what it raises is shown beside the field.
    hint: what else a person should know.
    """
    button = ui.button(icon="edit", on_click=lambda: ask_for_title(title, rename, hint)).props("flat")
    button.props["aria-label"] = f"Rename {title}"
    return button.tooltip("Rename")


def ask_for_title(title: str, rename: Callable[[str], Awaitable[object] | None], hint: str = "") -> None:
    """Ask for another title, as `rename_button` does once it is pressed."""

    async def take() -> None:
        try:
            done = rename(str(field.value or ""))
            if isawaitable(done):
                await done
        except MaulstickError as error:
            field.error = error_text(error)
            return
        dialog.close()

    with ui.context.client.layout, ui.dialog(value=True) as dialog, ui.card().classes("sheet rename"):
        dialog.on("hide", dialog.delete).props["aria-label"] = f"Another name for {title}"
        html.h2(f"Another name for {title}")
        field = ui.input("New name", value=title).props(f"autofocus hide-bottom-space maxlength={MOST_LETTERS}")
        field.on("keydown.enter", take)
        if hint:
            ui.label(hint).classes("hint")
        with ui.element().classes("line acts"):
            ui.button("Rename", on_click=take)
            ui.button("Leave it", on_click=dialog.close).props("flat")
