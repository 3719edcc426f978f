"""Form for how a drawing is read: its sheet, margin and turn, and the hatching of its fills."""

from collections.abc import Callable
from math import degrees, radians
from typing import Any

from nicegui import ui

from maulstick.drawing.options import DrawingOptions
from maulstick.painting.raster import parse_size
from maulstick.studio.panels.paint.form import SHORT_MENU
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.number_field import NumberField
from maulstick.studio.widgets.sheet_sizes import SHEET_SIZES, in_words
from maulstick.studio.widgets.showing import shown_by

_TURNS = {0: "As it is", 90: "A quarter to the right", 180: "Upside down", 270: "A quarter to the left"}
_FINEST = 9  # digits after the point of millimetres and degrees: as many as come back the same
_AS_TYPED = "outlined clearable debounce=700"  # milliseconds without a key, after which a drawing is read again


class ReadingForm:
    """Form for a drawing's options, by which it is read again at each change and with which they are kept.

    touched: called after a person has changed a field.
    """

    def __init__(self, studio: Studio, touched: Callable[[], None]) -> None:
        self._studio, self._name = studio, ""
        self._shown: DrawingOptions | None = None
        self.root = ui.expansion("How the drawing is read").classes("more")
        with self.root:
            sizes = {"": "As large as its page", **{size: in_words(size) for size in SHEET_SIZES}}
            self._size = ui.select(sizes, label="Sheet", value="").props(SHORT_MENU)
            self._margin = NumberField("Margin, mm", min=0).props(_AS_TYPED)
            self._margin.props("hint='what is drawn is scaled; empty: as on its page'")
            self._rotate = ui.select(_TURNS, label="Turn", value=0).props(SHORT_MENU)
            self._hatch = NumberField("Hatching, mm between lines", min=0, on_change=self._fit)
            self._hatch.props(_AS_TYPED).props("hint='empty: fills stay empty'")
            self._angle = NumberField("Angle of the lines, degrees").props(_AS_TYPED)
            self._angle.props("hint='empty: 45, or as the hand leans'")
            self._hand = ui.select({}, label="Hatch with").props(SHORT_MENU)
            self._repeats = ui.switch("Leave out paths that are there twice")
            self._join = NumberField("Join ends nearer than, mm", min=0).props(_AS_TYPED)
            self._join.props("hint='the pen stays down from path to path; empty: none'")
            self._reading = ui.label("Reading it …").props('role="status"').classes("hint")
        self._reading.visible = False
        hatching = (self._hatch, self._angle, self._hand)
        for field in (self._size, self._margin, self._rotate, *hatching, self._repeats, self._join):
            field.on("update:model-value", touched, args=[])
            field.on("update:model-value", self._read, args=[])
        shown_by(self._hand, studio.styles.changed, self._offer_hands)
        shown_by(self.root, studio.svgs.changed, lambda: self.show(self._name))

    def show(self, name: str) -> None:
        """Show the options of the drawing of that name, or nothing where there is none."""
        card = self._studio.svgs.card(name) if name else None
        self._name, self.root.visible = name, card is not None
        if card is not None and card.options != self._shown:
            self._fill(card.options)

    @property
    def options(self) -> DrawingOptions:
        """Options as filled in; any of them may be out of its range."""
        hatch, size = self._hatch.value, str(self._size.value or "")
        given: dict[str, Any] = {
            "size": parse_size(size) if size else None,
            "margin": None if self._margin.value is None else 1e-3 * self._margin.value,
            "rotate": self._rotate.value,
            "no_repeats": bool(self._repeats.value),
            "join": 1e-3 * (self._join.value or 0.0),
        }
        if hatch is not None:
            angle = self._angle.value
            given |= {"hatch": 1e-3 * hatch, "hatch_hand": str(self._hand.value or "") or None}
            given |= {"hatch_angle": None if angle is None else radians(angle)}
        return DrawingOptions.model_validate(given)

    async def _read(self) -> None:
        """Read the drawing again, unless it was read so."""
        name = self._name
        card = self._studio.svgs.card(name) if name else None
        if card is None or card.options == (options := self.options):
            return
        self._shown, self._reading.visible = options, True
        try:
            await self._studio.svgs.read(name, options)
        finally:
            self._reading.visible = False

    def _fill(self, options: DrawingOptions) -> None:
        self._shown = options
        self._size.value = next((size for size in SHEET_SIZES if parse_size(size) == options.size), "")
        self._margin.value = None if options.margin is None else round(1e3 * options.margin, _FINEST)
        self._rotate.value = options.rotate
        self._hatch.value = None if options.hatch is None else round(1e3 * options.hatch, _FINEST)
        self._angle.value = None if options.hatch_angle is None else round(degrees(options.hatch_angle), _FINEST)
        self._offer_hands(options.hatch_hand or "")
        self._repeats.value = options.no_repeats
        self._join.value = round(1e3 * options.join, _FINEST) or None
        self._fit()

    def _fit(self) -> None:
        self._angle.visible = self._hand.visible = self._hatch.value is not None

    def _offer_hands(self, chosen: str | None = None) -> None:
        value = str(self._hand.value or "") if chosen is None else chosen
        strokes = {name: f"Strokes of {title}" for name, title in self._studio.styles.titles().items()}
        hands = {"": "Straight lines", **strokes}
        self._hand.set_options(hands, value=value if value in hands else "")
