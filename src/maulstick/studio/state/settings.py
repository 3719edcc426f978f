"""Settings of the studio: what was chosen last in the form of a plan, with which all pages begin from then on."""

import asyncio
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Final, Literal, final

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from maulstick.errors import InputError, OutputError
from maulstick.jobs.plan.options import DRAWINGS, MOST_INKS, MOST_STROKES, PlanOptions
from maulstick.jobs.plan.request import MOST_TRIES
from maulstick.storage.records import read_record, write_record
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.placing import AS_SUITS

WHITE: Final = "#ffffff"
"""Colour of paper, as a field for colours shows it."""

_PAUSE = 0.5  # seconds between two writings: a person who types a number changes it with every key
_USUAL = PlanOptions()

_Text = Annotated[str, Field(max_length=100)]
_Names = Annotated[str, Field(max_length=800)]
_Weight = Annotated[float, Field(ge=0, le=10)]


class Choices(BaseModel):
    """Choices for a plan, without what it is of; the fields are those of the form, with what is usual.

    machine: kind of the machine that will paint, "" for none yet.  brush: one, or several by commas.
    own_size: where `size` names none.
    turned, fit, margin: of the sheet, millimetres.  kind: whether it paints in paints or draws in ink.
    enough: whether there are as many strokes as the picture needs.  effort: steps of the optimiser.
    unmixed: whether only the paints of the studio's tubes are used.  tries: number of plans, the best of which is kept.
    """

    model_config = ConfigDict(frozen=True, extra="ignore")

    schema_version: Literal[1] = 1
    machine: _Text = ""
    style: _Text = "loops"
    hand_size: Annotated[float, Field(gt=0, le=50)] = _USUAL.hand_size
    brush: _Names = _USUAL.brush
    size: _Text = _USUAL.size
    own_size: _Text = "170 by 230 mm"
    turned: _Text = AS_SUITS
    fit: _Text = AS_SUITS
    margin: Annotated[float, Field(ge=0, le=1000)] = 0
    kind: Literal["paints", "ink"] = "paints"
    paints: Annotated[int, Field(ge=1, le=64)] = _USUAL.mixed_paints or 1
    ink: _Text = "#000000"
    more_inks: Annotated[list[_Text], Field(max_length=MOST_INKS - 1)] = []
    strokes: Annotated[int, Field(ge=1, le=MOST_STROKES)] = int(_USUAL.strokes)
    enough: bool = False
    drawing: _Text = DRAWINGS[0]
    weights: dict[_Text, _Weight] = {"tone": 1.0}
    arrange: Annotated[float, Field(ge=0, le=1)] = _USUAL.arrange
    effort: Annotated[int, Field(ge=1)] = _USUAL.steps
    paper: _Text = WHITE
    unmixed: bool = False
    tries: Annotated[int, Field(ge=1, le=MOST_TRIES)] = 1


@final
class Settings:
    """Settings in the studio's folder. choices: those of the last plan, the usual ones where there are none.

    A file that is broken, or of another version, counts as none.
    """

    def __init__(self, folder: Folder) -> None:
        self._path = folder.root / "settings.json"
        self._later: asyncio.TimerHandle | None = None
        self.choices = _read(self._path)

    def keep(self, values: Mapping[str, object]) -> None:
        """Keep what was chosen, by the names of `Choices`; what is out of its range stays as it was before."""
        wrong = _wrong(values)
        kept = {name: value for name, value in values.items() if name not in wrong}
        choices = Choices.model_validate({**self.choices.model_dump(), **kept})
        if choices != self.choices:
            self.choices = choices
            if self._later is None:
                self._later = asyncio.get_running_loop().call_later(_PAUSE, self.write)

    def write(self) -> None:
        """Write what is not written yet; a disk that is full loses nothing but this."""
        if self._later is None:
            return
        self._later.cancel()
        self._later = None
        with suppress(OutputError):
            write_record(self.choices, self._path)


def _read(path: Path) -> Choices:
    with suppress(InputError):
        return read_record(Choices, path, "list of settings")
    return Choices()


def _wrong(values: Mapping[str, object]) -> set[object]:
    """Return the names of the values that are out of their range."""
    try:
        Choices.model_validate({**values})
    except ValidationError as error:
        return {fault["loc"][0] for fault in error.errors()}
    return set()
