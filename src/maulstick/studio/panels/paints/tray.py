"""Tray with wells of paint next to the sheet, where there is one."""

from nicegui import events, html, ui

from maulstick.errors import InputError
from maulstick.studio.state.mixing import RowOfWells
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.number_field import NumberField
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.widgets.undoing import offer_undo
from maulstick.studio.widgets.uploading import small_content, upload_button

_ROW = {
    "x": ("First well: mm right of the sheet's upper left corner", -60.0),
    "y": ("First well: mm below that corner", 20.0),
    "step": ("mm from each well down to the next", 40.0),
    "height": ("Tip in a well: mm above the paper, below it with a minus", -4.0),
    "clearance": ("Tip above everything: mm above the paper", 30.0),
    "reach": ("mm that one dip paints", 300.0),
}
"""Numbers of a row of wells: their labels and their defaults, millimetres."""


def build_tray(studio: Studio) -> None:
    """Build the part of the page that shows the tray, with buttons to set or remove one."""

    async def bring(event: events.UploadEventArguments) -> None:
        await studio.mixing.use_tray(await small_content(event, "tray"))
        ui.notify("The paints stand in this tray now.")

    def remove() -> None:
        trashed = studio.mixing.remove_tray()
        offer_undo(said.client, "The tray is removed.", lambda: studio.mixing.take_back(trashed))

    with html.section().classes("sheet").props('aria-label="The tray"'):
        html.h2("The tray")
        said = ui.label().classes("hint")
        with ui.element().classes("line"):
            ui.button("Put wells in a row", icon="more_vert", on_click=lambda: _lay(studio)).props("outline")
            upload_button("Bring a tray file", ".json", bring).props("flat")
            removing = ui.button("Remove", icon="delete", on_click=remove).props("flat")

    def refresh() -> None:
        removing.visible = studio.mixing.has_tray
        said.text = (
            "The machine dips into wells beside the sheet; each card says which."
            if studio.mixing.has_tray
            else "There is none: the machine stops and asks for each pen or brush. Or let it dip by itself, into wells "
            "beside the sheet."
        )

    shown_by(said, studio.mixing.changed, refresh)


def _lay(studio: Studio) -> None:
    """Ask for the place of a row of wells, and set it."""

    async def keep() -> None:
        if plan.value is None:
            raise InputError("no painting is planned yet; plan one, so that there are paints to put into wells")
        if any(number.value is None for number in numbers.values()):
            raise InputError("one of the numbers is missing; write it in")
        row = RowOfWells(**{name: 1e-3 * float(number.value) for name, number in numbers.items()})
        await studio.mixing.lay_tray(plan.value, row)
        dialog.close()
        ui.notify("The paints stand in this row now.")

    with ui.dialog().props('aria-label="Wells in a row"') as dialog, html.div().classes("sheet tube-table"):
        html.h2("Wells in a row")
        html.p(
            "The paints of one painting from top to bottom, then a well of water, then a cloth at paper height."
        ).classes("hint")
        plans = studio.mixing.plans()
        with ui.element().classes("rows"):
            plan = ui.select(plans, label="The painting", value=next(iter(plans), None)).props("outlined dense")
            numbers = {
                name: NumberField(label, value=usual).props("outlined dense") for name, (label, usual) in _ROW.items()
            }
        with ui.element().classes("line end"):
            ui.button("Leave as it was", on_click=dialog.close).props("flat")
            ui.button("Use this row", icon="check", on_click=keep)
    dialog.on("hide", dialog.delete)
    dialog.open()
