"""Panel of styles: a gallery of hands, the close look at one, or a comparison of some."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from nicegui import app, html, ui

from maulstick.studio.panels.styles.compared import show_compared
from maulstick.studio.panels.styles.opened import show_opened
from maulstick.studio.panels.styles.shown import AS_TURNED, about, address_of, fill, sheet_picture
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.styles import MOST, DeletedStyle, Entry
from maulstick.studio.widgets.showing import focus, shown_by
from maulstick.style.cards import StyleCard

_STYLE = Path(__file__).with_name("styles.css")
_LEFT, _TICKED = "style-left", "styles-ticked"  # keys of what a page remembers


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the panel. query: `style` is the hand to look at closely, `compare` those to compare, as in a,b."""
    ui.add_css(_STYLE)
    wanted = [query["style"]] if "style" in query else query.get("compare", "").split(",")
    names = studio.styles.names()
    StylesPanel(studio, [name for name in dict.fromkeys(wanted) if name in names][:MOST])


class StylesPanel:
    """Panel by the address of the page. looked_at: none for the gallery, one for the close look, some to compare."""

    def __init__(self, studio: Studio, looked_at: Sequence[str]) -> None:
        self._studio, self._looked_at = studio, looked_at
        self._kept = app.storage.client  # for as long as the page is open, whatever it shows
        self._root = ui.element().classes("styles")
        if looked_at:
            self._look_closely()
        shown_by(self._root, studio.styles.changed, self._follow)

    def _look_closely(self) -> None:
        with self._root:
            if len(self._looked_at) == 1:
                self._kept[_LEFT] = self._looked_at[0]
                way_out = show_opened(self._studio, self._looked_at[0])
            else:
                self._kept[_TICKED] = list(self._looked_at)
                way_out = show_compared(self._studio, self._looked_at)
        if not ui.context.client.sub_pages_router.is_initial_request:
            focus(way_out)

    def _follow(self) -> None:
        """Rebuild the gallery; leave a close look or a comparison as it is while its styles exist."""
        if not self._looked_at:
            self._root.clear()
            with self._root:
                self._gallery()
        elif not set(self._looked_at) <= set(self._studio.styles.names()):
            ui.navigate.to(address_of([]))

    def _gallery(self) -> None:
        styles = self._studio.styles
        self._ticked = [name for name in self._kept.get(_TICKED, []) if name in styles.names()]
        html.h1("Hands to paint with")
        html.p(
            "Each sheet shows what a person drew and, below it, what Maulstick draws in that hand. "
            f"{AS_TURNED} Look closer at one, or tick a few to see how they differ."
        ).classes("hint")
        self._titles = styles.titles()
        ways_in = {deleted.name: self._deleted(deleted) for deleted in styles.thrown_away[-3:]}
        with ui.element().classes("line chosen"):
            self._compare = ui.button("Compare", icon="compare", on_click=lambda: _look_at(self._ticked))
            self._told = ui.label().classes("hint").props('role="status"')
            ui.button("Draw your own", icon="draw", on_click=lambda: ui.navigate.to("/")).props("outline")
        sheets: dict[str, ui.element] = {}
        with ui.element().classes("cards"):
            for entry in map(styles.entry, styles.names()):
                with html.article().classes("sheet style-card") as article:
                    article.props["aria-label"] = entry.title
                    if entry.card is None:
                        self._broken(entry)
                    else:
                        sheets[entry.name], ways_in[entry.name] = self._card(entry, entry.card)
        self._count()
        ui.timer(0, lambda: self._draw(sheets), once=True)
        left = self._kept.pop(_LEFT, "")
        if left in ways_in:
            focus(ways_in[left])

    def _deleted(self, deleted: DeletedStyle) -> ui.element:
        """Show a line about a deleted style; return its button that undoes it."""
        with ui.element().classes("line notice").props('role="status"'):
            ui.label(f"{deleted.title} is deleted.")
            undo = ui.button("Undo", icon="undo", on_click=lambda: self._studio.styles.take_back(deleted.trashed))
            undo.props("outline").props["aria-label"] = f"Undo: have {deleted.title} again"
            return undo

    def _broken(self, entry: Entry) -> None:
        html.h2(entry.title)
        html.p(f"This one cannot be used: {entry.fault}").classes("fault")
        if not entry.is_built_in:
            delete = ui.button("Delete", icon="delete", on_click=lambda: self._studio.styles.delete(entry.name))
            delete.props("outline").classes("foot").props["aria-label"] = f"Delete {entry.title}"

    def _card(self, entry: Entry, card: StyleCard) -> tuple[ui.element, ui.element]:
        """Build the card of a style; return the place of its sheet, and the button that opens it."""
        picture = html.div().classes("thumb")
        picture.on("click", lambda: _look_at([entry.name]))
        with picture:
            ui.label("Drawing its sheet …").classes("hint")
        with ui.element().classes("line between"):
            html.h2(entry.title)
            html.span("comes with Maulstick" if entry.is_built_in else "yours").classes("badge")
        html.p(about(card)).classes("hint")
        html.p(f"From {card.source}", title=card.source).classes("hint source")
        with ui.element().classes("line between foot"):
            look = ui.button("Look closer", on_click=lambda: _look_at([entry.name])).props("flat")
            look.props["aria-label"] = f"Look closer at {entry.title}"
            tick = ui.checkbox("Compare", value=entry.name in self._ticked)
            tick.props["aria-label"] = f"Compare {entry.title}"
            tick.on_value_change(lambda event: self._tick(entry.name, event.value is True))
        return picture, look

    def _tick(self, name: str, is_ticked: bool) -> None:
        self._ticked = [other for other in self._ticked if other != name] + [name] * is_ticked
        self._kept[_TICKED] = self._ticked
        self._count()

    def _count(self) -> None:
        count = len(self._ticked)
        self._compare.set_enabled(2 <= count <= MOST)
        ticked = ", ".join(self._titles.get(name, name) for name in self._ticked)
        told = f"Tick 2 to {MOST} hands to compare them." if count < 2 else ticked
        self._told.set_text(told if count <= MOST else f"{count} are too many to compare; leave at most {MOST} ticked.")

    async def _draw(self, sheets: Mapping[str, ui.element]) -> None:
        """Draw the sheets one after another, so that the desk can do other tasks in between."""
        for name, place in sheets.items():
            if place.is_deleted:
                return
            await fill(place, self._studio.styles.sheet(name), lambda path: sheet_picture(path, "", "cropped"))


def _look_at(names: Sequence[str]) -> None:
    ui.navigate.to(address_of(names))
