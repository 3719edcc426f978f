"""What ``maulstick paint`` was asked about the machine, kept in the journal: whoever goes on need not say it again."""

from collections.abc import Mapping
from pathlib import Path

from pydantic import BaseModel, ConfigDict, JsonValue, ValidationError

from maulstick.errors import InputError, Remedy, machine, option, validation_fault

_TAG = 0.02  # metres
_SLOWEST, _FASTEST = 1e-4, 10.0  # metres a second


class PaintOptions(BaseModel):
    """The words that were said; lengths in metres. One that is not given was not said; None that is given says "none".

    replan: strokes between two photographs, 0 for none any more.  look: whether a person may ask for one at any time.
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

    def check(self) -> None:
        """Raise InputError for words that say nothing sensible by themselves."""
        if self.speed is not None and not _SLOWEST <= self.speed <= _FASTEST:
            raise InputError.of_range(option("speed"), f"{1e3 * self.speed:g}", "from 0.1 to 10000 mm/s")
        if self.replan is not None and self.replan < 0:
            raise InputError.of_range(option("replan"), self.replan, "at least 1 stroke, or 0 for never again")

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
        return before.model_copy(update={name: said for name, said in self if name in self.model_fields_set})

    def as_json(self) -> dict[str, JsonValue]:
        """Return the options as the journal keeps them; paths are absolute."""
        said = {**self.model_dump(exclude_none=True), "robot": self.machine}
        return {name: str(value.absolute()) if isinstance(value, Path) else value for name, value in said.items()}

    @property
    def machine(self) -> str:
        """Which machine; the simulated easel, unless another was named."""
        return self.robot or "sim"

    @property
    def simulated(self) -> bool:
        """Whether that is the simulated easel."""
        return self.machine.startswith("sim")

    @property
    def tag_side(self) -> float:
        """Of the tags' black squares, metres."""
        return _TAG if self.tag is None else self.tag


def _kind(robot: str) -> str:
    return robot.partition(":")[0]
