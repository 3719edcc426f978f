"""Tasks of the desk with hands: ink from drawings and from uploaded recordings, and styles from ink."""

import shutil
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Literal
from zipfile import ZipFile

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from maulstick.errors import InputError, MaulstickError, OutputError
from maulstick.painting.ink_picture import ink_picture
from maulstick.painting.picture import encode_png
from maulstick.storage.arrays import kind_of
from maulstick.storage.files import atomic_write
from maulstick.storage.records import write_record
from maulstick.strokes.ink import KIND, Ink, read_ink, write_ink
from maulstick.studio.workers.drawn_sheet import read_sheet, sheet_json
from maulstick.studio.workers.uploads import known_as

DRAWING, INK, CARD, PICTURE = "drawing.json", "hand.ink.npz", "hand.json", "hand.png"

_LONGER = 1024  # pixels of a picture's longer side
_LARGEST_INK = 256 * 2**20  # bytes, unpacked: so that the desk's memory suffices
_LONGEST_PEN = 2e3  # millimetres: beyond, another unit was meant


class HandCard(BaseModel):
    """Content of hand.json about a hand's ink.

    pressed: whether the pressure of the pen was recorded.  notes: sentences about what its file does not say.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    version: Literal[1] = 1
    strokes: Annotated[int, Field(ge=0)]
    pressed: bool
    notes: tuple[str, ...] = ()


def keep_drawing(hand: Path) -> None:
    """Write the ink, its picture and its card for the drawing in the folder of a hand."""
    from maulstick.recording.files.ink_files import read_ink_file  # loads parsers

    sheet = read_sheet(hand / DRAWING)
    ink = read_ink_file(hand / DRAWING)[0] if sheet.strokes else Ink.of([], sheet.size, DRAWING)
    _keep(ink, hand)


def take_in(file: Path, called: str, pen_millimetres: float | None, hand: Path) -> None:
    """Make the folder of a hand from an uploaded recording; see `Hands.take_in`.

    A drawing of a web page that fits the studio's sheet is kept as one, so that it can be drawn on.
    """
    notes: list[str] = []
    with known_as(file, called):
        ink = _read(file, Path(called).suffix.lower(), pen_millimetres, notes.append)
    sheet = None
    if Path(called).suffix.lower() == ".json":
        with suppress(InputError):  # its ink is used all the same
            sheet = read_sheet(file)
    if not len(ink):
        raise InputError(f"there are no strokes in {called}; choose another recording")
    try:
        hand.mkdir()
    except OSError as error:
        raise OutputError(f"cannot write {hand}: {error.strerror}; choose another folder") from error
    try:
        if sheet is not None:
            atomic_write(hand / DRAWING, sheet_json(sheet.size, sheet.strokes))
        _keep(ink, hand, [note.replace(file.name, called) for note in notes])
    except MaulstickError:
        shutil.rmtree(hand)
        raise


def learn(hand: Path, style: str, title: str) -> None:
    """Learn a style from a hand's ink and store it with the user's styles, with the hand's title.

    Raises InputError for too few strokes.
    """
    from maulstick.strokes.strokes import Strokes
    from maulstick.style.cards import FEWEST, STYLES, title_style
    from maulstick.style.exemplar import Exemplar  # these load torch
    from maulstick.style.hand import Hand
    from maulstick.style.store import load_hands, write_style

    if not (hand / INK).exists():  # the studio was killed before it could be made
        keep_drawing(hand)
    ink = read_ink(hand / INK)
    if len(ink) < FEWEST:
        there = "there is 1" if len(ink) == 1 else f"there are {len(ink) or 'none'}"
        raise InputError(f"draw at least {FEWEST} strokes; {there}")
    seen = Hand.of(Strokes.of(ink))
    write_style(Exemplar.fit(STYLES.check_name(style), seen, load_hands()), f"the hand {title}", STYLES.own())
    title_style(style, title)


def _read(file: Path, suffix: str, pen_millimetres: float | None, note: Callable[[str], None]) -> Ink:
    if kind_of(file) == KIND:
        with ZipFile(file) as arrays:
            if sum(entry.file_size for entry in arrays.infolist()) > _LARGEST_INK:
                raise InputError(f"{file} unpacks to more than {_LARGEST_INK >> 20} MiB; bring less of it")
        return read_ink(file)
    if suffix == ".csv":
        return _tracked(file, pen_millimetres)
    from maulstick.recording.files.ink_files import read_ink_file  # loads parsers

    return read_ink_file(file, note=note)[0]


def _tracked(file: Path, pen_millimetres: float | None) -> Ink:
    if pen_millimetres is None:
        raise InputError("a motion-capture recording needs the pen's length, from its markers to its tip; write it in")
    if not 0 <= pen_millimetres <= _LONGEST_PEN:
        raise InputError.of_range("the pen's length", f"{pen_millimetres:g} mm", f"from 0 to {_LONGEST_PEN:g} mm")
    from maulstick.recording.mocap.drawing import drawing_of  # these load pandas and scipy
    from maulstick.recording.mocap.motive import read_motive

    tip = np.array([0.0, -1e-3 * pen_millimetres, 0.0])  # y is up in Motive, and the pen stood upright
    return drawing_of(read_motive(file), tip, source=file.name).ink


def _keep(ink: Ink, hand: Path, notes: Sequence[str] = ()) -> None:
    write_ink(ink, hand / INK)
    atomic_write(hand / PICTURE, encode_png(ink_picture(ink, _LONGER)))
    pressed = bool(np.isfinite(ink.samples[:, 3]).any())
    write_record(HandCard(strokes=len(ink), pressed=pressed, notes=tuple(notes)), hand / CARD)
