"""Form for a new survey: two questionnaires, put together from drawings in the studio."""

from collections.abc import Callable, Mapping
from typing import Any

from nicegui import app, events, html, ui

from maulstick.studio.state.studio import Studio
from maulstick.studio.state.survey_draft import Draft, HandDraft, PairDraft
from maulstick.studio.state.surveys import address_of
from maulstick.studio.widgets.number_field import NumberField
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.widgets.uploading import incoming, upload_button
from maulstick.survey.questions import SAME_HAND, WHOSE_DRAWING

_ENDINGS = ".png,.jpg,.jpeg,.heic,.heif,.webp,.tif,.tiff,.bmp"
_MATCHES = {
    SAME_HAND: (
        "Which drawing has the same strokes?",
        "People see a drawing by a person beside drawings by the machine, each in the style of another person, and "
        "look for the same strokes.",
    ),
    WHOSE_DRAWING: (
        "In whose hand is this drawing?",
        "People see a drawing by the machine beside a whole drawing by each person, and say who draws like "
        "this. Choose plans of the same pictures for all hands.",
    ),
}
"""What can be asked about hands, and how people see it, by the question's key."""

_KEPT = "survey"  # key of the draft, which a page remembers while it is open


class SurveyForm:
    """Form whose content stays while other panels are open. made: called with the name of the new survey."""

    def __init__(self, studio: Studio, made: Callable[[str], None]) -> None:
        self._studio, self._made = studio, made
        self._draft: Draft = app.storage.client.setdefault(_KEPT, Draft())
        self._drawings: dict[str, str] = {}
        self._looks: list[tuple[str, ui.select]] = []
        self._root = html.section().classes("survey-form").props('aria-label="A new survey"')
        with self._root:
            with html.div().classes("sheet"):
                html.h2("A new survey")
                _text("What is it called? People will read this.", self._draft, "title", 120)
                html.p(
                    "It is put together from your hands, plans and pictures. Bring drawings on paper as photographs, "
                    "cut at the edges of the sheet."
                ).classes("hint")
                with ui.element().classes("line"):
                    upload_button("Bring a drawing", _ENDINGS, self._bring, several=True)
            self._parts = ui.element().classes("parts")
            with ui.element().classes("line"):
                self._make = ui.button("Make the survey", icon="how_to_vote", on_click=self._make_it)
                ui.button("Start over", on_click=self._start_over).props("flat")
        shown_by(self._root, studio.plans.changed, self._follow)
        shown_by(self._root, studio.drawing.hands.changed, self._follow)
        shown_by(self._root, studio.gallery.changed, self._follow)

    def _follow(self) -> None:
        drawings = self._studio.surveys.drawings()
        if drawings != self._drawings or not self._parts.default_slot.children:
            self._drawings = drawings
            self._show()

    def _show(self) -> None:
        self._parts.clear()
        self._looks.clear()
        with self._parts:
            with html.section().classes("sheet").props('aria-label="Whose hand is it?"'):
                html.h2("Whose hand is it?")
                asks = ui.select({key: text for key, (text, _) in _MATCHES.items()}, label="What people are asked")
                asks.bind_value(self._draft, "question").props("outlined dense").classes("asks")
                ui.label().classes("hint").bind_text_from(
                    asks, "value", lambda key: f"{_MATCHES[key][1]} To leave this part out, leave it empty."
                )
                for number, hand in enumerate(self._draft.hands, start=1):
                    self._show_hand(number, hand)
                with ui.element().classes("line"):
                    add = ui.button(
                        "Another hand", icon="add", on_click=lambda: self._add(self._draft.hands, HandDraft())
                    )
                    add.props("outline")
                    _count_field("Hands that each person is asked about", self._draft, "hands_asked", 10)
            with html.section().classes("sheet").props('aria-label="Which of two looks?"'):
                html.h2("Which of two looks?")
                html.p(
                    "People see a picture and two drawings of it: which looks more human, better, more like the "
                    "picture, more artistic, more abstract? To leave this part out, leave it empty."
                ).classes("hint")
                with ui.element().classes("line"):
                    for label, name in (
                        ("First look, as in: loops", "first_look"),
                        ("Second look, as in: lines", "second_look"),
                    ):
                        _text(label, self._draft, name, 60).props("dense").on_value_change(self._name_looks)
                for number, pair in enumerate(self._draft.pairs, start=1):
                    self._show_pair(number, pair)
                with ui.element().classes("line"):
                    add = ui.button(
                        "Another picture", icon="add", on_click=lambda: self._add(self._draft.pairs, PairDraft())
                    )
                    add.props("outline")
                    _count_field("Pictures that each person is asked about", self._draft, "pairs_asked", 50)
        self._name_looks()

    def _show_hand(self, number: int, hand: HandDraft) -> None:
        with html.div().classes("item").props(f'role="group" aria-label="Hand {number}"'):
            _text("Name", hand, "name", 60).props("dense")
            self._choice("Drawn by this person", hand, "by_hand")
            self._choices("By the machine", hand)
            self._remover(f"Remove hand {number}", self._draft.hands, hand)

    def _show_pair(self, number: int, pair: PairDraft) -> None:
        with html.div().classes("item").props(f'role="group" aria-label="Comparison {number}"'):
            self._choice("The picture", pair, "reference")
            self._looks.append(("first_look", self._choice("First look", pair, "first")))
            self._looks.append(("second_look", self._choice("Second look", pair, "second")))
            self._remover(f"Remove comparison {number}", self._draft.pairs, pair)

    def _name_looks(self) -> None:
        """Label the drawings of a comparison with the names of the looks."""
        for name, choice in self._looks:
            usual = "First look" if name == "first_look" else "Second look"
            choice.props["label"] = f"In {called}" if (called := getattr(self._draft, name).strip()) else usual

    def _choice(self, label: str, draft: HandDraft | PairDraft, name: str) -> ui.select:
        chosen = getattr(draft, name)
        with html.div().classes("choice"):
            shown = ui.element().classes("thumbs")
            choice = ui.select(
                self._drawings,
                label=label,
                value=chosen if chosen in self._drawings else None,
                clearable=True,
                with_input=True,
                on_change=lambda event: _show_thumbs(shown, [event.value] if event.value else [], self._drawings),
            )
            choice.bind_value_to(draft, name).props("outlined dense")
        _show_thumbs(shown, [choice.value] if choice.value else [], self._drawings)
        return choice

    def _choices(self, label: str, hand: HandDraft) -> None:
        with html.div().classes("choice"):
            shown = ui.element().classes("thumbs")
            choice = ui.select(
                self._drawings,
                label=label,
                value=[each for each in hand.by_machine if each in self._drawings],
                multiple=True,
                clearable=True,
                on_change=lambda event: _show_thumbs(shown, event.value or [], self._drawings),
            )
            choice.bind_value_to(hand, "by_machine", forward=lambda value: list(value or ()))
            choice.props("outlined dense")
        _show_thumbs(shown, choice.value, self._drawings)

    def _remover(self, label: str, rows: list[Any], row: object) -> None:
        def remove() -> None:
            rows[:] = [each for each in rows if each is not row]
            self._show()

        button = ui.button(icon="close", on_click=remove).props("flat round").classes("remover")
        button.props(f'aria-label="{label}"')

    def _add(self, rows: list[Any], row: object) -> None:
        rows.append(row)
        self._show()

    async def _bring(self, event: events.UploadEventArguments) -> None:
        async with incoming(self._studio.folder, event) as file:
            name = await self._studio.gallery.keep(file, str(event.file.name))
        ui.notify(f"{self._studio.gallery.titles()[name]} can be chosen now.")

    async def _make_it(self) -> None:
        self._make.disable()
        try:
            name = await self._studio.surveys.make(self._draft)
        finally:
            self._make.enable()
        app.storage.client.pop(_KEPT)
        ui.notify("The survey is made. Make links for the people you ask.")
        self._made(name)

    def _start_over(self) -> None:
        app.storage.client[_KEPT] = self._draft = Draft()
        self._show()


def _text(label: str, draft: Draft | HandDraft, name: str, most: int) -> ui.input:
    text = ui.input(label).bind_value(draft, name, forward=lambda said: str(said or "")[:most])
    return text.props(f"outlined maxlength={most}")


def _count_field(label: str, draft: Draft, name: str, most: int) -> None:
    number = NumberField(label, min=1, max=most).props("outlined dense").classes("asked")
    number.bind_value(draft, name)


def _show_thumbs(shown: ui.element, drawings: list[str], titles: Mapping[str, str]) -> None:
    shown.clear()
    with shown:
        for drawing in drawings:
            html.img(src=address_of(drawing), alt=titles.get(drawing, "")).props("loading=lazy")
