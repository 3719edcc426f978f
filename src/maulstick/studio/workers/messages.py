"""Messages between the studio and the process of a run."""

from dataclasses import dataclass
from enum import Enum

PAINTING = "painting"
PLANNING = "planning the rest again"
"""Values of `RunProgress.doing` while a stroke is painted, and while the rest is planned again after a look."""


class Command(Enum):
    """Command to the process. LOOK: photograph the sheet after this stroke, and plan the rest again."""

    STOP = "stop"
    PAUSE = "pause"
    GO_ON = "go on"
    LOOK = "look"


@dataclass(frozen=True)
class Done:
    """Message to the process that a person has done what it asked for. question: number of the `OperatorRequest`."""

    question: int


@dataclass(frozen=True)
class RunProgress:
    """Progress of a run, sent a few times per second.

    doing: current action, in a few words.  stroke: number of the current or the last stroke, from 1, over all runs.
    strokes: number in the painting, None while it is planned again.  drawn, metres: length of stroke drawn so far,
    and of all, in this run.  left: seconds, without what people do.  paint, next_paint: indices in the painting.
    """

    doing: str
    stroke: int
    strokes: int | None
    drawn: float
    metres: float
    left: float
    paint: int | None
    next_paint: int | None


@dataclass(frozen=True)
class OperatorRequest:
    """Request to a person, answered by `Done`. number: from 1.  message: None once it is done."""

    number: int
    message: str | None


@dataclass(frozen=True)
class Photograph:
    """Newest picture of the sheet, as a JPEG."""

    jpeg: bytes


@dataclass(frozen=True)
class Note:
    """Warning about something that did not stop the machine."""

    sentence: str


@dataclass(frozen=True)
class Held:
    """Message that the machine's own button was pressed. held: whether the machine waits since then."""

    held: bool


@dataclass(frozen=True)
class Ended:
    """Last message of a run.

    why: None where all is painted, "" where somebody stopped it, else what went wrong.
    lifted: whether the pen is lifted, as far as is known.
    """

    why: str | None
    lifted: bool
