"""The panel of styles: a gallery of hands, one of them looked at closely, or some side by side."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from nicegui import html, ui

from maulstick.studio.panels.styles_compared import show_compared
from maulstick.studio.panels.styles_opened import show_opened
from maulstick.studio.panels.styles_shown import about, fill, sheet_picture
from maulstick.studio.showing import shown_by
from maulstick.studio.studio import Studio
from maulstick.studio.styles import MOST, Entry, Thrown
from maulstick.style.cards import StyleCard

_STYLE = Path(__file__).with_name("styles.css")


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build it. query: `style` is the hand to open at once."""
    ui.add_css(_STYLE)
    wanted = query.get("style", "")
    StylesPanel(studio, [wanted] if wanted in studio.styles.names() else [])


class StylesPanel:
    """What one page looks at: none of the styles in particular, one, or some side by side."""

    def __init__(self, studio: Studio, looked_at: Sequence[str]) -> None:
        self._studio, self._looked_at, self._left = studio, list(looked_at), ""
        self._ticked: list[str] = []
        self._root = ui.element().classes("styles")
        self._show()
        shown_by(self._root, studio.styles.changed, self._follow)

    def _look_at(self, names: Sequence[str]) -> None:
        self._left = self._looked_at[0] if len(self._looked_at) == 1 else ""
        self._looked_at = list(names)
        focused = self._show()
        if focused is not None:  # what had the focus is gone
            focused.on("vnodeMounted", js_handler="(node) => node.el.focus()")

    def _follow(self) -> None:
        """What somebody looks at closely stays as it is for as long as it is there."""
        names = self._studio.styles.names()
        self._ticked = [name for name in self._ticked if name in names]
        if not self._looked_at or not set(self._looked_at) <= set(names):
            self._look_at([])

    def _show(self) -> ui.element | None:
        """Build it anew; what keys then act upon."""
        self._root.clear()
        with self._root:
            if not self._looked_at:
                return self._gallery()
            if len(self._looked_at) == 1:
                return show_opened(self._studio, self._looked_at[0], self._look_at)
            return show_compared(self._studio, self._looked_at, self._look_at)

    def _gallery(self) -> ui.element | None:
        styles = self._studio.styles
        html.h1("Hands to paint with")
        html.p(
            "Each sheet shows what a person drew and, below it, what Maulstick draws in that hand. "
            "Look closer at one, or tick a few to see how they differ."
        ).classes("hint")
        ways_in = {thrown.name: self._thrown(thrown) for thrown in styles.thrown_away[-3:]}
        with ui.element().classes("line chosen"):
            self._compare = ui.button("Compare", icon="compare", on_click=lambda: self._look_at(self._ticked))
            self._told = ui.label().classes("hint").props('role="status"')
            ui.button("Draw a hand", icon="draw", on_click=lambda: ui.navigate.to("/")).props("outline")
        sheets: dict[str, ui.element] = {}
        with ui.element().classes("cards"):
            for entry in map(styles.entry, styles.names()):
                with html.article().classes("sheet style-card").props(f'aria-label="{entry.name}"'):
                    if entry.card is None:
                        self._broken(entry)
                    else:
                        sheets[entry.name], ways_in[entry.name] = self._card(entry, entry.card)
        self._count()
        ui.timer(0, lambda: self._draw(sheets), once=True)
        return ways_in.get(self._left)

    def _thrown(self, thrown: Thrown) -> ui.element:
        """A line about what was deleted; its button that has it again."""
        with ui.element().classes("line notice").props('role="status"'):
            ui.label(f"{thrown.name} is deleted.")
            return ui.button("Undo", icon="undo", on_click=lambda: self._studio.styles.take_back(thrown)).props(
                f'outline aria-label="Undo: have {thrown.name} again"'
            )

    def _broken(self, entry: Entry) -> None:
        html.h2(entry.name)
        html.p(f"This one cannot be used: {entry.fault}").classes("fault")
        if not entry.is_built_in:
            delete = ui.button("Delete", icon="delete", on_click=lambda: self._studio.styles.delete(entry.name))
            delete.props(f'outline aria-label="Delete {entry.name}"').classes("foot")

    def _card(self, entry: Entry, card: StyleCard) -> tuple[ui.element, ui.element]:
        """A style among the others; where its sheet goes, and the button that opens it."""
        picture = html.div().classes("thumb")
        picture.on("click", lambda: self._look_at([entry.name]))
        with picture:
            ui.label("Drawing its sheet …").classes("hint")
        with ui.element().classes("line between"):
            html.h2(entry.name)
            html.span("comes with Maulstick" if entry.is_built_in else "yours").classes("badge")
        html.p(about(card)).classes("hint")
        html.p(f"From {card.source}", title=card.source).classes("hint source")
        with ui.element().classes("line between foot"):
            look = ui.button("Look closer", on_click=lambda: self._look_at([entry.name])).props("flat")
            look.props(f'aria-label="Look closer at {entry.name}"')
            tick = ui.checkbox("Compare", value=entry.name in self._ticked)
            tick.props(f'aria-label="Compare {entry.name}"')
            tick.on_value_change(lambda event: self._tick(entry.name, event.value is True))
        return picture, look

    def _tick(self, name: str, is_ticked: bool) -> None:
        self._ticked = [other for other in self._ticked if other != name] + [name] * is_ticked
        self._count()

    def _count(self) -> None:
        count = len(self._ticked)
        self._compare.set_enabled(2 <= count <= MOST)
        told = f"Tick 2 to {MOST} hands to compare them." if count < 2 else ", ".join(self._ticked)
        self._told.set_text(told if count <= MOST else f"{count} are too many to compare; leave at most {MOST} ticked.")

    async def _draw(self, sheets: Mapping[str, ui.element]) -> None:
        """One after another, so that the desk is soon free for somebody who wants something else of it."""
        for name, place in sheets.items():
            if place.is_deleted:
                return
            await fill(place, self._studio.styles.sheet(name), lambda path: sheet_picture(path, "", "cropped"))
