"""Names of regions: what no region covers has one, and those by which strokes are named are no region's."""

import re
from typing import Final

REST: Final = "rest"
"""Name of what no region of a map covers."""

_OF_STROKES = re.compile(r"all|\d+(-\d+)?")


def names_strokes(name: str) -> bool:
    """Return whether a name is one by which strokes are named where a region's name may stand."""
    return _OF_STROKES.fullmatch(name) is not None
