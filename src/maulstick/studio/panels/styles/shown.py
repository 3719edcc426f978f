"""Elements that show a style, shared by the gallery, the close look and the comparison."""

from collections.abc import Awaitable, Callable, Sequence
from pathlib import Path
from typing import TypeVar

from nicegui import html, ui

from maulstick.errors import MaulstickError
from maulstick.studio.wording import error_text
from maulstick.style.cards import StyleCard

Result = TypeVar("Result")

AS_TURNED = "Each stroke is turned so that it begins on the left and ends on the right."
"""Note about sheets and maps, which show strokes as a style has them."""

_KINDS = {"exemplar": "learned from the strokes themselves", "trajvae": "learned by a small network"}


def address_of(names: Sequence[str]) -> str:
    """Address of the gallery, of the close look at a hand, or of a comparison, by the number of names."""
    query = "" if not names else f"?style={names[0]}" if len(names) == 1 else f"?compare={','.join(names)}"
    return f"/styles{query}"


def about(card: StyleCard) -> str:
    """Describe a style: its number of strokes, and how it was learned."""
    return f"{card.strokes} strokes, {_KINDS[card.settings.kind]}"


def sheet_picture(sheet: Path, alternative: str, classes: str = "picture") -> None:
    """Show the sheet of a style. alternative: text for people who do not see it."""
    html.img(src=f"/sheet/{sheet.name}", alt=alternative).classes(classes)


async def fill(place: ui.element, result_to_come: Awaitable[Result], show: Callable[[Result], object]) -> None:
    """Show a result in a place once it is there, or why there is none."""
    try:
        result = await result_to_come
    except MaulstickError as error:
        if not place.is_deleted:
            place.clear()
            with place:
                ui.label(f"This cannot be shown: {error_text(error)}").classes("fault")
        return
    if not place.is_deleted:
        place.clear()
        with place:
            show(result)


def shown_later(waiting: str, make: Callable[[], Awaitable[Result]], show: Callable[[Result], object]) -> None:
    """Show the text `waiting`, and replace it by the result of `make` once it is there; see `fill`."""
    place = ui.element().classes("later").props('aria-live="polite"')
    with place:
        ui.label(waiting).classes("hint waiting")
    ui.timer(0, lambda: fill(place, make(), show), once=True)
