"""What a recording becomes: one file, whose name says what is in it."""

import os
from pathlib import Path

from maulstick.errors import InputError, OutputError
from maulstick.ink import Ink, write_ink
from maulstick.strokes import Strokes, write_strokes

_INK, _STROKES = ".ink.npz", ".strokes.npz"


def check_out(out: Path, overwrite: bool) -> None:
    """Raise InputError where nothing can be written under that name, and OutputError where `out` would be lost."""
    if not out.name.endswith((_INK, _STROKES)):
        raise InputError(f"--out is {out}; let its name end in {_INK} for the ink, or in {_STROKES} for its strokes")
    if os.path.lexists(out) and not overwrite:
        raise OutputError(f"{out} is already there; choose another --out, or add --overwrite")


def write_result(ink: Ink, out: Path, overwrite: bool) -> None:
    """Write the ink, or its standardised strokes where the name ends in .strokes.npz.

    Raises as `check_out` does, and OutputError where writing fails.
    """
    check_out(out, overwrite)
    if out.name.endswith(_STROKES):
        write_strokes(Strokes.of(ink), out)
    else:
        write_ink(ink, out)
