"""Panel of what was thrown away: each thing with its picture, and a button that puts it back."""

from collections.abc import Mapping
from pathlib import Path

from nicegui import html, ui

from maulstick.studio.state.presets import PRESETS_FOLDER
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.thrown import STYLES_FOLDER
from maulstick.studio.state.trash import Thrown
from maulstick.studio.widgets.showing import shown_by

_STYLE = Path(__file__).with_name("trash.css")
_MOST_SHOWN = 200  # things that a page shows at once
_KINDS = {
    "hands": "Hand",
    "pictures": "Picture",
    "plans": "Plan",
    "drawings": "Drawing",
    "surveys": "Survey, with its answers",
    STYLES_FOLDER: "Learned hand",
    PRESETS_FOLDER: "Settings kept for plans",
    "easels": "Where a sheet lay",
    "cameras": "Where a camera saw it",
    ".": "Settings",
}
"""Words for things, by the folder that they were in."""

_TITLE_STAYS = "It can come back under a free one; its title stays."
_STAYS = {"surveys": "It can come back under a free one, but links that were given out ask for the old one."}
"""What another name means for a thing, by the folder that it was in."""


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the panel. query: not used."""
    ui.add_css(_STYLE)
    html.h1("Trash")
    html.p(
        "All that was thrown away, the latest first. It stays here until you delete it from the disk yourself."
    ).classes("hint")
    _Things(studio)


class _Things:
    """List of all things in the trash."""

    def __init__(self, studio: Studio) -> None:
        self._studio, self._shown = studio, list[Thrown]()
        self._empty = html.p("Nothing was thrown away.")
        self._list = html.ul().classes("thrown")
        states = (studio.plans, studio.drawing.hands, studio.gallery, studio.svgs, studio.surveys, studio.styles)
        for state in (*states, studio.mixing, studio.presets):
            shown_by(self._list, state.changed, self._show)

    def _show(self) -> None:
        things = self._studio.trash.things()
        self._empty.visible = not things
        if things == self._shown:
            return
        self._shown = things
        self._list.clear()
        with self._list:
            for thing in things[:_MOST_SHOWN]:
                self._row(thing)
            if len(things) > _MOST_SHOWN:
                html.li(f"and {len(things) - _MOST_SHOWN} older ones, which are in the folder trash").classes("hint")

    def _row(self, thing: Thrown) -> None:
        with html.li().classes("sheet") as row:
            row.props["aria-label"] = thing.title
            if self._studio.trash.picture(thing.id) is not None:
                html.img(src=f"/thrown/{thing.id}", alt="").props("loading=lazy")
            else:
                ui.icon("description").classes("none").props("aria-hidden=true")
            with ui.element().classes("about"):
                html.h2(thing.title)
                kind = _KINDS.get(thing.where or "", "Files of an earlier Maulstick")
                html.p(f"{kind} · {thing.when:%-d %B %Y, %H:%M}").classes("hint figure")
                refusal = ui.label().classes("hint").props('role="alert"')
            if thing.where is None:
                html.p(f"Nothing says where it was; it lies in trash/{thing.id}").classes("hint")
                return
            back = ui.button("Put back", icon="undo").props("outline")
            back.props["aria-label"] = f"Put {thing.title} back"
            back.on_click(lambda: self._put_back(thing, back, refusal))

    def _put_back(self, thing: Thrown, back: ui.button, refusal: ui.label) -> None:
        """Put a thing back; where its name is taken, say so and offer a free one."""
        trash, page = self._studio.trash, ui.context.client
        name = trash.free_name(thing)
        if name != thing.name and back.text != (offer := f"Put back as {name}"):
            stays = _STAYS.get(thing.where or "", _TITLE_STAYS)
            refusal.text = f"Another one has its name, {thing.name}, by now. {stays}"
            back.text = offer
            back.props["aria-label"] = f"Put {thing.title} back as {name}"
            return
        trash.put_back(trash.thing(thing.id), name)
        self._show()  # files of settings tell nobody
        with page:  # the row is gone
            ui.notify(f"{thing.title} is back.", type="positive")
