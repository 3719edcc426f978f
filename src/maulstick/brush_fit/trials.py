"""Trials: strokes that a machine drew one at a time, with photographs before and after, in a folder.

The photograph after a stroke is the one before the next. Lengths are rounded to a micrometre.
"""

import io
import json
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self, final

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from maulstick.errors import InputError, OutputError, validation_fault
from maulstick.painting.brush import Name
from maulstick.painting.picture import read_picture
from maulstick.storage.arrays import Floats, Pixels
from maulstick.storage.files import atomic_write, read_whole

SCHEMA_VERSION: Final = 1
"""Version of the format of the list that is written, and the only one that is read."""

_LIST = "trials.json"  # name of the list in the folder
_LARGEST_LIST = 256 * 2**20  # bytes: some 250,000 strokes
_FARTHEST = 100.0  # metres, as the largest sheet; more is millimetres that were taken for metres
_COARSEST, _FINEST = 100.0, 1e6  # pixels per metre: one per centimetre, and one per micrometre


@dataclass(frozen=True)
class Trial:
    """One stroke and the paper before and after it.

    name: for people, counted from 1 ("stroke 12").
    path: (n, 3) as executed: x, y in metres from the photographs' upper left corner, and pressure in [0, 1].
    before, after: (H, W, 3) sRGB in [0, 1]; read-only, since two trials share a photograph. Where only the stroke's
    darkness is known they are (H, W, 1): before is all 0, and after is the darkness, 1 for full ink.
    """

    name: str
    path: Floats
    before: Pixels
    after: Pixels


def _in_the_folder(name: str) -> str:
    if not re.fullmatch(r"\w[\w .-]*\.png", name):
        raise ValueError("a photograph must be a PNG of the same folder, named without folders, as in 0012.png")
    return name


def _at_hand(metres: float) -> float:
    if abs(metres) > _FARTHEST:
        raise ValueError(f"it must be at most {_FARTHEST:g} metres, so divide millimetres by 1000")
    return metres


def _of_photographs(pixels_per_metre: float) -> float:
    if not _COARSEST <= pixels_per_metre <= _FINEST:
        raise ValueError(f"it must be from {_COARSEST:.0f} to {_FINEST:.0f} pixels per metre")
    return pixels_per_metre


_Photograph = Annotated[str, AfterValidator(_in_the_folder)]
_Metres = Annotated[float, AfterValidator(_at_hand)]
_Point = tuple[_Metres, _Metres, Annotated[float, Field(ge=0, le=1)]]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class _Stroke(_Part):
    """A line of the list; where there is no photograph before, the one after is a darkness image."""

    before: _Photograph | None = None
    after: _Photograph
    path: Annotated[tuple[_Point, ...], Field(min_length=1)]


def _each_once(strokes: tuple[_Stroke, ...]) -> tuple[_Stroke, ...]:
    first: dict[_Stroke, int] = {}
    for number, stroke in enumerate(strokes, start=1):
        if first.setdefault(stroke, number) != number:
            raise InputError(f"stroke {number} is stroke {first[stroke]} again, and would count twice; take one out")
    return strokes


class _List(_Part):
    """Contents of trials.json; paper: the photograph before the next stroke."""

    schema_version: Literal[1]
    medium: Name
    pixels_per_metre: Annotated[float, Field(gt=0), AfterValidator(_of_photographs)]
    depth: tuple[_Metres, _Metres]
    paper: _Photograph | None = None
    strokes: Annotated[tuple[_Stroke, ...], AfterValidator(_each_once)]


