"""Form for a new plan: picture or text, hand, brush, paints, strokes, size, and weights of the loss."""

from contextlib import suppress
from importlib.util import find_spec
from typing import Literal

from nicegui import app, html, ui

from maulstick.colour.palette import parse_colour
from maulstick.errors import InputError, MaulstickError, option
from maulstick.jobs.plan.options import AUTO, PlanOptions
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.brush import BRUSHES
from maulstick.painting.raster import parse_size
from maulstick.studio.panels.plan.again import values_of
from maulstick.studio.panels.plan.pictures import PictureChoice
from maulstick.studio.panels.plan.weights import PICTURE_TERMS, check_weights, weight_sliders
from maulstick.studio.state.plans import Plan
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.sheet_sizes import SHEET_SIZES, in_words
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.widgets.slider import Slider

_DEFAULT = PlanOptions()
DRAWN = {"both": "Contours and tones", "lines": "Lines alone", "tones": "Tones alone"}
"""What one ink draws of a picture, for people."""

_FREE = "free"  # the style of nobody's hand
_SIZES = {size: in_words(size) for size in SHEET_SIZES}
_EFFORTS = {150: "A sketch, quickly", _DEFAULT.steps: "As usual", 1500: "Fine, and slowly"}  # by steps of the optimiser
_FIRST_VALUES = {
    "text": "",
    "hand_size": _DEFAULT.hand_size,
    "brush": _DEFAULT.brush,
    "size": _DEFAULT.size,
    "kind": "paints",
    "paints": _DEFAULT.mixed_paints,
    "ink": "#000000",
    "strokes": _DEFAULT.strokes,
    "enough": False,
    "drawing": _DEFAULT.drawing,
    "effort": _DEFAULT.steps,
}
_PAUSE = 1.0  # seconds without the button after a click, longer than a double click takes
_MOST_STROKES, _MOST_PAINTS = 20_000, 64  # what a page can show and a person can mix; the command line takes more


