"""Styles as files: NAME.safetensors, the arrays, and NAME.json beside it, what they are. Nothing is ever unpickled."""

import hashlib
import re
from pathlib import Path
from typing import Annotated, Final, Literal

import numpy as np
from numpy.typing import NDArray
from platformdirs import user_data_path
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from safetensors import SafetensorError
from safetensors.numpy import load, save

from maulstick.errors import InputError
from maulstick.files import atomic_write, file_to_read
from maulstick.medium import first_fault
from maulstick.style.exemplar import Exemplar, Hands
from maulstick.style.hand import Hand

VERSION: Final = 1
_LARGEST_FILE = 256 * 2**20
_NAME = re.compile(r"[a-z0-9][a-z0-9-]{0,39}")
_HAND, _HANDS = ("paths", "press", "speeds"), ("covariance", "residual")

Arrays = dict[str, NDArray[np.generic]]


class StyleCard(BaseModel):
    """What the JSON beside a style's arrays says.

    source: what the style was learned from, for people.  sha256: of the file of arrays.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    version: Literal[1] = VERSION
    kind: Literal["exemplar"]
    name: str
    source: str
    strokes: Annotated[int, Field(ge=1)]
    freedom: Annotated[float, Field(ge=0, le=1)]
    sha256: str


def own_styles() -> Path:
    """The folder that the user's styles are kept in."""
    return user_data_path("maulstick", appauthor=False) / "styles"


def check_name(name: str) -> str:
    """The name itself. Raises InputError where a style may not be called so: a name must never be a path."""
    if not _NAME.fullmatch(name) or name == "free":
        allowed = "up to 40 of a-z, 0-9 and -, beginning with a letter or a digit, and not free"
        raise InputError.of_range("the name of a style", repr(name), allowed)
    return name


def write_style(style: Exemplar, source: str, folder: Path) -> Path:
    """Write a style into a folder; the path of its JSON. Raises OutputError where that fails."""
    name = check_name(style.name)
    small = {field: getattr(style.hand, field).astype(np.float32) for field in _HAND}
    content = save({**small, **{field: getattr(style.hands, field) for field in _HANDS}})
    digest = hashlib.sha256(content).hexdigest()
    card = StyleCard(
        kind="exemplar", name=name, source=source, strokes=len(style.hand), freedom=style.freedom, sha256=digest
    )
    atomic_write(folder / f"{name}.safetensors", content)
    atomic_write(folder / f"{name}.json", (card.model_dump_json(indent=2) + "\n").encode())
    return folder / f"{name}.json"


def read_card(path: Path) -> StyleCard:
    """What a style's JSON says. Raises InputError where it is not one."""
    try:
        return StyleCard.model_validate_json(file_to_read(path, "style").read_bytes())
    except ValidationError as error:
        raise InputError(f"{path} is not a style: {first_fault(error)}") from error


def read_style(path: Path) -> Exemplar:
    """The style whose JSON is at `path`. Raises InputError where it, or the arrays beside it, cannot be used."""
    card = read_card(path)
    beside = file_to_read(path.with_suffix(".safetensors"), "style")
    if beside.stat().st_size > _LARGEST_FILE:
        raise InputError(f"{beside} is larger than {_LARGEST_FILE >> 20} MiB; no style is")
    content = beside.read_bytes()
    if hashlib.sha256(content).hexdigest() != card.sha256:
        raise InputError(f"{beside} does not belong to {path}, or it is damaged; copy both files again")
    try:
        arrays = {name: array.astype(np.float64) for name, array in load(content).items()}
        hand, hands = Hand(*(arrays[name] for name in _HAND)), Hands(*(arrays[name] for name in _HANDS))
    except (SafetensorError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"{beside} does not hold a style: {error}") from error
    return Exemplar(card.name, hand, hands, card.freedom)
