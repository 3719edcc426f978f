"""Hands that were drawn or uploaded before, and a button to bring more."""

from pathlib import Path

from nicegui import events, html, ui

from maulstick.errors import MaulstickError
from maulstick.storage.text import counted
from maulstick.studio.panels.draw.learned import learn_hand
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.number_field import NumberField
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.widgets.undoing import offer_undo
from maulstick.studio.widgets.uploading import incoming, upload_button
from maulstick.studio.wording import error_text
from maulstick.studio.workers.hand_work import PICTURE, HandCard

_ENDINGS = ".csv,.uim,.will,.inkml,.svg,.json,.npz"  # that the browser offers; the content decides


class OtherHands:
    """Cards of all hands but the one on the sheet."""

    def __init__(self, studio: Studio) -> None:
        self._studio, self._drawing, self._client = studio, studio.drawing, ui.context.client
        self._taken_in = 0  # recordings that are being read
        with html.section().classes("hands"):
            html.h2("Other hands")
            with ui.element().classes("line"):
                self._bring = upload_button("Bring a recording", _ENDINGS, self._take_in, several=True)
                self._bring.on("click", self._forget_trouble, [])  # not later: files of one choice come one by one
                self._pen = (
                    NumberField("Length of its pen, mm", min=0, max=2000)
                    .props("outlined dense clearable")
                    .classes("pen-length")
                )
                ui.label(
                    "A drawing of a pen tablet (UIM, WILL, InkML), an SVG, a web page's JSON, ink, or a motion-capture "
                    "take (CSV). Only a take needs the length of its pen, from the markers to the tip."
                ).classes("hint")
            self._trouble = _trouble()
            self._cards = ui.element().classes("cards")
        shown_by(self._cards, self._drawing.hands.changed, self._show)

    def _show(self) -> None:
        self._cards.clear()
        with self._cards:
            titles = self._drawing.hands.titles()
            for name in self._drawing.hands.names():
                if name != self._drawing.name:
                    self._card(name, titles.get(name, name))

    def _card(self, name: str, title: str) -> None:
        hands = self._drawing.hands
        card = hands.card(name)
        with html.article().classes("sheet") as article:
            article.props["aria-label"] = title
            if card is None:
                ui.label("no picture yet").classes("picture none")
            else:
                drawn = (hands.path(name) / PICTURE).stat().st_mtime_ns  # else a browser may show an older one
                picture = html.img(src=f"/picture/hands/{name}/{PICTURE}?{drawn}", alt=f"What {title} drew")
                picture.classes("picture").props("loading=lazy")
            ui.label(title).classes("name")
            ui.label("not read yet" if card is None else _summary(card)).classes("hint")
            for note in () if card is None else card.notes:
                ui.label(note).classes("hint")
            trouble = _trouble()
            with ui.element().classes("line"):
                if hands.is_drawn(name):
                    ui.button("Draw on", icon="draw", on_click=lambda: self._drawing.open(name))
                learn = ui.button("Learn").props("outline")
                learn.on_click(lambda: self._learn(name, learn, trouble))
                throw = ui.button(icon="delete", on_click=lambda: self._throw_away(name, title)).props("flat")
                throw.tooltip("Throw away").props["aria-label"] = f"Throw {title} away"

    async def _learn(self, name: str, button: ui.button, trouble: ui.label) -> None:
        trouble.set_text("")
        button.props("loading")
        try:
            await learn_hand(self._studio, name, self._client)
        except MaulstickError as error:
            trouble.set_text(error_text(error))
        finally:
            button.props(remove="loading")

    async def _throw_away(self, name: str, title: str) -> None:
        trashed = await self._drawing.throw_away(name)
        offer_undo(self._client, f"{title} is in the trash.", lambda: self._drawing.hands.take_back(trashed))

    def _forget_trouble(self) -> None:
        self._trouble.set_text("")

    async def _take_in(self, upload: events.UploadEventArguments) -> None:
        called = Path(upload.file.name).name
        self._taken_in += 1
        self._bring.props("loading")
        try:
            async with incoming(self._studio.folder, upload) as file:
                name = await self._drawing.hands.take_in(file, called, self._pen.value)
        except MaulstickError as error:
            self._trouble.set_text("; ".join(filter(None, (self._trouble.text, error_text(error)))))
            return
        finally:
            self._taken_in -= 1
            if not self._taken_in:
                self._bring.props(remove="loading")
        ui.notify(f"{called} is here as {self._drawing.hands.titles()[name]}.", type="positive")


def _trouble() -> ui.label:
    return ui.label().classes("trouble").props('role="alert"')


def _summary(card: HandCard) -> str:
    return f"{counted(card.strokes, 'stroke')}, {'with' if card.pressed else 'without'} pressure"
