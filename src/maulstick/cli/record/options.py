"""The options of the words that record a tracked pen."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from maulstick.errors import InputError
from maulstick.painting.raster import parse_length
from maulstick.storage.arrays import Floats

if TYPE_CHECKING:
    from maulstick.recording.mocap.contact import ContactOptions

_AXES = {"x": (1, 0, 0), "-x": (-1, 0, 0), "y": (0, 1, 0), "-y": (0, -1, 0), "z": (0, 0, 1), "-z": (0, 0, -1)}
"""Directions by name, in the frame of the pen's rigid body."""

_LONGEST_PEN = 2.0  # metres: beyond, the unit is probably wrong
_SECONDS = {"ms": 1e-3, "s": 1.0}
"""Seconds per unit of time."""

MERGE, SHORTEST = "20ms", "30ms"
"""What `ContactOptions` has by default, which loads scipy."""

_THE_PEN = "The pen and the canvas"
_TOUCHING = "When the pen touches"

PenLength = Annotated[
    str | None,
    typer.Option(metavar="LENGTH", rich_help_panel=_THE_PEN, help="From its rigid body to its tip, as in 139mm."),
]
PenAxis = Annotated[
    str,
    typer.Option(
        metavar="AXIS",
        rich_help_panel=_THE_PEN,
        help="Of its rigid body, towards the tip: x, -x, y, -y, z, -z. It is -y where the pen stood upright when its "
        "rigid body was made, since y is up in Motive.",
    ),
]
PivotTake = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        rich_help_panel=_THE_PEN,
        help="Instead of the length: a take of the pen leaning to all sides about its tip, which stands still.",
    ),
]
Pen = Annotated[
    str | None,
    typer.Option(
        metavar="NAME", rich_help_panel=_THE_PEN, show_default="found by its name", help="The pen's rigid body."
    ),
]
Board = Annotated[
    str | None,
    typer.Option(
        metavar="NAME", rich_help_panel=_THE_PEN, show_default="found by its name", help="The canvas's rigid body."
    ),
]
Corner = Annotated[
    str,
    typer.Option(
        metavar="CORNER",
        rich_help_panel=_THE_PEN,
        help="Where the marker at the right angle sits: upper-left, upper-right, lower-right, lower-left.",
    ),
]
Threshold = Annotated[
    str | None,
    typer.Option(
        metavar="HEIGHT",
        rich_help_panel=_TOUCHING,
        show_default="proposed from the data",
        help="Over the paper, under which the tip touches, as in 0.5mm.",
    ),
]
Merge = Annotated[
    str, typer.Option(metavar="TIME", rich_help_panel=_TOUCHING, help="A lift that is no longer is none.")
]
Shortest = Annotated[
    str, typer.Option(metavar="TIME", rich_help_panel=_TOUCHING, help="A touch that is shorter is none.")
]
Plot = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        show_default="NAME.contact.png",
        help="Where the plot of heights goes, to judge the threshold by.",
    ),
]
Overwrite = Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace files that are there.")]


def contact_options(threshold: str | None, merge: str, shortest: str) -> "ContactOptions":
    """Options from what was written. Raises InputError where they make no sense."""
    from maulstick.recording.mocap.contact import ContactOptions  # loads scipy

    height = None if threshold is None else parse_length(threshold)
    return ContactOptions(height, merge=_seconds("--merge", merge), shortest=_seconds("--shortest", shortest))


def tip_of(length: str | None, axis: str, pivot: Path | None, pen: str | None, board: str | None) -> tuple[Floats, str]:
    """The tip (3,), metres in the frame of the pen's rigid body, and how it is known, for people.

    Raises InputError where not exactly one of length and pivot take is there, or it cannot be used.
    """
    if (length is None) == (pivot is None):
        raise InputError("say where the pen's tip is: with --pen-length, as in 139mm, or with a pivot take, --pivot")
    if axis not in _AXES:
        raise InputError.of_choice("axis", axis, _AXES)
    if length is not None:
        metres = parse_length(length)
        if not 0 <= metres <= _LONGEST_PEN:
            raise InputError.of_range("--pen-length", length, "at most 2 m")
        return metres * np.array(_AXES[axis], dtype=np.float64), f"the tip is {length} from the rigid body along {axis}"
    assert pivot is not None
    from maulstick.recording.mocap.motive import read_motive  # these load pandas and scipy
    from maulstick.recording.mocap.pivot import calibrate_pivot

    found = calibrate_pivot(read_motive(pivot, pen, board))
    place = ", ".join(f"{1e3 * along:.1f}" for along in found.tip)
    return found.tip, (
        f"the tip is at ({place}) mm in the rigid body; in the pivot take it strayed by {found.residual * 1e3:.2f} mm "
        f"(RMS), without {found.rejected} outliers"
    )


def _seconds(name: str, text: str) -> float:
    match = re.fullmatch(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(ms|s)\s*", text)
    if match is None:
        raise InputError(f"{name} is {text!r}; write a time and its unit, as in 20ms or 0.02s")
    return float(match[1]) * _SECONDS[match[2]]
