"""Status of a painting: how far it is, as its journal says."""

from dataclasses import dataclass
from pathlib import Path

from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paintable import is_svg, read_paintable
from maulstick.robot.journal import Journal, journal_of, latest_sheet


@dataclass(frozen=True)
class PaintStatus:
    """Status of a painting that was begun.

    strokes, painted: how many there are, and on the sheet.  unfinished: id of the stroke that was being painted when
    the last run ended, or None.  options: those of the last run.  sheet: number of the latest sheet, from 1.
    """

    strokes: int
    painted: int
    unfinished: int | None
    options: PaintOptions
    sheet: int = 1

    @property
    def is_over(self) -> bool:
        """Whether nothing is left to paint, on any sheet."""
        return self.painted == self.strokes and self.sheet >= self.options.sheets


def status_of(painting: Path) -> PaintStatus | None:
    """Return the status of the painting in that file; None where it was not begun.

    Raises InputError where its journal, or what it was begun with, cannot be read.
    """
    path = journal_of(painting)
    if not path.exists() or path.stat().st_size == 0:
        return None
    journal = Journal.read(journal_of(painting, sheet := latest_sheet(painting)))
    if journal.revision is None:
        return None
    file, options = journal.painting(), PaintOptions().after(journal.options, path.parent)
    strokes = read_paintable(file, options.drawing if is_svg(file) else None).painting.strokes
    painted = sum(stroke.id in journal.painted for stroke in strokes)
    return PaintStatus(len(strokes), painted, journal.unfinished, options, sheet)