class PlanForm:
    """Form with the button that begins to plan. style: name of the hand that is chosen first."""

    def __init__(self, studio: Studio, style: str) -> None:
        self._studio = studio
        kept = app.storage.client.setdefault("plan", dict(_FIRST_VALUES))  # while a person is at other panels
        with ui.element().classes("sheet"):
            html.h2("What")
            self._picture = PictureChoice(studio, self._follow)
            self._text = ui.input("Or say in words what to paint").bind_value(kept, "text").props("maxlength=300")
        with ui.element().classes("sheet"):
            html.h2("With what")
            with ui.element().classes("numbers"):
                self._style = ui.select([], label="Hand", on_change=self._learn_of_hand)
                self._hand_size = ui.number("Hand size", step=0.1, suffix="times").bind_value(kept, "hand_size")
                self._brush = ui.select(list(BRUSHES.paths()), label="Brush").bind_value(kept, "brush")
                self._size = ui.select(_SIZES, label="Sheet").bind_value(kept, "size")
                self._kind = ui.select({"paints": "Paints", "ink": "One ink"}, label="Colours").bind_value(kept, "kind")
                self._paints = ui.number("How many", min=1, max=_MOST_PAINTS, precision=0).bind_value(kept, "paints")
                self._ink = ui.color_input("The ink").bind_value(kept, "ink")
                self._strokes = ui.number("Strokes", min=1, max=_MOST_STROKES, step=50, precision=0)
                self._strokes.bind_value(kept, "strokes")
                self._drawing = ui.select(DRAWN, label="What it draws").bind_value(kept, "drawing")
                self._enough = ui.checkbox("As many strokes as the picture needs").bind_value(kept, "enough")
        with ui.element().classes("sheet"):
            html.h2("What matters")
            self._weights = weight_sliders({name: float(name == "tone") for name in PICTURE_TERMS})
            self._arrange = Slider("As the hand arranges", 1, 0.25, _DEFAULT.arrange)
            self._effort = ui.select(_EFFORTS, label="How long").bind_value(kept, "effort")
        self._go = (
            ui.button("Plan it", icon="play_arrow", on_click=self._plan).props("unelevated no-caps").classes("go")
        )
        self._is_arranged = False
        for choice in (self._kind, self._enough):
            choice.on_value_change(self._follow)
        shown_by(self._style, studio.styles.changed, lambda: self._show_styles(style))
        self._follow()

    def _follow(self) -> None:
        """Show what means something beside what is chosen."""
        one_ink, of_picture = self._kind.value == "ink", self._picture.path is not None
        self._paints.visible, self._ink.visible = not one_ink, one_ink
        self._drawing.visible = one_ink and of_picture
        self._enough.visible = one_ink and of_picture and self._style.value != _FREE
        self._strokes.set_enabled(not self._takes_enough)
        self._arrange.element.visible = one_ink and self._is_arranged

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
        self._size.set_options({options.size: in_words(options.size), **_SIZES})
        self._effort.set_options({options.steps: f"{options.steps} steps", **_EFFORTS})
        app.storage.client["plan"].update(values_of(options, _FIRST_VALUES))
        if options.style in self._style.options:
            self._style.value = options.style
        for name, slider in self._weights.items():
            slider.set(options.weights.get(name, 0.0) if options.weights else float(name == "tone"))
        self._arrange.set(options.arrange)
        ui.run_javascript("scrollTo({ top: 0, behavior: 'smooth' })")
        self._picture.choose(plan.request.picture)
        ui.notify(f"The form is filled as for {plan.title}. Change what you like, then “Plan it”.", type="positive")

    def _plan(self) -> None:
        plan = self._studio.plans.add(self._request())
        self._go.disable()  # or a double click would plan it twice
        ui.timer(_PAUSE, self._go.enable, once=True)
        ui.notify(f"{plan.title} is being planned", type="positive")

    def _request(self) -> PlanRequest:
        """Return the request that the form describes. Raises InputError for a value that cannot be used."""
        text = str(self._text.value or "").strip() or None
        picture = self._picture.path
        if picture is None and text is None:
            raise InputError("there is nothing to paint yet; bring a picture, or write a text")
        if text is not None and find_spec("open_clip") is None:
            raise InputError("this studio cannot read texts, for CLIP is not installed; bring a picture")
        strokes: int | Literal["auto"] = AUTO
        if not self._takes_enough:
            strokes = _whole(self._strokes, "the number of strokes", _MOST_STROKES)
        if self._hand_size.value is None:
            raise InputError.of_range(option("hand_size"), "nothing", "a number of times")
        size, ink = str(self._size.value), str(self._ink.value) if self._kind.value == "ink" else None
        parse_size(size)
        paints = None
        if ink is not None:
            parse_colour(ink)
        elif strokes != AUTO:
            paints = min(_whole(self._paints, "the number of paints", _MOST_PAINTS), strokes)
        weights = {name: slider.value for name, slider in self._weights.items()}
        options = PlanOptions(
            text=text,
            weights={} if picture is None else weights if text is not None else check_weights(weights),
            size=size,
            strokes=strokes,
            paints=paints,
            ink=ink,
            brush=str(self._brush.value),
            style=str(self._style.value),
            hand_size=self._hand_size.value,
            drawing=str(self._drawing.value) if self._drawing.visible else _DEFAULT.drawing,
            arrange=self._arrange.value if self._arrange.element.visible else _DEFAULT.arrange,
            steps=int(self._effort.value or 0),
        )
        return PlanRequest(picture, options)


def _whole(number: ui.number, name: str, most: int) -> int:
    value = number.value
    if value is None or not 1 <= value <= most or value != int(value):
        raise InputError.of_range(
            name, "nothing" if value is None else f"{value:g}", f"a whole number from 1 to {most}"
        )
    return int(value)
