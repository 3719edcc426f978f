"""Lengths of CSS in pixels."""

import re

from maulstick.recording.files.markup import METRES

_FONT_UNITS = {"em": 16.0, "rem": 16.0, "ex": 8.0, "ch": 8.0}  # pixels of a usual font: a drawing has no text
_LENGTH = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([a-zA-Z]+|%|)\s*")


def pixels(text: str | None, whole: float = 0.0) -> float | None:
    """Return a length in pixels, 96 per inch, or None where it is none; a percentage is of `whole`."""
    match = _LENGTH.fullmatch(text or "")
    if match is None:
        return None
    number, unit = float(match[1]), match[2].lower()
    if unit == "%":
        return number / 100 * whole
    if unit in _FONT_UNITS:
        return number * _FONT_UNITS[unit]
    return number * METRES[unit or "px"] / METRES["px"] if unit in (*METRES, "") else None
