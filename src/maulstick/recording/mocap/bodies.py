"""Choice of the pen and the canvas among the rigid bodies that motion capture tracks."""

from collections.abc import Mapping, Sequence

from maulstick.errors import InputError, option
from maulstick.storage.text import counted

CANVAS_MARKERS = 3
"""Number of markers on a canvas, each at a different corner."""

_PEN = ("pen", "brush", "stylus")  # words in the name of a pen's rigid body
_CANVAS = ("canvas", "paper", "board", "sheet")  # words in the name of a canvas's
_LISTED = 12  # rigid bodies that a message lists at most


def check_names(names: Sequence[str]) -> None:
    """Raise InputError where two rigid bodies have one name, so that one would be taken for the other."""
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise InputError(f"two rigid bodies are called {twice[0][:40]!r}; rename one in Motive, and try again")


def pen_and_canvas(
    markers: Mapping[str, int], loose: int, pen: str | None = None, canvas: str | None = None
) -> tuple[str, str | None]:
    """Return the names of the rigid bodies of the pen and of the canvas; None where the canvas is three loose markers.

    markers: number of markers of each rigid body.  loose: number of markers that belong to none.

    The pen is the rigid body named `pen`; or the only one whose name contains pen, brush or stylus; or the only one
    that is not the canvas.  The canvas is the rigid body named `canvas`, or the only one whose name contains canvas,
    paper, board or sheet, with exactly three markers; or three loose markers, if there are exactly three.

    Raises InputError, listing the rigid bodies, where that leaves none or several.
    """
    there = f"there are {_listed(markers)} and {loose} loose markers"
    for name in (pen, canvas):
        if name is not None and name not in markers:
            raise InputError(f"there is no rigid body {name!r}; {there}")
    if pen is not None and pen == canvas:
        raise InputError(f"the pen and the canvas are both {pen!r}; they must be two rigid bodies")
    if canvas is not None and markers[canvas] != CANVAS_MARKERS:
        raise InputError(
            f"the canvas {canvas!r} has {counted(markers[canvas], 'marker')}; it must have exactly three, "
            "each at a corner"
        )
    if canvas is None:
        named = [name for name in _named(markers, _CANVAS) if name != pen and markers[name] == CANVAS_MARKERS]
        if len(named) > 1 or (not named and loose != CANVAS_MARKERS):
            raise InputError(
                f"there is no telling which is the canvas; name it ({option('sheet')}), a rigid body of "
                "exactly three markers, "
                f"or let exactly three markers be loose: {there}"
            )
        canvas = named[0] if named else None
    if pen is None:
        others = [name for name in markers if name != canvas]
        named = _named(others, _PEN)
        if len(named) != 1 and len(others) != 1:
            raise InputError(f"there is no telling which rigid body is the pen; name it ({option('pen')}): {there}")
        pen = named[0] if len(named) == 1 else others[0]
    return pen, canvas


def _named(names: Mapping[str, int] | list[str], words: tuple[str, ...]) -> list[str]:
    return [name for name in names if any(word in name.casefold() for word in words)]


def _listed(markers: Mapping[str, int]) -> str:
    if not markers:
        return "no rigid bodies"
    names = [f"{name[:40]!r} ({counted(count, 'marker')})" for name, count in markers.items()]
    more = [f"{len(names) - _LISTED} more"] if len(names) > _LISTED else []
    return "the rigid bodies " + ", ".join(names[:_LISTED] + more)
