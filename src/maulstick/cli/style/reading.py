"""Reading of styles for the commands that show their strokes."""

import os
from collections.abc import Sequence
from pathlib import Path

from maulstick.errors import InputError
from maulstick.style.cards import style_path
from maulstick.style.store import Fitted, read_style


def read_fitted(names: Sequence[str]) -> list[Fitted]:
    """Read the styles with these names or paths.

    Raises InputError where there is none, for ``free``, which has no strokes, and for one that is named twice.
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
