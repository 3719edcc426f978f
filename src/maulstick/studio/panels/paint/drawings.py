"""Cards of the drawings that people brought, each as a pen draws it."""

from collections.abc import Callable

from nicegui import html, ui

from maulstick.errors import InputError
from maulstick.painting.painting import Sheet
from maulstick.storage.text import counted
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.titles import title_of
from maulstick.studio.widgets.renaming import rename_button
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.widgets.undoing import offer_undo
from maulstick.studio.workers.svg_work import PICTURE, SvgCard


class Drawings:
    """Cards of all drawings, the newest first, while no machine paints.

    chosen: called with the name of one that is to be painted.
    """

    def __init__(self, studio: Studio, chosen: Callable[[str], None]) -> None:
        self._studio, self._on_chosen = studio, chosen
        with html.section() as self.root:
            html.h2("Drawings")
            self._cards = ui.element().classes("drawings")
        self._name, self._count = "", 0
        shown_by(self.root, studio.svgs.changed, self._show)

    def show(self, name: str) -> None:
        """Mark the drawing of that name as the one that is painted, or none where there is none of that name."""
        if name != self._name:
            self._name = name
            self._show()
        self._appear()

    def _show(self) -> None:
        cards, titles = self._studio.svgs.cards(), self._studio.run.plans()
        self._count = len(cards)
        self._cards.clear()
        with self._cards:
            for name, card in cards.items():
                self._build(name, titles.get(name, name), card)
        self._appear()

    def _appear(self) -> None:
        self.root.visible = self._count > 0 and not self._studio.run.state.is_on

    def _build(self, name: str, title: str, card: SvgCard) -> None:
        svgs = self._studio.svgs
        seen = svgs.file(name).with_name(PICTURE).stat().st_mtime_ns
        with html.article().classes("sheet drawing") as article:
            article.props["aria-label"] = f"Drawing {title}"
            html.h2(title)
            picture = html.img(src=f"/picture/drawings/{name}/{PICTURE}?{seen}", alt=f"{title} as a pen draws it")
            picture.classes("picture").props("loading=lazy")
            html.p(facts(card)).classes("hint figure")
            if card.notes:
                with html.ul().classes("hint notes").props('aria-label="Notes"'):
                    for note in card.notes:
                        html.li(note[0].upper() + note[1:])
            with ui.element().classes("line"):
                if name == self._name:
                    article.classes("chosen")
                    ui.label("Chosen").classes("hint")
                else:
                    choose = ui.button("Paint this one", on_click=lambda: self._on_chosen(name)).props("outline")
                    choose.props["aria-label"] = f"Paint {title}"
                rename_button(title_of(svgs.file(name).parent), lambda typed: svgs.retitle(name, typed))
                away = ui.button(icon="delete", on_click=lambda: self._throw_away(name, title)).props("flat")
                away.tooltip("Throw away").props["aria-label"] = f"Throw {title} away"

    async def _throw_away(self, name: str, title: str) -> None:
        svgs, run, client = self._studio.svgs, self._studio.run, ui.context.client
        if run.is_busy and run.state.plan == name:
            raise InputError(f"{title} is being painted; stop the machine first")
        trashed = await svgs.throw_away(name)
        offer_undo(client, f"{title} is in the trash", lambda: svgs.take_back(trashed))


def facts(card: SvgCard) -> str:
    """Return the size, the paths, the length and the pens of a drawing, in one line."""
    width, height = card.sheet
    length = f"{1e3 * card.metres:.0f} mm" if card.metres < 1 else f"{card.metres:.1f} m"
    paths = counted(card.paths, "path")
    pens = counted(card.pens, "pen")
    parts = (Sheet(width=width, height=height).millimetres, paths, length, pens)
    return ", ".join(part.replace(" ", "\N{NO-BREAK SPACE}") for part in parts)
