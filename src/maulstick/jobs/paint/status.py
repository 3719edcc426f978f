"""How far a painting is, as its journal says, for whoever has not begun it."""

from dataclasses import dataclass
from pathlib import Path

from maulstick.jobs.paint.options import PaintOptions
from maulstick.painting.painting import read_painting
from maulstick.robot.journal import Journal, journal_of


@dataclass(frozen=True)
class PaintStatus:
    """strokes, painted: how many there are, and on the sheet.  options: what was asked of the machine at last.

    unfinished: the stroke, by its id, that was under the brush when it ended.
    """

    strokes: int
    painted: int
    unfinished: int | None
    options: PaintOptions

    @property
    def is_over(self) -> bool:
        """Whether nothing is left to paint."""
        return self.painted == self.strokes


def status_of(painting: Path) -> PaintStatus | None:
    """How far the painting in that file is; None where it was not begun.

    Raises InputError where its journal, or what it was begun with, cannot be read.
    """
    path = journal_of(painting)
    if not path.exists() or path.stat().st_size == 0:
        return None
    journal = Journal.read(path)
    if journal.revision is None:
        return None
    strokes = read_painting(journal.painting()).strokes
    painted = sum(stroke.id in journal.painted for stroke in strokes)
    return PaintStatus(len(strokes), painted, journal.unfinished, PaintOptions().after(journal.options))