@final
class Trials:
    """Trials in a folder, each read when it is used; the photographs of at most one trial are kept in memory.

    A power cut loses at most the stroke that was being appended. One process at a time may append.
    """

    def __init__(self, folder: Path, content: _List) -> None:
        self.folder = folder
        self._content = content
        self._kept: dict[str, Pixels] = {}

    @classmethod
    def make(
        cls, folder: str | Path, *, medium: str, pixels_per_metre: float, depth: tuple[float, float] = (0.0, 0.0)
    ) -> Self:
        """Start trials in a new or empty folder.

        medium: what is drawn with, for people.  pixels_per_metre: of all photographs.
        depth: distance of the tip below first touch at pressure 0 and at pressure 1, metres, as in `Brush.depth`.
        Raises InputError for impossible numbers, OutputError where the folder is not empty or cannot be written.
        """
        folder = Path(folder)
        start, end = (round(metres, 6) for metres in depth)
        try:
            content = _List(
                schema_version=SCHEMA_VERSION,
                medium=medium,
                pixels_per_metre=pixels_per_metre,
                depth=(start, end),
                strokes=(),
            )
        except ValidationError as error:
            raise InputError(f"there can be no such trials: {validation_fault(error)}") from error
        try:
            folder.mkdir(parents=True, exist_ok=True)
            empty = not any(folder.iterdir())
        except (FileExistsError, NotADirectoryError):
            raise OutputError(f"{folder} is or lies in a file; choose another folder for the trials") from None
        except OSError as error:
            raise OutputError(f"cannot make the folder {folder}: {error.strerror}; choose another") from error
        if not empty:
            raise OutputError(f"the folder {folder} is not empty; choose another for the trials")
        trials = cls(folder, content)
        trials._write(content)
        return trials

    @classmethod
    def open(cls, folder: str | Path) -> Self:
        """Open the trials in an existing folder; photographs are read later.

        Raises InputError, naming the stroke that is at fault, where there is no valid list of trials.
        """
        folder = Path(folder)
        if folder.is_file():
            raise InputError(f"{folder} is a file; name the folder of the trials, the one with {_LIST} in it")
        path = folder / _LIST
        content = read_whole(path, "list of trials", _LARGEST_LIST)
        try:
            return cls(folder, _List.model_validate_json(content, strict=True))
        except ValidationError as error:
            raise InputError(f"{path} is not a list of trials: {_fault(error)}") from error

    @property
    def medium(self) -> str:
        """Name of what was drawn with, for people."""
        return self._content.medium

    @property
    def pixels_per_metre(self) -> float:
        """Resolution of all photographs."""
        return self._content.pixels_per_metre

    @property
    def depth(self) -> tuple[float, float]:
        """Distance of the tip below first touch at pressure 0 and at pressure 1, metres, as in `Brush.depth`."""
        return self._content.depth

    def __len__(self) -> int:
        return len(self._content.strokes)

    def __iter__(self) -> Iterator[Trial]:
        return (self[index] for index in range(len(self)))

    def __getitem__(self, index: int) -> Trial:
        """Read the trial at `index`, from 0; read in order, each photograph is decoded once.

        Raises InputError, naming the trial, where its photographs cannot be used; the other trials still can.
        """
        if not 0 <= index < len(self):
            raise IndexError(f"there is no trial {index}; there are {len(self)}, from 0")
        name, stroke = f"stroke {index + 1}", self._content.strokes[index]
        path = np.array(stroke.path, dtype=np.float64)
        try:
            if stroke.before is None:
                darkness = self._darkness(stroke.after)
                return Trial(name, path, np.zeros_like(darkness), darkness)
            self._kept = {png: self._photograph(png) for png in (stroke.before, stroke.after)}
            before, after = self._kept[stroke.before], self._kept[stroke.after]
            if before.shape != after.shape:
                sizes = f"{_size(before)} and {_size(after)} pixels"
                raise InputError(f"the photographs before and after have {sizes}; rectify both to one size")
        except InputError as error:
            raise InputError(f"{name}: {error}") from error
        return Trial(name, path, before, after)

    def begin(self, photograph: NDArray[np.floating[Any]]) -> None:
        """Store the photograph (H, W, 3), sRGB in [0, 1], of the paper before the next stroke.

        It is needed before the first stroke, and whenever the paper looks different from the last photograph: after a
        change of sheet or camera, or a failed `append`.
        Raises InputError for an array that is not a photograph, OutputError where it cannot be written.
        """
        png = _png(photograph, "a photograph", (3,))
        name = self._free_name(len(self))
        atomic_write(self.folder / name, png)
        self._write(self._content.model_copy(update={"paper": name}))

    def append(self, path: Floats, after: NDArray[np.floating[Any]]) -> None:
        """Add a stroke: its path (n, 3) as in `Trial`, and the photograph (H, W, 3), sRGB in [0, 1], taken after it.

        Raises InputError for an impossible path or photograph, or where there is no photograph of the paper before, and
        OutputError where they cannot be written; the trials then stay as they were.
        """
        if self._content.paper is None:
            raise InputError("there is no photograph of the paper before the stroke; begin with one")
        self._add(path, _png(after, "a photograph", (3,)), before=self._content.paper)

    def append_darkness(self, path: Floats, darkness: NDArray[np.floating[Any]]) -> None:
        """Add a stroke of which only the darkness (H, W) in [0, 1] is known, 1 for full ink.

        It does not show the paper, so a next stroke with photographs needs `begin`. Raises as `append` does.
        """
        self._add(path, _png(darkness, "a darkness image", ()), before=None)

    def _add(self, path: Floats, png: bytes, before: str | None) -> None:
        number = len(self) + 1
        name = self._free_name(number)
        points = (np.asarray(path, dtype=np.float64).round(6) + 0.0).tolist()  # never -0.0
        try:
            stroke = _Stroke(before=before, after=name, path=points)
        except ValidationError as error:
            raise InputError(f"stroke {number} cannot be kept: {validation_fault(error)}") from error
        atomic_write(self.folder / name, png)
        change = {"strokes": (*self._content.strokes, stroke), "paper": None if before is None else name}
        self._write(self._content.model_copy(update=change))

    def _write(self, content: _List) -> None:
        fields = content.model_dump(mode="json", exclude={"strokes"}, exclude_none=True)
        head = "".join(f"  {json.dumps(name)}: {json.dumps(value)},\n" for name, value in fields.items())
        strokes = ",".join(f"\n    {stroke.model_dump_json(exclude_none=True)}" for stroke in content.strokes)
        atomic_write(self.folder / _LIST, f'{{\n{head}  "strokes": [{strokes}\n  ]\n}}\n'.encode())
        self._content = content

    def _free_name(self, number: int) -> str:
        """Return a name that no file has, such as one left by a power cut, and no stroke, whose file may be lost."""
        listed = {
            self._content.paper,
            *(name for stroke in self._content.strokes for name in (stroke.before, stroke.after)),
        }
        names = (f"{i:04d}.png" for i in count(number))
        return next(name for name in names if name not in listed and not os.path.lexists(self.folder / name))

    def _photograph(self, name: str) -> Pixels:
        if name in self._kept:
            return self._kept[name]
        picture = read_picture(self._present(name))
        picture.flags.writeable = False
        return picture

    def _darkness(self, name: str) -> Pixels:
        picture = read_picture(path := self._present(name))
        with Image.open(path) as image:
            if image.mode != "L":
                raise InputError(f"the darkness image {name} is of mode {image.mode}; save it as 8-bit grey")
        return np.ascontiguousarray(picture[..., :1])

    def _present(self, name: str) -> Path:
        path = self.folder / name
        if not os.path.exists(path):
            raise InputError(f"the photograph {name} is missing; put it back into {self.folder}")
        return path


