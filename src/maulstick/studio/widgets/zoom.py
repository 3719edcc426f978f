"""Two pictures of a sheet, one over the other, which a person zooms and moves together."""

from typing import Final, final

from nicegui import ui
from nicegui.element import Element

_PER_METRE: Final = 96 / 25.4e-3  # CSS pixels
_BUTTONS: Final = (
    ("", "zoom_in", "Nearer", "nearer"),
    ("", "zoom_out", "Farther", "farther"),
    ("1:1", None, "True size: a millimetre is a millimetre", "showTrueSize"),
    ("", "fit_screen", "All of it", "fit"),
)
"""Buttons by text, icon, what they do in words, and the component's method for it."""


@final
class ZoomedSheet(Element, component="zoom.js"):
    """Picture of a sheet, and over its right part another: by wheel, fingers, pen, mouse and keys.

    size: of the sheet, metres.  label: what it is, for screen readers.
    """

    def __init__(self, size: tuple[float, float], label: str) -> None:
        super().__init__()
        width, height = (side * _PER_METRE for side in size)
        self._props.update(source="", other="", alt="", otherAlt="", label=label, wide=width, high=height)

    def show(self, source: str, alt: str, other: str = "", other_alt: str = "") -> None:
        """Show a picture by its address, and another one over it; "" for none."""
        with self._props.suspend_updates():
            self._props.update(source=source, alt=alt, other=other, otherAlt=other_alt)
        self.update()

    def buttons(self) -> None:
        """Make the buttons that zoom."""
        for text, icon, words, method in _BUTTONS:
            button = ui.button(text, icon=icon).props("flat round").tooltip(words)
            button.on("click", js_handler=self._call(method)).props["aria-label"] = words

    def parting(self) -> str:
        """Return the script for a slider from 0 to 100 that parts the two pictures."""
        return f"(event) => runMethod({self.id}, 'part', [Number(event.target.value)])"

    def _call(self, method: str) -> str:
        return f"() => runMethod({self.id}, '{method}', [])"
