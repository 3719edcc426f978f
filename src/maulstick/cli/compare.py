"""``maulstick compare``: shows paintings side by side, with a table of their numbers."""

import os
from collections import Counter
from collections.abc import Sequence
from functools import partial
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from numpy.typing import NDArray
from pydantic import JsonValue
from rich.console import Console
from rich.table import Table
from rich.text import Text

from maulstick.cli.show import check_picture, kind_in
from maulstick.errors import InputError
from maulstick.painting.edit import PictureEdit
from maulstick.painting.fit import lay_out
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting
from maulstick.painting.picture import READ_PX, read_picture
from maulstick.painting.raster import Canvas
from maulstick.storage.arrays import Pixels
from maulstick.storage.files import atomic_write, file_to_read
from maulstick.storage.text import counted

if TYPE_CHECKING:
    from maulstick.painting.metrics import Metrics

_MOST = 6  # paintings that fit beside each other in a picture and a table
_NOTHING = "-"  # cell of the table without a value
_SEVERAL = 3  # names listed in a cell of the table, at most


def compare(
    paintings: Annotated[list[Path], typer.Argument(metavar="PAINTING", help="Two to six files painting.json.")],
    photo: Annotated[
        Path | None, typer.Option(metavar="PICTURE", help="Picture to measure the likeness of the paintings to.")
    ] = None,
    out: Annotated[Path, typer.Option(metavar="FILE", help="The PNG file to write.")] = Path("comparison.png"),
    px: Annotated[int, typer.Option(metavar="N", help="Height of the picture in pixels.")] = 1024,
    overwrite: Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace an earlier picture.")] = False,
) -> None:
    """Draw paintings side by side at one scale, and print a table of their numbers.

    Example: maulstick compare cat/painting.json ink/painting.json --photo photo.jpg
    """
    check_picture(out, px, overwrite)
    plans = _read(paintings)
    picture = None if photo is None else _read_for(plans, photo)

    from maulstick.plots.compare import Panel, compare_plot
    from maulstick.rendering.likeness import likeness as likeness_to
    from maulstick.rendering.preview import preview  # these load torch

    named = dict(zip(_names(paintings), plans, strict=True))
    likeness = {name: None if picture is None else likeness_to(plan, picture) for name, plan in named.items()}
    panels = [
        Panel(name, _note(plan, likeness[name]), (plan.sheet.width, plan.sheet.height), partial(preview, plan))
        for name, plan in named.items()
    ]
    if picture is not None and photo is not None:
        shown = PictureEdit.of(plans[0].provenance.options).applied(picture)
        panels.insert(0, Panel("photograph", photo.name, plans[0].area[2:], partial(_over, shown)))
    title = counted(len(plans), "painting") + ("" if photo is None else f" of {photo.name}")
    told = "each as its own brushes leave it, all at one scale"
    note = "" if picture is None else "likeness to the photograph is measured over the picture's area"
    atomic_write(out, compare_plot(panels, title, told, note, px))
    table = Table()
    table.add_column("")
    for name in named:
        table.add_column(Text(name), justify="right", overflow="fold")
    for row, values in _rows(list(named.values()), list(likeness.values())).items():
        if any(value != _NOTHING for value in values):
            table.add_row(row, *map(Text, values))
    Console().print(table)
    print(out, flush=True)


def _read_for(plans: Sequence[Painting], photo: Path) -> Pixels:
    """Read a photograph as finely as any of the plans needs the part of it that it keeps."""
    return read_picture(photo, max(PictureEdit.of(plan.provenance.options).read_px(READ_PX) for plan in plans))


def _read(paths: Sequence[Path]) -> list[Painting]:
    """Read two to six paintings. Raises InputError for another number, one named twice, and files of other kinds."""
    if not 2 <= len(paths) <= _MOST:
        raise InputError.of_range("the number of paintings to compare", len(paths), f"from 2 to {_MOST}")
    seen: set[str] = set()
    for path in paths:
        if (place := os.path.realpath(path)) in seen:
            raise InputError(f"{path} is named twice; name each painting once")
        seen.add(place)
        kind = kind_in(file_to_read(path, "painting"))
        if kind not in (None, "painting"):
            remedy = "use maulstick style compare" if kind == "style" else "name a painting.json"
            raise InputError(f"{path} holds {kind}, and paintings are compared; {remedy}")
    return [read_painting(path) for path in paths]