def _png(picture: NDArray[np.floating[Any]], what: str, channels: tuple[int, ...]) -> bytes:
    """Return a picture (H, W, *channels) in [0, 1] as an 8-bit PNG."""
    if picture.ndim < 2 or picture.shape[2:] != channels or picture.size == 0:
        allowed = "(H, W, 3)" if channels else "(H, W)"
        raise InputError(f"{what} has shape {picture.shape}; it must be {allowed}, with pixels in it")
    if not np.issubdtype(picture.dtype, np.floating):
        raise InputError(f"{what} is made of {picture.dtype}; it must be made of floats in [0, 1], so divide it by 255")
    low, high = picture.min(), picture.max()
    if not (low >= 0 and high <= 1):
        raise InputError.of_range(what, f"from {low:g} to {high:g}", "in [0, 1]")
    file = io.BytesIO()
    Image.fromarray((255 * picture).round().astype(np.uint8)).save(file, "PNG")
    return file.getvalue()


def _size(picture: Pixels) -> str:
    return f"{picture.shape[1]} x {picture.shape[0]}"


def _fault(error: ValidationError) -> str:
    """Return the first fault, with a stroke's name; a wrong schema comes first, because other faults follow from it."""
    for fault in error.errors(include_url=False):
        if fault["loc"] == ("schema_version",) and isinstance(came := fault["input"], int):
            remedy = "update Maulstick" if came > SCHEMA_VERSION else "collect the trials again"
            return f"schema_version: it is {came}, and this Maulstick reads version {SCHEMA_VERSION}; {remedy}"
    return re.sub(r"^strokes\[(\d+)\](\.|: )", lambda match: f"stroke {int(match[1]) + 1}: ", validation_fault(error))
