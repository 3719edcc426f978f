"""Numbers that people type into fields."""

from maulstick.errors import InputError


def number(typed: float | None, name: str, least: float, most: float, unit: str) -> float:
    """Check what was typed, None for nothing. name, unit: in errors.

    Raises InputError where it is no number from `least` to `most`.
    """
    if typed is None or not least <= typed <= most:
        shown = "nothing" if typed is None else f"{typed:g} {unit}"
        raise InputError.of_range(name, shown, f"from {least:g} to {most:g} {unit}")
    return typed


def whole_number(typed: float | None, name: str, least: int, most: int) -> int:
    """Check what was typed, None for nothing. name: in errors.

    Raises InputError where it is no whole number from `least` to `most`.
    """
    if typed is None or not least <= typed <= most or typed != int(typed):
        shown = "nothing" if typed is None else f"{typed:g}"
        raise InputError.of_range(name, shown, f"a whole number from {least} to {most}")
    return int(typed)
