"""Files of a recording: its ink or its strokes, by the ending of the name, and a plot for a tracked pen."""

from pathlib import Path
from typing import TYPE_CHECKING

from maulstick.cli.folder import check_absent
from maulstick.errors import InputError
from maulstick.storage.files import atomic_write
from maulstick.strokes.ink import Ink, write_ink
from maulstick.strokes.strokes import Strokes, write_strokes

if TYPE_CHECKING:
    from maulstick.recording.mocap.drawing import TakeInk

_INK, _STROKES = ".ink.npz", ".strokes.npz"


def check_out(out: Path, overwrite: bool) -> None:
    """Raise InputError for a name with another ending, and OutputError where the file at `out` would be lost."""
    if not out.name.endswith((_INK, _STROKES)):
        raise InputError(f"--out is {out}; let its name end in {_INK} for the ink, or in {_STROKES} for its strokes")
    check_absent(out, "--out", overwrite)


def check_outs(out: Path, plot: Path | None, overwrite: bool) -> Path:
    """Return the path of the plot. Raises as `check_out` for it and for `out`."""
    check_out(out, overwrite)
    plot = plot or beside(out, ".contact.png")
    if plot.suffix.lower() != ".png":
        raise InputError(f"--plot is {plot}; it is written as PNG, so let its name end in .png")
    check_absent(plot, "--plot", overwrite)
    return plot


def beside(out: Path, ending: str) -> Path:
    """Return the path beside `out`, NAME.ink.npz or NAME.strokes.npz, that is NAME with another ending."""
    return out.with_name(out.name.rsplit(".", 2)[0] + ending)


def write_result(ink: Ink, out: Path, overwrite: bool) -> None:
    """Write the ink, or its standardised strokes where the name ends in .strokes.npz.

    Raises as `check_out` does, and OutputError where writing fails.
    """
    check_out(out, overwrite)
    if out.name.endswith(_STROKES):
        write_strokes(Strokes.of(ink), out)
    else:
        write_ink(ink, out)


def write_drawing(drawing: "TakeInk", out: Path, plot: Path, overwrite: bool) -> None:
    """Write the ink and the plot, and print what was decided and their paths.

    Raises OutputError where they cannot be written.
    """
    from maulstick.plots.contact import contact_plot  # loads matplotlib

    write_result(drawing.ink, out, overwrite)
    atomic_write(plot, contact_plot(drawing))
    print(*drawing.summary, out, plot, sep="\n", flush=True)
