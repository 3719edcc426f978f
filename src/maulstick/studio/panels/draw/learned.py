"""Learning a style from a hand, and showing it."""

from nicegui import Client, html, ui

from maulstick.errors import InputError
from maulstick.storage.text import counted
from maulstick.studio.panels.styles.shown import AS_TURNED, address_of
from maulstick.studio.state.studio import Studio
from maulstick.style.cards import STYLES

GOOD = 20
"""Strokes that make a good style: with fewer, it repeats them, and knows little of how they vary."""

_MISSING = (
    "it repeats them rather than varies, and knows few lengths, bends and pressures. "
    f"Draw {GOOD} or more, short and long, straight and bent, and learn it again."
)


async def learn_hand(studio: Studio, name: str, client: Client) -> None:
    """Learn a style with the hand's title, which replaces the user's style of that title, and show it to a client.

    Raises InputError where the hand has too few strokes, or its name belongs to a style that comes with Maulstick.
    """
    styles, hands = studio.styles, studio.drawing.hands
    style = styles.name_for(name, hands.title(name))
    old = STYLES.paths().get(style)
    if style == STYLES.taken or (old is not None and STYLES.is_built_in(old)):
        raise InputError(f"a style that comes with Maulstick is called {style}; give this hand another name")
    replaces = await styles.renew(style, lambda: hands.learn(name, style))
    card = hands.card(name)
    strokes = GOOD if card is None else card.strokes
    with client.layout:  # the page may show another panel by now
        _show(style, styles.titles()[style], f"/sheet/{(await styles.sheet(style)).name}", strokes, replaces)


def _show(name: str, title: str, sheet: str, strokes: int, replaces: bool) -> None:
    with ui.dialog(value=True) as dialog, ui.card().classes("sheet asks learned"):
        dialog.on("hide", dialog.delete).props["aria-label"] = f"This is how {title} draws"

        def go(where: str) -> None:
            dialog.close()
            ui.navigate.to(where)

        html.h2(f"This is how {title} draws")
        html.img(src=sheet, alt=f"Above, strokes that you drew; below, strokes in the style {title}").classes("picture")
        ui.label(AS_TURNED).classes("hint")
        if strokes < GOOD:
            ui.label(f"It was learned from {counted(strokes, 'stroke')}: {_MISSING}").classes("hint")
        if replaces:
            ui.label("The style of that name before lies in the trash; under Styles you can have it back.").classes(
                "hint"
            )
        with ui.element().classes("line"):
            ui.button("Plan a picture with it", on_click=lambda: go(f"/plan?style={name}"))
            ui.button("Look closer", on_click=lambda: go(address_of([name]))).props("outline")
            ui.button("Close", on_click=dialog.close).props("flat")
