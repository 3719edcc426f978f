"""Form for a new plan: picture or text, hand, brush, paints, strokes, size, and weights of the loss."""

from collections.abc import Container
from contextlib import suppress
from importlib.util import find_spec
from typing import Any, Literal

from nicegui import app, html, ui
from nicegui.elements.mixins.value_element import ValueElement
from pydantic import ValidationError

from maulstick.errors import InputError, MaulstickError, option, validation_fault
from maulstick.jobs.plan.options import AUTO, PlanOptions
from maulstick.jobs.plan.request import MOST_TRIES, PlanRequest
from maulstick.painting.pens import load_pen
from maulstick.studio.panels.plan.again import values_of
from maulstick.studio.panels.plan.brushes import BrushChoice, are_offered
from maulstick.studio.panels.plan.editor import PictureEditor
from maulstick.studio.panels.plan.inks import InkChoice
from maulstick.studio.panels.plan.more import MoreChoices
from maulstick.studio.panels.plan.pictures import PictureChoice
from maulstick.studio.panels.plan.presets import PresetChoice
from maulstick.studio.panels.plan.sheet import FITS, SIZES, TURNS, SheetChoice
from maulstick.studio.panels.plan.weights import weight_sliders
from maulstick.studio.state.plan import Plan
from maulstick.studio.state.settings import Choices
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.typed_numbers import whole_number
from maulstick.studio.state.weighing import PICTURE_TERMS, check_weights
from maulstick.studio.widgets.brushes import USUAL_PEN, draws_one_width, is_pen
from maulstick.studio.widgets.number_field import NumberField
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.widgets.slider import Slider
from maulstick.studio.wording import PLANNED_FOR, WORDS_LABEL

_DEFAULT = PlanOptions()
DRAWN = {"both": "Contours and tones", "lines": "Lines alone", "tones": "Tones alone"}
"""What ink draws of a picture, for people."""

_FREE = "free"  # the style of nobody's hand
_EFFORTS = {150: "A sketch, quickly", _DEFAULT.steps: "As usual", 1500: "Fine, and slowly"}  # by steps of the optimiser
_OFFERS: dict[str, Container[object]] = {
    "machine": PLANNED_FOR,
    "size": SIZES,
    "turned": TURNS,
    "fit": FITS,
    "drawing": DRAWN,
    "effort": _EFFORTS,
}
_SHOW_NEWEST = """setTimeout(() => document.querySelector(".plans .plan")?.scrollIntoView({ block: "nearest" }), 100)"""
_SHOW_FORM = """document.querySelector(".fields").scrollTo(0, 0); scrollTo({ top: 0, behavior: "smooth" })"""
_PAUSE = 1.0  # seconds without the button after a click, longer than a double click takes
_MOST_STROKES, _MOST_PAINTS = 20_000, 64  # what a page can show and a person can mix; the command line takes more


