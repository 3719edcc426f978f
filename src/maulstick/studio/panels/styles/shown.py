"""What the styles look like wherever they are shown."""

from collections.abc import Awaitable, Callable, Sequence
from pathlib import Path
from typing import TypeVar

from nicegui import html, ui

from maulstick.errors import MaulstickError
from maulstick.studio.wording import said
from maulstick.style.cards import StyleCard

Result = TypeVar("Result")

AS_TURNED = "Each stroke is turned so that it begins on the left and ends on the right."
"""Of the sheets and the maps, which show strokes as a style knows them."""

_KINDS = {"exemplar": "learned from the strokes themselves", "trajvae": "learned by a small network"}


def address_of(names: Sequence[str]) -> str:
    """Where the gallery of the hands is, one of them looked at closely, or some side by side."""
    asked = "" if not names else f"?style={names[0]}" if len(names) == 1 else f"?compare={','.join(names)}"
    return f"/styles{asked}"


def about(card: StyleCard) -> str:
    """How many strokes a style has, and how it was learned."""
    return f"{card.strokes} strokes, {_KINDS[card.settings.kind]}"


def sheet_picture(sheet: Path, alternative: str, classes: str = "picture") -> None:
    """The sheet of a style. alternative: what is told of it to those who do not see it."""
    html.img(src=f"/sheet/{sheet.name}", alt=alternative).classes(classes)


async def fill(place: ui.element, asked: Awaitable[Result], show: Callable[[Result], object]) -> None:
    """Show in a place what was asked for once it comes, or why it does not."""
    try:
        result = await asked
    except MaulstickError as error:
        if not place.is_deleted:
            place.clear()
            with place:
                ui.label(f"This cannot be shown: {said(error)}").classes("fault")
        return
    if not place.is_deleted:
        place.clear()
        with place:
            show(result)


def shown_later(waiting: str, ask: Callable[[], Awaitable[Result]], show: Callable[[Result], object]) -> None:
    """Leave a place with a calm word in it, and `fill` it."""
    place = ui.element().classes("later").props('aria-live="polite"')
    with place:
        ui.label(waiting).classes("hint waiting")
    ui.timer(0, lambda: fill(place, ask(), show), once=True)
