"""What the process of a run and the studio say to each other."""

from dataclasses import dataclass
from enum import Enum

PAINTING = "painting"
PLANNING = "planning the rest again"
"""What it is doing: a stroke, or after it has looked."""


class Command(Enum):
    """What it hears. LOOK: photograph the sheet after this stroke, and plan again."""

    STOP = "stop"
    PAUSE = "pause"
    GO_ON = "go on"
    LOOK = "look"


@dataclass(frozen=True)
class Done:
    """Heard once what was asked for, in the question of that number, is done."""

    question: int


@dataclass(frozen=True)
class Going:
    """Where painting is, a few times a second.

    doing: in a few words.  stroke: the one under the brush, or the last one, counted from 1 over all runs.
    strokes: of the painting, or None while it is planned again.  drawn, metres: of stroke in this run.
    left: seconds, without what people do.  paint, next_paint: by their index in the painting.
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
class Asking:
    """The `question`-th thing that a person has to do, after which they say that it is `Done`; None once they have."""

    question: int
    message: str | None


@dataclass(frozen=True)
class Photograph:
    """The sheet as it was just seen."""

    jpeg: bytes


@dataclass(frozen=True)
class Note:
    """Something odd that did not stop the machine."""

    sentence: str


@dataclass(frozen=True)
class Ended:
    """The last word of a machine that was to paint.

    why: None where it has painted all, "" where somebody stopped it, else what was wrong.
    lifted: whether the pen is, as far as is known.
    """

    why: str | None
    lifted: bool
