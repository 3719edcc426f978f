"""The catalogue of pens: each has a constant width, as its maker states it, a colour and a kind."""

from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from maulstick.errors import InputError
from maulstick.storage.library import Library
from maulstick.storage.records import read_record
from maulstick.storage.text import is_printable

PENS: Final = Library("pen", "pens", Path(__file__).with_name("built_in_pens"))
"""Library of the pens that come with Maulstick and of the user's own."""


def _printable(text: str) -> str:
    if not is_printable(text):
        raise ValueError("a name must be made of printable characters")
    return text


Printable = Annotated[str, AfterValidator(_printable)]
"""Text of printable characters, which may be empty."""

PrintableName = Annotated[str, Field(min_length=1), AfterValidator(_printable)]
"""Name of one printable character or more."""


_THINNEST = 1e-5  # metres: a tenth of the thinnest line that a pen is made for


def _seen(width: float) -> float:
    if width < _THINNEST:
        raise ValueError(f"it must be at least {_THINNEST:f} metres")
    return width


class PenModel(BaseModel):
    """A model of pen.

    width: of its line, metres, as the maker states it.  colour: of its ink, ``#rrggbb``.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    schema_version: Literal[1] = 1
    maker: PrintableName
    model: PrintableName
    kind: PrintableName
    width: Annotated[float, Field(gt=0, le=0.1, allow_inf_nan=False), AfterValidator(_seen)]
    colour: Annotated[str, Field(pattern=r"^#[0-9a-fA-F]{6}$")] = "#000000"

    @property
    def label(self) -> str:
        """Maker and model, for people."""
        return f"{self.maker} {self.model}"


def load_pen(name: str) -> PenModel:
    """Return a pen of the catalogue by its name. Raises InputError where there is none, or its file is not one."""
    paths = PENS.paths()
    if name not in paths:
        raise InputError.of_choice("pen", name, paths)
    return read_record(PenModel, paths[name], "pen")
