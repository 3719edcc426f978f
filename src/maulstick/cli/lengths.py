"""Lengths that are typed: in millimetres, or with their unit."""

import re

from maulstick.errors import InputError
from maulstick.painting.raster import parse_length


def with_unit(text: str) -> str:
    """Return a length with its unit: 10 as ``10mm``, and all else as it was typed."""
    return f"{text}mm" if re.fullmatch(r"\d+\.?\d*|\.\d+", text) else text


def metres(text: str, option: str) -> float:
    """Return metres of a length that was typed for an option. Raises InputError, which names it, where it is none."""
    try:
        return parse_length(with_unit(text))
    except InputError:
        raise InputError(f"{option} is {text!r}; it must be a length, as 10 for millimetres, 10mm or 1cm") from None
