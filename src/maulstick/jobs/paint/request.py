"""Request to paint: what, how, and where to begin."""

from dataclasses import dataclass
from pathlib import Path

from maulstick.errors import InputError, option
from maulstick.jobs.paint.options import PaintOptions
from maulstick.robot.robot import Robot


@dataclass(frozen=True)
class PaintRequest:
    """A painting.json or an SVG, and how to paint it.

    from_stroke: the first one, counted from 1; those before count as painted.  resume: go on where the journal ends.
    restart: begin again on a new sheet; the journal of the earlier run is kept elsewhere.
    robot: a machine of one's own, instead of the one that the options name.
    from_pen: the first time that a pen is put in, counted from 1; as from_stroke.
    home: folder that may be moved before the painting is gone on with; None is the painting's own.
    asks_for_one_pen: whether the operator is asked for the pen of a painting in one paint, too, before it is begun.

    Raises InputError for two ways to say where to begin.
    """

    painting: Path
    options: PaintOptions
    from_stroke: int | None = None
    resume: bool = False
    restart: bool = False
    robot: Robot | None = None
    from_pen: int | None = None
    home: Path | None = None
    asks_for_one_pen: bool = False

    def __post_init__(self) -> None:
        if self.resume and (self.restart or (self.from_stroke, self.from_pen) != (None, None)):
            others = f"{option('restart')}, {option('from_stroke')} and {option('from_pen')}"
            raise InputError(f"{option('resume')} knows where to go on; leave out {others}")
        if self.from_stroke is not None and self.from_pen is not None:
            raise InputError(f"{option('from_stroke')} and {option('from_pen')} both say where to begin; leave out one")
