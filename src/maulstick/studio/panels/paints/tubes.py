"""Tubes of paint that the user has, from which recipes are made."""

from nicegui import events, html, ui

from maulstick.colour.tubes import USUAL_PAINTS, NamedPaint
from maulstick.errors import InputError
from maulstick.painting.painting import hex_colour
from maulstick.studio.state.mixing import tubes_csv
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.widgets.uploading import small_content, upload_button
from maulstick.studio.wording import error_text

_NEW = ("", "#888888")  # name and colour of a tube that nobody has written anything on yet


def build_tubes(studio: Studio) -> None:
    """Build the part of the page that lists the tubes, with a button to change them."""
    with html.section().classes("sheet").props('aria-label="Your tubes"'):
        html.h2("Your tubes")
        said = ui.label().classes("hint")
        tubes = html.ul().classes("tubes")
        with ui.element().classes("line"):
            ui.button("Change", icon="edit", on_click=lambda: _change(studio)).props("outline")

    def refresh() -> None:
        own, said.text = _tubes(studio)
        tubes.clear()
        with tubes:
            for tube in own:
                with html.li():
                    html.span().classes("dab").style(f"background: {hex_colour(tube.colour)}")
                    ui.label(tube.name)

    shown_by(tubes, studio.mixing.changed, refresh)


def _tubes(studio: Studio) -> tuple[tuple[NamedPaint, ...], str]:
    """Return the tubes and a sentence about them: none, and why, where a person has spoilt their file."""
    try:
        tubes = studio.mixing.tubes()
    except InputError as error:
        return (), error_text(error)
    if studio.mixing.has_own_tubes:
        return tubes, "Recipes are made from these."
    return tubes, "Recipes are made from a dozen usual acrylics, until you say which tubes you have."


def _change(studio: Studio) -> None:
    """Ask for the tubes in a small table; nothing is stored before “Keep these”."""
    rows: list[tuple[ui.element, ui.input, ui.input]] = []

    def add(name: str, colour: str) -> None:
        with table, ui.element().classes("tube") as row:
            picked = ui.input(value=colour).props('type=color dense borderless aria-label="Colour"')
            named = ui.input("Name", value=name).props("dense outlined maxlength=80")
            removing = ui.button(icon="close", on_click=lambda: remove(row)).props("flat round")
            removing.props["aria-label"] = f"Remove {name or 'this tube'}"
        rows.append((row, named, picked))

    def remove(row: ui.element) -> None:
        rows[:] = [each for each in rows if each[0] is not row]
        row.delete()

    def fill(tubes: list[tuple[str, str]]) -> None:
        rows.clear()
        table.clear()
        for name, colour in tubes:
            add(name, colour)

    async def keep() -> None:
        tubes = [(str(named.value or "").strip(), str(picked.value)) for _, named, picked in rows]
        await studio.mixing.use_tubes(tubes_csv(tube for tube in tubes if tube != _NEW))
        dialog.close()
        ui.notify("These are your tubes now; the recipes follow.")

    async def bring(event: events.UploadEventArguments) -> None:
        await studio.mixing.use_tubes(await small_content(event, "list of tubes"))
        dialog.close()
        ui.notify(f"{event.file.name} was read; the recipes follow.")

    with ui.dialog().props('aria-label="Your tubes"') as dialog, html.div().classes("sheet tube-table"):
        html.h2("Your tubes")
        html.p("What stands on each tube, and its colour as it dries.").classes("hint")
        table = ui.element().classes("rows")
        with ui.element().classes("line"):
            ui.button("Add a tube", icon="add", on_click=lambda: add(*_NEW)).props("outline")
            usual = [(tube.name, hex_colour(tube.colour)) for tube in USUAL_PAINTS]
            ui.button("The usual dozen", on_click=lambda: fill(usual)).props("flat")
            upload_button("From a file", ".csv,.json,.txt", bring).props("flat")
        with ui.element().classes("line end"):
            ui.button("Leave as it was", on_click=dialog.close).props("flat")
            ui.button("Keep these", icon="check", on_click=keep)
    fill([(tube.name, hex_colour(tube.colour)) for tube in _tubes(studio)[0]])
    dialog.on("hide", dialog.delete)
    dialog.open()
