"""Options of ``maulstick paint`` about the machine, kept in the journal, so that resuming needs none of them."""

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from pydantic import BaseModel, ConfigDict, JsonValue, ValidationError

from maulstick.drawing.options import DrawingOptions
from maulstick.errors import InputError, Remedy, machine, option, validation_fault
from maulstick.robot.machines import is_simulated, kind_of

_TAG = 0.02  # side of a tag's black square in metres, as `maulstick calibrate tags` prints them
_REFILL = r"(\d+(?:\.\d+)?) ?(m|min)"  # after metres or minutes
MOST_COPIES: Final = 1000
"""Largest number of copies: more is a slip of the hand."""

_SLOWEST, _FASTEST = 1e-4, 10.0  # metres per second: beyond, the unit is probably wrong


class PaintOptions(BaseModel):
    """Options as they were given; lengths in metres. One not given is not set; a None that is set means "none".

    replan: strokes between two photographs, 0 for none any more.  look: whether the operator may ask for one any time.
    drawing: how an SVG is read; None where that was not said, or it is none.
    strokes_sha256: of the strokes that an SVG was read as: nobody gives it, and resuming compares it.
    pen: name of the pen that draws, whatever the painting was planned for.
    pause_at: numbers of strokes, counted from 1, before which the machine waits.
    refill_after: ``20m`` or ``5min`` of drawing, after which a pen is refilled or cleaned.
    refill_at: x and y on the canvas where the pen is then.  copies: number of sheets.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    robot: str | None = None
    easel: Path | None = None
    tray: Path | None = None
    speed: float | None = None
    replan: int | None = None
    look: bool | None = None
    camera: str | None = None
    picture: Path | None = None
    view: Path | None = None
    tag: float | None = None
    colours: Path | None = None
    drawing: DrawingOptions | None = None
    strokes_sha256: str | None = None
    pen: str | None = None
    pause_at: tuple[int, ...] | None = None
    refill_after: str | None = None
    refill_at: tuple[float, float] | None = None
    copies: int | None = None

    def check(self) -> None:
        """Raise InputError for an option that is out of its range."""
        if self.speed is not None and not _SLOWEST <= self.speed <= _FASTEST:
            raise InputError.of_range(option("speed"), f"{1e3 * self.speed:g}", "from 0.1 to 10000 mm/s")
        if self.replan is not None and self.replan < 0:
            raise InputError.of_range(option("replan"), self.replan, "at least 1 stroke, or 0 for never again")
        if self.drawing is not None:
            self.drawing.check()
        if self.refill_after is not None and min(self.refill_metres, self.refill_seconds) in (0.0, float("inf")):
            allowed = "metres or minutes of drawing above 0, as in 20m or 5min"
            raise InputError.of_range(option("refill_after"), repr(self.refill_after), allowed)
        if self.refill_at is not None and not np.isfinite(self.refill_at).all():
            raise InputError.of_range(option("refill_at"), self.refill_at, "two lengths on the canvas")
        if self.copies is not None and not 1 <= self.copies <= MOST_COPIES:
            raise InputError.of_range(option("copies"), self.copies, f"1 to {MOST_COPIES}")

    def check_together(self) -> None:
        """Raise InputError for options that do not go together, once those of an earlier run are among them."""
        planned_again = bool(self.replan or self.look)
        if self.refill_at is not None and self.refill_after is None:
            raise InputError(f"{option('refill_at')} is where a pen is refilled; add {option('refill_after')}")
        if self.refill_after is not None and self.tray is not None:
            raise InputError(f"a tray refills its brush by itself; leave out {option('refill_after')}")
        if self.pause_at and planned_again:
            raise InputError(f"strokes get other numbers when they are planned again; leave out {option('pause_at')}")
        if self.sheets > 1 and planned_again:
            raise InputError(f"what a camera sees belongs to one sheet; leave out {option('copies')}")
        if self.sheets > 1 and self.simulated:
            raise InputError(f"the simulated easel has one sheet; leave out {option('copies')}")

    def after(self, recorded: Mapping[str, JsonValue], beside: Path) -> "PaintOptions":
        """Return these options, and where one is not given, that of the journal in the folder `beside`.

        Raises InputError for another machine.
        """
        try:
            before = _placed(PaintOptions.model_validate(recorded), beside)
        except ValidationError as error:
            raise InputError(f"the journal's options are damaged: {validation_fault(error)}", Remedy.RESTART) from error
        if self.robot is not None and before.robot is not None and kind_of(self.robot) != kind_of(before.robot):
            raise InputError(
                f"this painting was begun on {machine(before.robot)}, and what is left belongs on the same sheet",
                Remedy.SAME_MACHINE_OR_RESTART,
            )
        if self.drawing is not None and self.drawing != (before.drawing or DrawingOptions()):
            raise InputError(
                "this drawing was begun with other options, and would have other strokes",
                Remedy.SAME_DRAWING_OR_RESTART,
            )
        return before.model_copy(update={name: value for name, value in self if name in self.model_fields_set})

    def as_json(self, beside: Path, home: Path) -> dict[str, JsonValue]:
        """Return the options as the journal in the folder `beside` keeps them.

        home: folder that may be moved with all that is in it, the journal too; paths in it are relative to the folder
        of the journal, and all others absolute.
        """
        given = {**self.model_dump(exclude_none=True), "robot": self.machine}
        given = {name: _as_json(value, beside, home) for name, value in given.items()}
        if self.drawing is not None:
            given["drawing"] = self.drawing.model_dump(mode="json", exclude_defaults=True)
        return given

    @property
    def machine(self) -> str:
        """Spec of the machine; the simulated easel, unless another was named."""
        return "sim" if self.robot is None else self.robot

    @property
    def sheets(self) -> int:
        """Number of sheets to paint."""
        return 1 if self.copies is None else self.copies

    @property
    def refill_metres(self) -> float:
        """Metres of drawing until a pen is refilled, infinity where none are given."""
        return self._refill("m", 1.0)

    @property
    def refill_seconds(self) -> float:
        """Seconds of drawing until a pen is refilled, infinity where none are given."""
        return self._refill("min", 60.0)

    @property
    def simulated(self) -> bool:
        """Whether the machine is the simulated easel."""
        return is_simulated(self.machine)

    @property
    def tag_side(self) -> float:
        """Side of the tags' black squares, metres."""
        return _TAG if self.tag is None else self.tag

    def _refill(self, unit: str, worth: float) -> float:
        found = re.fullmatch(_REFILL, self.refill_after or "")
        return float("inf") if found is None or found[2] != unit else worth * float(found[1])


def _as_json(value: Any, beside: Path, home: Path) -> JsonValue:
    if isinstance(value, Path):
        moves = value.absolute().is_relative_to(home.absolute())
        return os.path.relpath(value, beside) if moves else str(value.absolute())
    return list(value) if isinstance(value, tuple) else value


def _placed(options: PaintOptions, beside: Path) -> PaintOptions:
    """Return the options with absolute paths, where relative ones begin in the folder `beside`."""
    found = {name: value for name, value in options if isinstance(value, Path)}
    return options.model_copy(update={name: Path(os.path.abspath(beside / path)) for name, path in found.items()})
