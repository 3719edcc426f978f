"""Table and contact sheet of a sweep: one row, and one small painting, per cell."""

import csv
import io
import json
from collections.abc import Sequence
from math import ceil, sqrt
from pathlib import Path

from maulstick.errors import InputError
from maulstick.jobs.sweep.cell import read_cell
from maulstick.jobs.sweep.grid import SHEET, TABLE
from maulstick.jobs.sweep.sweep import Standing
from maulstick.painting.painting_file import read_painting
from maulstick.plots.cells import Print, contact_sheet
from maulstick.storage.files import atomic_write

_WIDEST = 12  # paintings beside each other, at most: those of an axis with more values would be too small to compare
_LAST = ("seconds", "notes", "fault")  # columns behind those of the metrics, of which each cell has its own

Row = dict[str, object]


def rows_of(standings: Sequence[Standing]) -> list[Row]:
    """Return a row per cell: its axes, and, where it is finished, the numbers of its painting.

    Values of axes are as the grid has them; lists and tables are JSON.  A term of the loss that has the name of an
    axis, as text and look have, is called as in look_loss.
    """
    return [_row(each) for each in standings]


def columns_of(rows: Sequence[Row]) -> list[str]:
    """Return the names of all columns, in an order that does not depend on which cells failed."""
    names = dict.fromkeys(name for row in rows for name in row)
    return [*(name for name in names if name not in _LAST), *(name for name in _LAST if name in names)]


def write_table(standings: Sequence[Standing], rows: Sequence[Row], columns: int, out: Path) -> list[str]:
    """Write the table and the contact sheet into the folder `out`, and return their names.

    columns: cells that belong beside each other.
    Raises OutputError where they cannot be written, and InputError for a preview that is damaged.
    """
    text = io.StringIO()
    writer = csv.DictWriter(text, columns_of(rows), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    atomic_write(out / TABLE, text.getvalue().encode())
    beside = columns if 1 < columns <= _WIDEST else min(_WIDEST, ceil(sqrt(len(rows))))
    varied = [name for name in standings[0].cell.values if len({str(row[name]) for row in rows}) > 1]
    prints = [_print(each, row, varied) for each, row in zip(standings, rows, strict=True)]
    atomic_write(out / SHEET, contact_sheet(prints, beside))
    return [TABLE, SHEET]


def _row(each: Standing) -> Row:
    given = each.cell.values
    values = {
        name: value if isinstance(value, str | float | int) else json.dumps(value) for name, value in given.items()
    }
    row: Row = {"cell": each.cell.name, **values}
    if not each.finished:
        return {**row, "fault": each.fault or "not finished"}
    try:
        painting, record = read_painting(each.folder / "painting.json"), read_cell(each.folder)
    except InputError as error:  # a person or a disk has changed what was finished
        return {**row, "fault": f"{error}; remove that file, and sweep again"}
    drawn = {"strokes_drawn": len(painting.strokes), "metres": round(float(painting.metres_of_paints().sum()), 4)}
    told = {"seconds": round(record.seconds, 2), "notes": "; ".join(record.notes)}
    metrics = {f"{name}_loss" if name in values else name: x for name, x in painting.provenance.metrics.items()}
    return {**row, **drawn, **metrics, **told, "fault": ""}


def _print(each: Standing, row: Row, varied: Sequence[str]) -> Print:
    name = ", ".join(f"{axis} {row[axis]}" for axis in varied) or each.cell.name
    if row["fault"]:
        return Print(None, (name, str(row["fault"])))
    likeness = f", {row['psnr']:.1f} dB" if "psnr" in row else ""
    return Print(each.folder / "preview.png", (name, f"{row['strokes_drawn']} strokes{likeness}"))
