"""Options of ``maulstick paint`` about the machine, kept in the journal, so that resuming needs none of them."""

from collections.abc import Mapping
from pathlib import Path

from pydantic import BaseModel, ConfigDict, JsonValue, ValidationError

from maulstick.drawing.options import DrawingOptions
from maulstick.errors import InputError, Remedy, machine, option, validation_fault

_TAG = 0.02  # side of a tag's black square in metres, as `maulstick calibrate tags` prints them
_SLOWEST, _FASTEST = 1e-4, 10.0  # metres per second: beyond, the unit is probably wrong


class PaintOptions(BaseModel):
    """Options as they were given; lengths in metres. One not given is not set; a None that is set means "none".

    replan: strokes between two photographs, 0 for none any more.  look: whether the operator may ask for one any time.
    drawing: how an SVG is read; None where that was not said, or it is none.
    strokes_sha256: of the strokes that an SVG was read as: nobody gives it, and resuming compares it.
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

    def check(self) -> None:
        """Raise InputError for an option that is out of its range."""
        if self.speed is not None and not _SLOWEST <= self.speed <= _FASTEST:
            raise InputError.of_range(option("speed"), f"{1e3 * self.speed:g}", "from 0.1 to 10000 mm/s")
        if self.replan is not None and self.replan < 0:
            raise InputError.of_range(option("replan"), self.replan, "at least 1 stroke, or 0 for never again")
        if self.drawing is not None:
            self.drawing.check()

    def after(self, recorded: Mapping[str, JsonValue]) -> "PaintOptions":
        """Return these options, and where one is not given, the recorded one. Raises InputError for another machine."""
        try:
            before = PaintOptions.model_validate(recorded)
        except ValidationError as error:
            raise InputError(f"the journal's options are damaged: {validation_fault(error)}", Remedy.RESTART) from error
        if self.robot is not None and before.robot is not None and _kind(self.robot) != _kind(before.robot):
            raise InputError(
                f"this painting was begun on {machine(before.robot)}, and what is left belongs on the same sheet",
                Remedy.SAME_MACHINE_OR_RESTART,
            )
        if self.drawing is not None and self.drawing != before.drawing:
            raise InputError(
                "this drawing was begun with other options, and would have other strokes",
                Remedy.SAME_DRAWING_OR_RESTART,
            )
        return before.model_copy(update={name: value for name, value in self if name in self.model_fields_set})

    def as_json(self) -> dict[str, JsonValue]:
        """Return the options as the journal keeps them; paths are absolute."""
        given = {**self.model_dump(exclude_none=True), "robot": self.machine}
        if self.drawing is not None:
            given["drawing"] = self.drawing.model_dump(mode="json", exclude_defaults=True)
        return {name: str(value.absolute()) if isinstance(value, Path) else value for name, value in given.items()}

    @property
    def machine(self) -> str:
        """Spec of the machine; the simulated easel, unless another was named."""
        return self.robot or "sim"

    @property
    def simulated(self) -> bool:
        """Whether the machine is the simulated easel."""
        return self.machine.startswith("sim")

    @property
    def tag_side(self) -> float:
        """Side of the tags' black squares, metres."""
        return _TAG if self.tag is None else self.tag


def _kind(robot: str) -> str:
    return robot.partition(":")[0]
