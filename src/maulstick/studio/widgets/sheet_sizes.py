"""Sizes of sheets that forms offer, and their names for people."""

from typing import Final

SHEET_SIZES: Final = (
    "200x160mm",
    "160x200mm",
    "160x160mm",
    "A5",
    "A5-landscape",
    "A4",
    "A4-landscape",
    "A3",
    "A3-landscape",
)
"""Sizes as for `parse_size`."""


def in_words(size: str) -> str:
    """Return the size of a sheet for people: ``200 mm by 160 mm`` for ``200x160mm``."""
    return size.replace("x", " by ").replace("mm", " mm").replace("-landscape", ", lying")
