"""Choice of the sheet: its size, how it is turned, its margins, and how the picture fits it, with a sketch of it."""

from contextlib import suppress
from typing import Any

from nicegui import background_tasks, html, ui
from nicegui.elements.mixins.value_element import ValueElement

from maulstick.errors import MaulstickError
from maulstick.painting.raster import parse_size
from maulstick.robot.sheet_reach import is_beyond, sheet_fault
from maulstick.studio.panels.plan.editor import PictureEditor
from maulstick.studio.panels.plan.pictures import PictureChoice
from maulstick.studio.state.placing import AS_SUITS, Placing
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.number_field import NumberField
from maulstick.studio.widgets.sheet_sizes import in_words
from maulstick.studio.widgets.showing import as_source
from maulstick.studio.wording import error_text
from maulstick.studio.workers.sketch import sketch

OWN = "own"
"""Size that a person types."""

SIZES = {size: in_words(size) for size in ("200x160mm", "160x160mm", "A5", "A4", "A3")} | {OWN: "Another size"}
TURNS = {AS_SUITS: "As the picture", "standing": "Standing", "lying": "Lying"}
FITS = {AS_SUITS: "As suits it", "contain": "All of it", "cover": "Fills the sheet"}
"""Sizes, ways to turn the sheet, and ways in which a picture fits it, with their words for people."""


class SheetChoice:
    """Fields about the sheet, and a sketch of it. kept: what the page keeps, the size among it."""

    def __init__(self, studio: Studio, kept: dict[str, Any], picture: PictureChoice, editor: PictureEditor) -> None:
        self._studio, self._kept, self._picture, self._editor = studio, kept, picture, editor
        self._is_sketching = self._is_stale = False
        with ui.element().classes("numbers") as self.root:
            self._size = ui.select(SIZES, label="Sheet").bind_value(kept, "size")
            self._turned = ui.select(TURNS, label="Turned").bind_value(kept, "turned")
            self._own = ui.input("Width by height").bind_value(kept, "own_size").classes("own-size")
            self._own.props("debounce=400 hint='in mm, cm or in: 17 by 23 cm'")
            self._fit = ui.select(FITS, label="How the picture fits").bind_value(kept, "fit")
            self._margin = NumberField("Margin, mm", min=0).bind_value(kept, "margin").props("debounce=400")
        self._beyond = ui.label().classes("beyond").props('role="status"')
        with html.figure().classes("sketch") as self._sketch:
            self._image = html.img(alt="The picture on its sheet")
            with html.figcaption():
                self._told = ui.label().classes("hint").props('role="status"')
        self.fields: tuple[ValueElement[Any], ...] = (self._size, self._turned, self._own, self._fit, self._margin)
        for field in self.fields:
            field.on_value_change(self.follow)

    def placing(self) -> Placing:
        """Return what the fields say of the chosen picture. Raises InputError for what cannot be."""
        name = self._picture.name
        shape = None if name is None else self._editor.edit.shape(self._studio.gallery.shape(name))
        size = str(self._own.value if self._size.value == OWN else self._size.value)
        return Placing.of(size, str(self._turned.value), str(self._fit.value), self._margin.value or 0, shape)

    def follow(self) -> None:
        """Show the fields that mean something, what the machine does not reach, and sketch the sheet again."""
        self._own.visible = self._size.value == OWN
        self._fit.visible = self._sketch.visible = self._picture.name is not None
        self._compare_with_machine()
        self._is_stale = self._picture.name is not None
        if self._is_stale and not self._is_sketching:
            self._is_sketching = True
            background_tasks.create(self._sketch_until_fresh(), context=self.root)

    def _compare_with_machine(self) -> None:
        """Mark the sizes that the machine does not reach, and say it of the sheet that is chosen."""
        machine, fault = str(self._kept["machine"]), ""
        beyond = [size for size in SIZES if size != OWN and is_beyond(machine, *parse_size(size))]
        sizes = {
            size: f"{words}: larger than the machine reaches" if size in beyond else words
            for size, words in SIZES.items()
        }
        if sizes != self._size.options:
            self._size.set_options(sizes)
        with suppress(MaulstickError):  # the sketch says what is wrong with the size
            fault = sheet_fault(machine, *parse_size(self.placing().size))
        self._beyond.text = fault[:1].upper() + fault[1:] + ("." if fault else "")
        self._beyond.visible = bool(fault)

    async def _sketch_until_fresh(self) -> None:
        """Sketch what is chosen now, and again where it changed meanwhile."""
        try:
            while self._is_stale and not self.root.is_deleted:
                self._is_stale = False
                await self._sketch_now()
        finally:
            self._is_sketching = False

    async def _sketch_now(self) -> None:
        name, edit = self._picture.name, self._editor.edit
        if name is None:
            return
        try:
            placing, thumbnail = self.placing(), self._studio.gallery.small(name)
            made = await self._studio.desk.do(sketch, thumbnail, edit, placing.size, placing.fit, placing.margin)
        except MaulstickError as error:
            self._image.visible = False
            self._told.set_text(error_text(error))
            return
        self._image.visible = True
        self._image.props["src"] = as_source(made.sheet)
        self._told.set_text(made.told)
        self._editor.show(made.picture, made.ratio)
