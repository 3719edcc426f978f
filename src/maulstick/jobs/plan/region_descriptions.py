"""What a TOML file says of the regions of a map, and which names are no region's."""

import re
import sys
import tomllib
from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, TypeAdapter, ValidationError

from maulstick.errors import InputError, validation_fault
from maulstick.jobs.plan.options import LARGEST_HAND, LEAST_HAND
from maulstick.painting.brush import Name
from maulstick.storage.files import read_whole
from maulstick.storage.library import all_placed, placed

REST: Final = "rest"
"""Name of what no region of a map covers."""

ALONG_GUIDES: Final = "guides"
"""Direction of strokes that follow the guides."""

_LARGEST = 2**20  # bytes of the file: thousands of regions
_MOST = 64  # regions: more than a person tells apart by their colours
_OF_STROKES = re.compile(r"all|\d+(-\d+)?")


def _direction(said: object) -> object:
    if said is None or said == ALONG_GUIDES:
        return said
    if isinstance(said, bool) or not isinstance(said, int | float) or not abs(said) <= sys.float_info.max:
        raise ValueError(f'it must be degrees clockwise from the right, or "{ALONG_GUIDES}"')
    return float(said)


Direction = Annotated[float | Literal["guides"] | None, BeforeValidator(_direction)]
"""Direction of strokes: degrees clockwise from the right, along the guides, or None for any."""


class RegionDescription(BaseModel):
    """What the file says of a region; lengths of time and place as in the options of planning."""

    model_config = ConfigDict(extra="forbid", strict=True)

    colour: str | None = None
    style: str | None = None
    hand_size: Annotated[float, Field(ge=LEAST_HAND, le=LARGEST_HAND)] | None = None
    brush: str | None = None
    share: Annotated[float, Field(gt=0, lt=1)] | None = None
    importance: Annotated[float, Field(ge=0, le=1000)] = 1.0
    weights: dict[Literal["tone", "edges"], Annotated[float, Field(ge=0, le=1000)]] = Field(default_factory=dict)
    colours: Annotated[list[str], Field(min_length=1)] | None = None
    direction: Direction = None
    soft: str | None = None
    bare: bool = False


_FILE: TypeAdapter[dict[Name, RegionDescription]] = TypeAdapter(dict[Name, RegionDescription])


def read_descriptions(path: Path) -> dict[str, RegionDescription]:
    """Read what a file says of each region, by its name. Files of styles and brushes lie relative to this one.

    Raises InputError where it is not TOML, or says anything else.
    """
    try:
        said = _FILE.validate_python(tomllib.loads(read_whole(path, "description of regions", _LARGEST).decode()))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path} is not TOML: {error}; see docs/planning.md for an example") from error
    except ValidationError as error:
        raise InputError(f"{path}: {validation_fault(error)}") from error
    if not 1 <= len(said) <= _MOST:
        raise InputError.of_range("the number of regions", len(said), f"from 1 to {_MOST}")
    for one in said.values():
        one.style = one.style and placed(one.style, path.parent)
        one.brush = one.brush and all_placed(one.brush, path.parent)
    return said


def names_strokes(name: str) -> bool:
    """Return whether a name is one by which strokes are named where a region's name may stand."""
    return _OF_STROKES.fullmatch(name) is not None
