"""Dialog that asks for the size of a new sheet."""

from nicegui import html, ui

from maulstick.errors import InputError
from maulstick.painting.raster import parse_size
from maulstick.studio.state.drawing import Drawing
from maulstick.studio.widgets.number_field import NumberField

_OWN = "own"
_SHEETS = {
    "A6": "A6",
    "A6-landscape": "A6, landscape",
    "A5": "A5",
    "A5-landscape": "A5, landscape",
    "A4": "A4",
    "A4-landscape": "A4, landscape",
    _OWN: "a size of your own",
}


def choose_sheet(drawing: Drawing) -> None:
    """Ask for a size, and begin a new sheet of that size on all pages."""
    with ui.dialog(value=True) as dialog, ui.card().classes("sheet asks"):
        dialog.props('aria-label="A new sheet"').on("hide", dialog.delete)
        html.h2("A new sheet")
        ui.label("What is on this one stays, below among your other hands.").classes("hint")
        size = ui.select(_SHEETS, value="A5-landscape", label="Size").props("outlined")
        with ui.element().classes("line").bind_visibility_from(size, "value", value=_OWN):
            width = NumberField("Width, mm", value=200, min=5).props("outlined")
            height = NumberField("Height, mm", value=150, min=5).props("outlined")

        async def take() -> None:
            chosen = str(size.value)
            if chosen == _OWN:
                if width.value is None or height.value is None:
                    raise InputError("the width or the height of the sheet is missing; write both")
                chosen = f"{width.value:g}x{height.value:g}mm"
            await drawing.begin(parse_size(chosen))
            dialog.close()

        with ui.element().classes("line"):
            ui.button("Take it", on_click=take)
            ui.button("Cancel", on_click=dialog.close).props("flat")