def _names(paths: Sequence[Path]) -> list[str]:
    """Return a different name for each painting: its file's, else its folder's, else its path."""
    for names in ([path.stem for path in paths], [path.absolute().parent.name for path in paths]):
        if all(names) and len(set(names)) == len(names):
            return names
    return [str(path) for path in paths]


def _over(picture: NDArray[np.float32], canvas: Canvas) -> NDArray[np.float32]:
    return lay_out(picture, canvas, "cover")[0]


def _note(plan: Painting, likeness: "Metrics | None") -> str:
    counts = f"{counted(len(plan.strokes), 'stroke')}, {counted(len(plan.paints), 'paint')}"
    return counts if likeness is None else f"{counts}, {_metrics(likeness)}"


def _metrics(likeness: "Metrics | None") -> str:
    if likeness is None:
        return _NOTHING
    return f"{likeness.psnr:.1f} dB" + ("" if isnan(likeness.ssim) else f", {likeness.ssim:.2f} SSIM")


def _rows(plans: Sequence[Painting], likeness: Sequence["Metrics | None"]) -> dict[str, list[str]]:
    """Return the rows of the table: one value per painting under the name of the row."""
    from maulstick.rendering.likeness import measured_canvas
    from maulstick.rendering.preview import coverage

    lengths = [plan.lengths() for plan in plans]
    styles = [Counter(stroke.style.name for stroke in plan.strokes if stroke.style is not None) for plan in plans]
    planned = dict.fromkeys(name for plan in plans for name in plan.provenance.metrics)
    return {
        "sheet": [f"{1e3 * plan.sheet.width:g} x {1e3 * plan.sheet.height:g} mm" for plan in plans],
        "strokes": [f"{len(plan.strokes)}" for plan in plans],
        "drawn": [f"{each.sum():.2f} m" for each in lengths],
        "mean stroke": [f"{1e3 * each.mean():.1f} mm" if len(each) else _NOTHING for each in lengths],
        "paints": [f"{len(plan.paints)}" for plan in plans],
        "paint changes": [f"{plan.paint_changes()}" for plan in plans],
        "sheet covered": [f"{coverage(plan, measured_canvas(plan)).mean():.0%}" for plan in plans],
        "style": [_first_names([name for name, _ in each.most_common()]) for each in styles],
        "brush": [_first_names(list(plan.brushes)) for plan in plans],
        "picture": [plan.provenance.image or _NOTHING for plan in plans],
        "steps": [_option(plan, "steps") for plan in plans],
        "seed": [f"{plan.provenance.seed}" for plan in plans],
        "weights": [_option(plan, "weights") for plan in plans],
        **{
            f"{name} in its file": [
                f"{plan.provenance.metrics[name]:.3g}" if name in plan.provenance.metrics else _NOTHING
                for plan in plans
            ]
            for name in planned
        },
        "likeness to the photo": [_metrics(each) for each in likeness],
    }


def _first_names(names: Sequence[str]) -> str:
    more = f" and {len(names) - _SEVERAL} more" if len(names) > _SEVERAL else ""
    return ", ".join(names[:_SEVERAL]) + more or _NOTHING


def _option(plan: Painting, name: str) -> str:
    return _plain(plan.provenance.options.get(name))


def _plain(value: JsonValue) -> str:
    """Return the value of an option as a person would write it."""
    if value is None:
        return _NOTHING
    if isinstance(value, dict):
        return ", ".join(f"{name} {_plain(each)}" for name, each in value.items()) or _NOTHING
    if isinstance(value, list):
        return ", ".join(_plain(each) for each in value) or _NOTHING
    return f"{value:g}" if isinstance(value, float) else str(value)