class PlanForm:
    """Form of a plan; `add_button` ends it.

    style: name of the hand that is chosen first.  desk: part of the page onto which a picture can be dropped.
    """

    def __init__(self, studio: Studio, style: str, desk: ui.element) -> None:
        self._studio = studio
        first = {"text": "", **_offered(studio.settings.choices)}
        self._kept = kept = app.storage.client.setdefault("plan", first)  # while a person is at other panels
        PresetChoice(studio, desk, self._now, self.take)
        with ui.element().classes("sheet"):
            html.h2("For which machine")
            self._machine = ui.select(PLANNED_FOR, label="Machine").bind_value(kept, "machine")
            self._lifts = html.p("It only lifts its pen, so it draws with a pen, or with a brush held at one pressure.")
        self._lifts.classes("hint")
        with ui.element().classes("sheet"):
            html.h2("What to paint")
            self._picture = PictureChoice(studio, desk, self._follow)
            self._editor = PictureEditor(kept, self._follow)
            self._text = ui.input(WORDS_LABEL).bind_value(kept, "text").props("maxlength=300")
            self._both = html.p("They count beside the picture; choose “No picture” to have them alone.")
            self._both.classes("hint")
        with ui.element().classes("sheet"):
            html.h2("On what")
            self._sheet = SheetChoice(studio, kept, self._picture, self._editor)
        with ui.element().classes("sheet"):
            html.h2("How to paint it")
            with ui.element().classes("numbers"):
                self._style = ui.select([], label="Hand", on_change=self._learn_of_hand)
                self._hand_size = NumberField("Hand size", step=0.1, suffix="times").bind_value(kept, "hand_size")
                self._brushes = BrushChoice()
                self._kind = ui.select({"paints": "Paints", "ink": "Ink"}, label="Colours").bind_value(kept, "kind")
                self._paints = NumberField("How many", min=1, max=_MOST_PAINTS).bind_value(kept, "paints")
                self._inks = InkChoice(kept)
                self._strokes = NumberField("Strokes", min=0, max=_MOST_STROKES, step=50)
                self._strokes.bind_value(kept, "strokes")
                self._drawing = ui.select(DRAWN, label="What it draws").bind_value(kept, "drawing")
                self._enough = ui.checkbox("As many strokes as the picture needs").bind_value(kept, "enough")
            self._pale = html.p("With too few strokes of a thin pen, darks stay pale.").classes("hint")
        with ui.element().classes("sheet"):
            html.h2("What matters")
            weights = {name: kept["weights"].get(name, 0.0) for name in PICTURE_TERMS}
            self._weights = weight_sliders(weights, self._keep)
            self._arrange = Slider("As the hand arranges", 1, 0.25, kept["arrange"], self._keep)
            self._effort = ui.select(_EFFORTS, label="How carefully").bind_value(kept, "effort")
            self._more = MoreChoices(studio, kept)
        self._is_arranged = False
        for choice in (self._machine, self._kind, self._enough, self._text, self._brushes.first):
            choice.on_value_change(self._follow)
        self._offer_brushes(kept["brush"])
        self._machine.on_value_change(self._change_machine)
        self._brushes.first.on_value_change(self._take_colour)
        shown_by(self._style, studio.styles.changed, lambda: self._show_styles(style or kept["style"]))
        self._follow()
        for field in self._fields():
            field.on_value_change(self._keep)

    def add_button(self) -> None:
        """Add the button that begins to plan, where the page is built now."""
        self._go = ui.button("Plan it", icon="play_arrow", on_click=self._plan).props("unelevated no-caps")
        self._go.classes("go")

    def _fields(self) -> tuple[ValueElement[Any], ...]:
        numbers = (self._hand_size, self._paints, self._strokes, self._enough, self._effort)
        choices = (self._machine, self._style, self._kind, self._drawing)
        return (*choices, *self._inks.fields, *self._brushes.fields, *numbers, *self._sheet.fields, *self._more.fields)

    def _keep(self) -> None:
        """Keep all that is chosen, for this page while a person is at other panels, and for those opened later."""
        self._kept |= {"style": self._style.value, "brush": self._brushes.names, "arrange": self._arrange.value}
        self._kept["weights"] = {name: slider.value for name, slider in self._weights.items()}
        self._studio.settings.keep(self._kept)

    def _offer_brushes(self, chosen: str) -> None:
        """Offer what the machine can draw with: the chosen ones of it, or else the usual one."""
        self._lifts.visible = self._brushes.offer(str(self._machine.value), chosen)

    def _change_machine(self) -> None:
        """Offer what this machine draws with: a pen where it only lifts one, and no pen where it does not."""
        brush, before = self._brushes.first, str(self._brushes.first.value)
        self._offer_brushes(self._brushes.names)
        if self._lifts.visible and not draws_one_width(before) and USUAL_PEN in brush.options:
            brush.value = USUAL_PEN
        elif is_pen(before) and not self._lifts.visible:
            self._kind.value = "paints"

    def _take_colour(self) -> None:
        """Draw in the ink of the pen that is chosen."""
        pen = str(self._brushes.first.value)
        if is_pen(pen):
            self._kind.value, self._inks.first.value = "ink", load_pen(pen).colour

    def _follow(self) -> None:
        """Show what means something beside what is chosen."""
        self._editor.open(self._picture.name)
        self._sheet.follow()
        in_ink, of_picture = self._kind.value == "ink", self._picture.path is not None
        self._both.visible = of_picture and bool(str(self._text.value or "").strip())
        self._paints.visible = not in_ink
        self._inks.show(in_ink)
        self._brushes.show(in_ink)
        self._drawing.visible = in_ink and of_picture
        self._enough.visible = in_ink and of_picture and self._style.value != _FREE
        self._pale.visible = self._enough.visible and not self._enough.value
        self._strokes.set_enabled(not self._takes_enough)
        self._arrange.element.visible = in_ink and self._is_arranged

    async def _learn_of_hand(self) -> None:
        """Find out whether the chosen hand has an arrangement."""
        style, found = str(self._style.value), False
        with suppress(MaulstickError):  # a style that cannot be used is refused once it is planned
            found = style != _FREE and await self._studio.styles.is_arranged(style)
        if style == self._style.value and not self._style.is_deleted:
            self._is_arranged = found
            self._follow()

    @property
    def _takes_enough(self) -> bool:
        return bool(self._enough.visible and self._enough.value)

    def _show_styles(self, wanted: str) -> None:
        titles = {_FREE: "free (nobody's)", **self._studio.styles.titles()}
        chosen = self._style.value if self._style.value in titles else wanted if wanted in titles else "loops"
        self._style.set_options(titles, value=chosen)

    def fill(self, plan: Plan) -> None:
        """Fill the form with the picture, the text and the options of a plan.

        Raises InputError where its picture is not in the studio any more; the rest is filled in all the same.
        """
        options = plan.request.options
        self._set(values_of(plan.request))
        ui.run_javascript(_SHOW_FORM)
        self._picture.choose(plan.request.picture)
        self._editor.correct(options.edit)
        self._more.fill(options)
        ui.notify(f"The form is filled as for {plan.title}. Change what you like, then “Plan it”.", type="positive")

    def take(self, choices: Choices) -> list[str]:
        """Show settings; return the names of the fields whose value this studio does not have, which stay."""
        values = choices.model_dump()
        machine = choices.machine if choices.machine in PLANNED_FOR else str(self._machine.value)
        brush = [choices.brush] if are_offered(machine, choices.brush) else []
        offers = {**_OFFERS, "style": self._style.options, "brush": brush, "effort": [choices.effort]}
        if self._studio.mixing.tubes_file is None:
            offers["unmixed"] = [False]
        gone = [name for name, offered in offers.items() if values[name] not in offered]
        self._set({**values, **{name: self._kept[name] for name in gone}})
        return gone

    def _set(self, values: dict[str, Any]) -> None:
        """Show values, by the names of what the page keeps."""
        self._machine.value = values["machine"]
        self._offer_brushes(values["brush"])
        self._effort.set_options({values["effort"]: f"{values['effort']} steps", **_EFFORTS})
        self._kept.update(values)
        if values["style"] in self._style.options:
            self._style.value = values["style"]
        for name, slider in self._weights.items():
            slider.set(values["weights"].get(name, 0.0))
        self._arrange.set(values["arrange"])

    def _now(self) -> Choices:
        """Return all that is chosen but what it is of. Raises InputError for a value that is out of its range."""
        self._keep()
        try:
            return Choices.model_validate({**self._kept})
        except ValidationError as error:
            raise InputError(f"these settings cannot be kept: {validation_fault(error)}") from error

    def _plan(self) -> None:
        plan = self._studio.plans.add(self._request())
        self._go.disable()  # or a double click would plan it twice
        ui.timer(_PAUSE, self._go.enable, once=True)
        ui.notify(f"{plan.title} is being planned", type="positive")
        ui.run_javascript(_SHOW_NEWEST)

    def _request(self) -> PlanRequest:
        """Return the request that the form describes. Raises InputError for a value that cannot be used."""
        text = str(self._text.value or "").strip() or None
        if self._picture.is_awaited:
            raise InputError("a picture is on its way; plan it once it is here")
        picture = self._picture.path
        if picture is None and text is None:
            raise InputError("there is nothing to paint yet; bring a picture, or say in words what to paint")
        if text is not None and find_spec("open_clip") is None:
            raise InputError("this studio cannot read words, for CLIP is not installed; take them out, use a picture")
        strokes: int | Literal["auto"] = AUTO
        if not self._takes_enough:
            strokes = whole_number(self._strokes.value, "the number of strokes", 1, _MOST_STROKES)
        if self._hand_size.value is None:
            raise InputError.of_range(option("hand_size"), "nothing", "a number of times")
        placing, ink = self._sheet.placing(), self._inks.colours if self._kind.value == "ink" else None
        paints = None
        if ink is None and strokes != AUTO:
            paints = min(whole_number(self._paints.value, "the number of paints", 1, _MOST_PAINTS), strokes)
        weights = {name: slider.value for name, slider in self._weights.items()}
        asked: dict[str, Any] = {"paints": paints, **self._more.options(in_ink=ink is not None)}
        options = PlanOptions(
            **asked,
            text=text,
            weights={} if picture is None else weights if text is not None else check_weights(weights),
            size=placing.size,
            fit=placing.fit,
            margin=placing.margin,
            **({} if picture is None else vars(self._editor.edit)),
            strokes=strokes,
            ink=ink,
            brush=self._brushes.used,
            robot=str(self._machine.value) or None,
            style=str(self._style.value),
            hand_size=self._hand_size.value,
            drawing=str(self._drawing.value) if self._drawing.visible else _DEFAULT.drawing,
            arrange=self._arrange.value if self._arrange.element.visible else _DEFAULT.arrange,
            steps=int(self._effort.value or 0),
        )
        return PlanRequest(picture, options, whole_number(self._more.tries.value, "the number of tries", 1, MOST_TRIES))


def _offered(choices: Choices) -> dict[str, Any]:
    """Return what was chosen last, and what is usual for what is no longer offered."""
    usual = Choices()
    gone = {name for name, offered in _OFFERS.items() if getattr(choices, name) not in offered}
    return choices.model_copy(update={name: getattr(usual, name) for name in gone}).model_dump()
