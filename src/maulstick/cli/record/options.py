"""Options of the commands that read a tracked pen."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from maulstick.cli.lengths import metres, with_unit
from maulstick.errors import InputError
from maulstick.storage.arrays import Floats
from maulstick.storage.text import counted

if TYPE_CHECKING:
    from maulstick.recording.mocap.contact import ContactOptions

_AXES = {"x": (1, 0, 0), "-x": (-1, 0, 0), "y": (0, 1, 0), "-y": (0, -1, 0), "z": (0, 0, 1), "-z": (0, 0, -1)}
_UPRIGHT = "-y"  # of a pen that stood so when its rigid body was made
_LONGEST_PEN = 2.0  # metres: longer ones are slips of the unit
_SECONDS = {"ms": 1e-3, "s": 1.0}
"""Seconds per unit of time."""

MERGE, SHORTEST = "20ms", "30ms"
"""Defaults of `ContactOptions`, written as options; importing that loads scipy."""

_THE_PEN = "The pen and the sheet"
_TOUCHING = "When the pen touches"
WRITING = "What is written"
"""Heading of the options for files."""

OUT = "File to write: NAME.ink.npz, or NAME.strokes.npz for standardised strokes."
"""Help of ``--out``."""

PenLength = Annotated[
    str | None,
    typer.Option(
        metavar="LENGTH", rich_help_panel=_THE_PEN, help="Distance from the pen's rigid body to its tip, as in 139mm."
    ),
]
PenAxis = Annotated[
    str | None,
    typer.Option(
        metavar="AXIS",
        rich_help_panel=_THE_PEN,
        show_default=_UPRIGHT,
        help="Direction from the rigid body to the tip: x, -x, y, -y, z or -z. It is -y if the pen stood upright when "
        "its rigid body was made.",
    ),
]
PivotTake = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        rich_help_panel=_THE_PEN,
        help="Take of the pen leaning to all sides while its tip stands still, instead of --pen-length.",
    ),
]
Pen = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        rich_help_panel=_THE_PEN,
        show_default="found by its name",
        help="Name of the pen's rigid body.",
    ),
]
Board = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        rich_help_panel=_THE_PEN,
        show_default="found by its name",
        help="Name of the rigid body that lies as the sheet does.",
    ),
]
Corner = Annotated[
    str,
    typer.Option(
        metavar="CORNER",
        rich_help_panel=_THE_PEN,
        help="Corner with the marker at the right angle: upper-left, upper-right, lower-right, lower-left.",
    ),
]
Threshold = Annotated[
    str | None,
    typer.Option(
        metavar="HEIGHT",
        rich_help_panel=_TOUCHING,
        show_default="proposed from the data",
        help="Height over the paper below which the tip touches it, as in 0.5mm.",
    ),
]
Merge = Annotated[
    str,
    typer.Option(
        metavar="TIME", rich_help_panel=_TOUCHING, help="Join strokes over lifts that are no longer than this."
    ),
]
Shortest = Annotated[
    str, typer.Option(metavar="TIME", rich_help_panel=_TOUCHING, help="Leave out touches that are shorter than this.")
]
Plot = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        rich_help_panel=WRITING,
        show_default="NAME.contact.png",
        help="File of the plot of heights, to choose the threshold by.",
    ),
]
Overwrite = Annotated[
    bool, typer.Option("--overwrite", metavar="", rich_help_panel=WRITING, help="Replace earlier files.")
]


def contact_options(threshold: str | None, merge: str, shortest: str) -> "ContactOptions":
    """Return the options from their texts. Raises InputError for one that cannot be used."""
    from maulstick.recording.mocap.contact import ContactOptions  # loads scipy

    height = None if threshold is None else metres(threshold, "--threshold")
    return ContactOptions(height, merge=_seconds("--merge", merge), shortest=_seconds("--shortest", shortest))


def tip_of(
    length: str | None, axis: str | None, pivot: Path | None, pen: str | None, board: str | None
) -> tuple[Floats, str]:
    """Return the tip (3,), metres in the frame of the pen's rigid body, and a sentence on how it is known.

    axis: from the rigid body to the tip, for a length; None is that of a pen that stood upright.
    Raises InputError unless exactly one of length and pivot take is given, and where it cannot be used.
    """
    if (length is None) == (pivot is None):
        raise InputError("say where the pen's tip is: with --pen-length, as in 139mm, or with a pivot take, --pivot")
    if pivot is not None and axis is not None:
        raise InputError("a pivot take tells the pen's axis, too; leave out --pen-axis")
    axis = _UPRIGHT if axis is None else axis
    if axis not in _AXES:
        raise InputError.of_choice("axis", axis, _AXES)
    if length is not None:
        away = metres(length, "--pen-length")
        if not 0 <= away <= _LONGEST_PEN:
            raise InputError.of_range("--pen-length", length, "at most 2 m")
        said = f"the tip is {with_unit(length)} from the rigid body along {axis}"
        return away * np.array(_AXES[axis], dtype=np.float64), said
    assert pivot is not None
    from maulstick.recording.mocap.motive import read_motive  # these load pandas and scipy
    from maulstick.recording.mocap.pivot import calibrate_pivot

    found = calibrate_pivot(read_motive(pivot, pen, board))
    place = ", ".join(f"{1e3 * along:.1f}" for along in found.tip)
    return found.tip, (
        f"the tip is at ({place}) mm in the rigid body; in the pivot take it strayed by {found.residual * 1e3:.2f} mm "
        f"(RMS), without {counted(found.rejected, 'outlier')}"
    )


def _seconds(name: str, text: str) -> float:
    match = re.fullmatch(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(ms|s)\s*", text)
    if match is None:
        raise InputError(f"{name} is {text!r}; write a time and its unit, as in 20ms or 0.02s")
    return float(match[1]) * _SECONDS[match[2]]
