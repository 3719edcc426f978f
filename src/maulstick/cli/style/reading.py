"""The styles that have a hand, for the words that look at it."""

import os
from collections.abc import Sequence
from pathlib import Path

from maulstick.errors import InputError
from maulstick.style.cards import style_path
from maulstick.style.store import Fitted, read_style


def read_fitted(names: Sequence[str]) -> list[Fitted]:
    """The styles of these names or at these paths.

    Raises InputError where there is none, where it is nobody's, and where two are the same.
    """
    paths: dict[str, Path] = {}
    for name in names:
        path = _fitted_path(name)
        place = os.path.realpath(path)
        if place in paths:
            raise InputError(f"{name} is named twice; name each style once")
        paths[place] = path
    return [read_style(path) for path in paths.values()]


def _fitted_path(name: str) -> Path:
    if name == "free":
        raise InputError("the style free is nobody's and has no strokes to look at; name one of maulstick style list")
    return style_path(name)
