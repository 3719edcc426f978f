"""Panel to draw a hand: the sheet, its tools, and learning a style from it."""

from collections.abc import Callable, Mapping
from pathlib import Path

from nicegui import html, ui

from maulstick.errors import InputError, MaulstickError
from maulstick.storage.text import counted
from maulstick.studio.panels.draw.learned import GOOD, learn_hand
from maulstick.studio.panels.draw.others import OtherHands
from maulstick.studio.panels.draw.reference import ReferencePicture, ReferenceTool
from maulstick.studio.panels.draw.sheet_form import choose_sheet
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.titles import MOST_LETTERS
from maulstick.studio.widgets.pen import DrawingSheet
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.wording import error_text

_STYLE = Path(__file__).with_name("draw.css")


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the panel. query: not used."""
    ui.add_css(_STYLE)
    html.h1("Show how you draw")
    html.p(
        f"Draw as you always do: {GOOD} strokes or more of the kind that you want the machine to make. They show it "
        "your hand: your way of drawing. "
        "A pen with pressure is best; a finger or a mouse will do."
    ).classes("hint draw-hint")
    with ui.element().classes("draw"):
        _Sheet(studio)
    OtherHands(studio)


_FILL_SCREEN = """() => {
  const fills = document.body.classList.toggle("whole-sheet");
  document.onfullscreenchange = () => document.body.classList.toggle("whole-sheet", !!document.fullscreenElement);
  if (fills) document.documentElement.requestFullscreen?.().catch(() => {});
  else if (document.fullscreenElement) document.exitFullscreen();
}"""


class _Sheet:
    """Sheet, with the tools on its left, and the style to be learned on its right."""

    def __init__(self, studio: Studio) -> None:
        self._studio, self._drawing, self._client = studio, studio.drawing, ui.context.client
        self._shown_title = self._refusal = ""
        self._build_tools()
        self._table = ui.element().classes("table")
        ReferencePicture(studio, self._table)
        with self._table:
            self._place = ui.element().classes("place")
        self._build_learning()
        shown_by(self._table, self._drawing.renewed, self._lay)
        shown_by(self._table, self._drawing.changed, self._tell)

    def _build_tools(self) -> None:
        with ui.element().classes("tools").props('role="toolbar" aria-label="Tools" aria-orientation="vertical"'):
            self._draw = _tool("Draw", "draw", lambda: self._take(False))
            self._rub = _tool("Rub out", "auto_fix_normal", lambda: self._take(True))
            self._undo = _tool("Undo", "undo", self._drawing.undo).tooltip("Ctrl+Z")
            self._redo = _tool("Redo", "redo", self._drawing.redo).tooltip("Ctrl+Shift+Z")
            _tool("New sheet", "note_add", lambda: choose_sheet(self._drawing))
            ReferenceTool(self._studio)
            whole = ui.button("Full screen", icon="fullscreen").props("flat stack no-caps")
            whole.on("click", js_handler=_FILL_SCREEN)

    def _build_learning(self) -> None:
        with ui.element().classes("learning"):
            self._count = ui.label().classes("count figure").props('role="status"')
            self._progress = ui.linear_progress(0, show_value=False, size=".4rem").props("rounded aria-hidden=true")
            self._name = ui.input("Name of this hand").props(f"outlined maxlength={MOST_LETTERS}")
            self._name.on("blur", self._rename).on("keydown.enter", self._rename)
            self._learn = ui.button("Learn this hand", icon="school", on_click=self._learn_it)
            self._trouble = ui.label().classes("trouble").props('role="alert"')
            ui.label("Every stroke is kept at once; there is nothing to save.").classes("hint")

    def _lay(self) -> None:
        self._place.clear()
        with self._place:
            self._pen = DrawingSheet(self._drawing, self._complain)
        self._take(False)

    def _take(self, rubs: bool) -> None:
        self._pen.rub_out(rubs)
        self._draw.props(f'aria-pressed="{_as_word(not rubs)}"')
        self._rub.props(f'aria-pressed="{_as_word(rubs)}"')

    def _tell(self) -> None:
        drawing = self._drawing
        strokes = len(drawing.strokes)
        self._count.set_text(_sheet_in_words(strokes))
        self._progress.set_value(min(strokes / GOOD, 1))
        self._undo.set_enabled(drawing.can_undo)
        self._redo.set_enabled(drawing.can_redo)
        self._complain(self._refusal)
        if drawing.title != self._shown_title:  # else somebody may be typing
            self._shown_title = drawing.title
            self._name.set_value(drawing.title)

    def _complain(self, refusal: str) -> None:
        """Show next to the sheet why something was refused on this page, and what is wrong on all; "" for nothing."""
        self._refusal = refusal
        troubles = [each for each in (refusal, self._drawing.trouble) if each]
        self._trouble.set_text("\n".join(dict.fromkeys(troubles)))
        self._trouble.set_visibility(bool(troubles))

    async def _rename(self) -> None:
        await self._drawing.rename(self._name.value or self._drawing.title)
        self._name.set_value(self._drawing.title)

    async def _learn_it(self) -> None:
        drawing = self._drawing
        self._complain("")
        self._learn.props("loading")
        try:
            if not drawing.strokes:
                raise InputError(f"there is nothing on the sheet yet; draw some strokes, and {GOOD} make a good style")
            await self._rename()
            await drawing.keep()
            await learn_hand(self._studio, drawing.name, self._client)
        except MaulstickError as error:
            self._complain(error_text(error))
        finally:
            self._learn.props(remove="loading")


def _tool(text: str, icon: str, use: Callable[[], object]) -> ui.button:
    return ui.button(text, icon=icon, on_click=use).props("flat stack no-caps")


def _sheet_in_words(strokes: int) -> str:
    if strokes == 0:
        return "An empty sheet"
    said = counted(strokes, "stroke")
    return f"{said}; {GOOD} make a good style" if strokes < GOOD else f"{said}, enough for a good style"


def _as_word(yes: bool) -> str:
    return "true" if yes else "false"
