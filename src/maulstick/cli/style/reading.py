"""The styles that have a hand, for the words that look at it."""

from maulstick.errors import InputError
from maulstick.style.store import Fitted, read_style, style_path


def read_fitted(name: str) -> Fitted:
    """The style of this name or at this path. Raises InputError where there is none, or where it is nobody's."""
    if name == "free":
        raise InputError("the style free is nobody's and has no strokes to look at; name one of maulstick style list")
    return read_style(style_path(name))
