"""Editor of the chosen picture: it is turned, straightened, cut and toned, in steps that fingers and keys can make."""

import base64
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from nicegui import html, ui

from maulstick.painting.edit import MOST_STRAIGHTENED, NO_EDIT, Crop, PictureEdit
from maulstick.studio.widgets.slider import Slider

_EDGES = ("left", "top", "right", "bottom")
_LEAST_KEPT = 5  # per cent of a side, so that edges do not meet
_MOST_STOPS, _MOST_CONTRAST = 3.0, 2.0  # that a slider reaches; the command line goes further
_LEAST_CONTRAST = 0.5
_EDITS = "edits"  # in what a page keeps: the edits by name of their picture


class PictureEditor:
    """Editor that keeps an edit for each picture. kept: what the page keeps.  changed: called after each change."""

    def __init__(self, kept: dict[str, Any], changed: Callable[[], object]) -> None:
        self._edits: dict[str, PictureEdit] = kept.setdefault(_EDITS, {})
        self._name, self._changed = "", changed
        self.root = ui.expansion("Correct the picture").classes("more editor")
        with self.root:
            with ui.element().classes("cutting"):
                self._picture = html.img(alt="The picture as it is corrected")
                self._frame = html.div().classes("kept").props("aria-hidden=true")
            with ui.element().classes("line"):
                ui.button("Turn left", icon="rotate_left", on_click=lambda: self._turn(-90)).props("flat")
                ui.button("Turn right", icon="rotate_right", on_click=lambda: self._turn(90)).props("flat")
                ui.button("As it was", icon="undo", on_click=lambda: self._take(NO_EDIT)).props("flat")
            self._cuts = [Slider(f"Cut off at the {edge}", 95, 1, 0, self._moved, live=True) for edge in _EDGES]
            most = MOST_STRAIGHTENED
            self._straighten = Slider("Straighten", most, 0.5, 0, self._moved, least=-most, live=True)
            self._exposure = Slider(
                "Darker or lighter", _MOST_STOPS, 0.25, 0, self._moved, least=-_MOST_STOPS, live=True
            )
            self._contrast = Slider("Contrast", _MOST_CONTRAST, 0.05, 1, self._moved, least=_LEAST_CONTRAST, live=True)

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
        """Take an edit for the picture that is shown."""
        self._take(edit)

    def show(self, picture: bytes) -> None:
        """Show the picture, a JPEG, before it is cut."""
        self._picture.props["src"] = as_source(picture)

    def _turn(self, degrees: int) -> None:
        """Turn the picture clockwise by 90 degrees, or -90, with what is cut off."""
        left, top, right, bottom = self.edit.crop
        crop = (1 - bottom, left, 1 - top, right) if degrees > 0 else (top, 1 - right, bottom, 1 - left)
        self._take(replace(self.edit, rotate=(self.edit.rotate + degrees) % 360, crop=_rounded(crop)))

    def _take(self, edit: PictureEdit) -> None:
        self._edits[self._name] = edit
        self._fill(edit)
        self._changed()

    def _moved(self) -> None:
        """Take what the sliders say; of two edges that would meet, the one that was there before gives way."""
        now = [round(slider.value) for slider in self._cuts]
        before = _cut_off(self.edit.crop)
        for first, last in ((0, 2), (1, 3)):
            giving = last if now[first] != before[first] else first
            if now[first] + now[last] > 100 - _LEAST_KEPT:
                other = first + last - giving
                now[giving] = max(100 - _LEAST_KEPT - now[other], 0)
                self._cuts[giving].set(now[giving])
        self._edits[self._name] = replace(
            self.edit,
            crop=(now[0] / 100, now[1] / 100, 1 - now[2] / 100, 1 - now[3] / 100),
            straighten=self._straighten.value,
            exposure=self._exposure.value,
            contrast=self._contrast.value,
        )
        self._draw_frame()
        self._changed()

    def _fill(self, edit: PictureEdit) -> None:
        for slider, cut in zip(self._cuts, _cut_off(edit.crop), strict=True):
            slider.set(cut)
        self._straighten.set(edit.straighten)
        self._exposure.set(edit.exposure)
        self._contrast.set(edit.contrast)
        self._draw_frame()

    def _draw_frame(self) -> None:
        left, top, right, bottom = _cut_off(self.edit.crop)
        self._frame.style(f"inset: {top}% {right}% {bottom}% {left}%")


def as_source(jpeg: bytes) -> str:
    """Return a JPEG as the source of an image on the page."""
    return f"data:image/jpeg;base64,{base64.b64encode(jpeg).decode()}"


def _cut_off(crop: Crop) -> list[int]:
    """Return how much a crop cuts off at each edge, per cent of a side."""
    left, top, right, bottom = crop
    return [round(100 * share) for share in (left, top, 1 - right, 1 - bottom)]


def _rounded(crop: Crop) -> Crop:
    left, top, right, bottom = (round(edge, 2) for edge in crop)
    return left, top, right, bottom
