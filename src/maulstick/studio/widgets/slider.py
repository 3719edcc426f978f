"""Slider of the browser itself, which works with keys and screen readers."""

from collections.abc import Callable
from math import isfinite

from nicegui import events, html, ui

_TELL = "(event) => emit(Number(event.target.value))"


class Slider:
    """Slider from `least` to `most`, in steps, below its label.

    on_change: called, and awaited, after a person lets go of the slider, or also while they move it where `live` is
    true.
    """

    def __init__(
        self,
        label: str,
        most: float,
        step: float,
        value: float,
        on_change: Callable[[], object] = lambda: None,
        *,
        least: float = 0.0,
        live: bool = False,
    ) -> None:
        self.value, self._least, self._most, self._on_change = value, least, most, on_change
        with html.label().classes("weight") as self.element:
            ui.label(label)
            self._range = html.input_(type="range", min=least, max=most, step=step)
            self._range.props["^value"] = value  # where it begins; as a property, Vue would keep putting it back there
            self._range.on("change", self._moved, js_handler=_TELL)  # at once, before whatever is done next
            if live:
                self._range.on("input", self._moved, js_handler=_TELL, throttle=0.1)

    def set(self, value: float, most: float | None = None) -> None:
        """Move the slider, and its upper end where `most` is given."""
        self._most = self._most if most is None else most
        self.value = value
        self._range.props["max"] = self._most
        slider = f"document.getElementById('{self._range.html_id}')"  # none where it is in a menu that is closed
        ui.run_javascript(f"setTimeout(() => {{ const slider = {slider}; if (slider) slider.value = {value}; }})")

    def focus(self) -> None:
        """Give the slider the focus, which moves it into sight."""
        ui.run_javascript(f"setTimeout(() => document.getElementById('{self._range.html_id}')?.focus())")

    def _moved(self, event: events.GenericEventArguments) -> object:
        sent = event.args
        if not (isinstance(sent, int | float) and isfinite(sent)):
            return None
        value = min(max(float(sent), self._least), self._most)
        if value == self.value:
            return None
        self.value = value
        return self._on_change()  # which NiceGUI awaits where it is a coroutine
