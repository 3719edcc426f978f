"""Editor of the chosen picture: it is turned, straightened, cut and toned, by fingers, pens, mice and keys."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from nicegui import ui

from maulstick.painting.edit import MOST_STRAIGHTENED, NO_EDIT, WHOLE, Crop, PictureEdit
from maulstick.studio.panels.plan.cropping import CropFrame, shaped
from maulstick.studio.widgets.showing import as_source
from maulstick.studio.widgets.slider import Slider

_MOST_STOPS, _MOST_CONTRAST = 3.0, 2.0  # that a slider reaches; the command line goes further
_LEAST_CONTRAST = 0.5
_EDITS = "edits"  # in what a page keeps: the edits by name of their picture
_AS_SHEET = "as_sheet"  # in what a page keeps: whether the frame has the sheet's shape
_HOW = "Drag the frame, its edges or corners. Arrow keys move them, too, and finely with Shift."


class PictureEditor:
    """Editor that keeps an edit for each picture. kept: what the page keeps.  changed: called after each change."""

    def __init__(self, kept: dict[str, Any], changed: Callable[[], object]) -> None:
        self._edits: dict[str, PictureEdit] = kept.setdefault(_EDITS, {})
        self._name, self._changed, self._drawn = "", changed, WHOLE
        self._source = ""  # of the picture
        self._sheet_ratio = 0.0  # of the sheet's sides, in shares of the picture; 0 until it is known
        kept.setdefault(_AS_SHEET, False)
        self.root = ui.expansion("Correct the picture").classes("more editor")
        with self.root:
            self._frame = CropFrame(self._cut)
            ui.label(_HOW).classes("hint")
            self._as_sheet = ui.checkbox("Keep the sheet's shape").bind_value(kept, _AS_SHEET)
            with ui.element().classes("line"):
                ui.button("Turn left", icon="rotate_left", on_click=lambda: self._turn(-90)).props("flat")
                ui.button("Turn right", icon="rotate_right", on_click=lambda: self._turn(90)).props("flat")
                ui.button("As it was", icon="undo", on_click=lambda: self.correct(NO_EDIT)).props("flat")
            most = MOST_STRAIGHTENED
            self._straighten = Slider("Straighten", most, 0.5, 0, self._moved, least=-most, live=True)
            self._exposure = Slider(
                "Darker or lighter", _MOST_STOPS, 0.25, 0, self._moved, least=-_MOST_STOPS, live=True
            )
            self._contrast = Slider("Contrast", _MOST_CONTRAST, 0.05, 1, self._moved, least=_LEAST_CONTRAST, live=True)
        self._as_sheet.on_value_change(self._hold)

    @property
    def edit(self) -> PictureEdit:
        """Edit of the picture that is shown."""
        return self._edits.get(self._name, NO_EDIT)

    def open(self, name: str | None) -> None:
        """Show the sliders of the picture of that name, or nothing."""
        self.root.visible = name is not None
        if name is not None and name != self._name:
            self._name = name
            self._fill(self.edit)

    def correct(self, edit: PictureEdit) -> None:
        """Take an edit for the picture that is shown, in whatever shape it is cut."""
        self._as_sheet.value = False
        self._take(edit)

    def show(self, picture: bytes, sheet_ratio: float) -> None:
        """Show the picture, a JPEG, before it is cut.

        sheet_ratio: of width to height of what the picture may fill of its sheet, in shares of the picture.
        """
        self._sheet_ratio, self._source = sheet_ratio, as_source(picture)
        self._hold()

    def _hold(self) -> None:
        """Give the frame the sheet's shape, where it is to have it, and else the one that was drawn."""
        ratio = self._sheet_ratio if self._as_sheet.value else 0.0
        self._frame.show(self._source, ratio)
        crop = shaped(self._drawn, ratio) if ratio else self._drawn
        if crop != self.edit.crop:
            self._set(replace(self.edit, crop=crop))
            self._frame.lay(crop)

    def _turn(self, degrees: int) -> None:
        """Turn the picture clockwise by 90 degrees, or -90, with what is cut off."""
        left, top, right, bottom = self._drawn
        crop = (1 - bottom, left, 1 - top, right) if degrees > 0 else (top, 1 - right, bottom, 1 - left)
        self._take(replace(self.edit, rotate=(self.edit.rotate + degrees) % 360, crop=_rounded(crop)))

    def _take(self, edit: PictureEdit) -> None:
        self._fill(edit)
        self._set(edit)

    def _set(self, edit: PictureEdit) -> None:
        self._edits[self._name] = edit
        self._changed()

    def _cut(self, crop: Crop) -> None:
        """Take the crop that a person has drawn."""
        self._drawn = crop
        self._set(replace(self.edit, crop=crop))

    def _moved(self) -> None:
        """Take what the sliders say."""
        straighten, exposure, contrast = (slider.value for slider in (self._straighten, self._exposure, self._contrast))
        self._set(replace(self.edit, straighten=straighten, exposure=exposure, contrast=contrast))

    def _fill(self, edit: PictureEdit) -> None:
        self._drawn = edit.crop
        self._frame.lay(edit.crop)
        self._straighten.set(edit.straighten)
        self._exposure.set(edit.exposure)
        self._contrast.set(edit.contrast)


def _rounded(crop: Crop) -> Crop:
    left, top, right, bottom = (round(edge, 4) for edge in crop)
    return left, top, right, bottom
