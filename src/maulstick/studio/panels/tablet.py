"""Way in for a tablet: a picture that its camera reads as the link, or how to let it in."""

import shlex
from dataclasses import dataclass
from pathlib import Path

from nicegui import html, ui

from maulstick.studio.state.studio import Studio

_PIXELS = 7  # of the page per square of the picture: a telephone reads it from half a metre


@dataclass(frozen=True)
class Door:
    """Way into the studio. link: with its token.  is_local: whether it leads in from this machine alone."""

    link: str
    is_local: bool


def tablet_button(studio: Studio, door: Door) -> None:
    """Show the button, and what it opens."""
    dialog = ui.dialog().props('aria-label="On a tablet"')
    with dialog:
        sheet = html.div().classes("sheet tablet")

    def open_dialog() -> None:
        sheet.clear()
        with sheet:
            html.h2("On a tablet")
            if door.is_local:
                _how_to_let_in(studio.folder.root)
            else:
                _way_in(door.link)  # now, so that the token is in no page as it is sent
            with ui.element().classes("line end"):
                ui.button("Close", on_click=dialog.close).props("flat autofocus")
        dialog.open()

    with ui.button(on_click=open_dialog).props('flat no-caps aria-label="On a tablet"').classes("on-a-tablet"):
        ui.icon("tablet_mac").props("aria-hidden=true")
        ui.label("On a tablet")
        ui.tooltip("Use this page on a tablet or a telephone")


def _way_in(link: str) -> None:
    import segno

    picture = segno.make(link, micro=False).svg_data_uri(scale=_PIXELS, light="#fff")
    html.p("Point the camera of the tablet at this picture. It must be in the same network as this computer.")
    html.img(src=picture, alt="The link, as a picture for the tablet's camera").classes("picture")
    html.p(link).classes("link")
    html.p("Whoever has this link can do all that you can do here.").classes("hint")


def _how_to_let_in(root: Path) -> None:
    html.p("Only this computer can open the studio now: close it in its terminal, and start it again like this:")
    html.p(f"maulstick studio {shlex.quote(str(root))} --host 0.0.0.0").classes("link")
