"""``maulstick brush fit``: fits a brush to photographs of its strokes."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from maulstick.brush_fit.trials import Trials
from maulstick.cli.folder import check_place
from maulstick.errors import InputError
from maulstick.painting.brush import BRUSHES, write_brush
from maulstick.storage.files import atomic_write
from maulstick.storage.folders import MAKE_ROOM, made_folder
from maulstick.storage.text import made_printable

if TYPE_CHECKING:
    from maulstick.brush_fit.fit import Fit

_MOST_SAID = 10  # strokes left out that are named, so that the summary stays on the screen


def fit(
    trials: Annotated[
        Path, typer.Argument(metavar="TRIALS", help="Folder of strokes drawn once each, with their photographs.")
    ],
    name: Annotated[str, typer.Option(metavar="NAME", help="Name of the new brush.")],
    plot: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="PNG file of photographs beside the fitted brush's marks."),
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", metavar="", help="Replace your earlier brush of that name, and the picture.")
    ] = False,
) -> None:
    """Fit a brush to photographs taken before and after strokes; 100 strokes make a good one.

    It is kept among your own brushes, and maulstick plan --brush NAME plans with it.

    Example: maulstick brush fit trials --name sharpie --plot sharpie.png
    """
    BRUSHES.check_own_name(name, overwrite)
    if plot is not None:
        _check_plot(plot, overwrite)
    drawn = Trials.open(trials)
    started = time.monotonic()
    console = Console(stderr=True, markup=False, highlight=False)
    from maulstick.brush_fit.fit import fit_brush  # loads torch

    path, source = BRUSHES.own() / f"{name}.json", _source(drawn)
    with made_folder(path.parent, MAKE_ROOM):
        with _progress_bar(console) as show:
            found = fit_brush(drawn, drawn.pixels_per_metre, name, source=source, depth=drawn.depth, progress=show)
        seconds = time.monotonic() - started
        write_brush(found.brush, path, overwrite)
    for warning in found.warnings:
        console.print(f"note: {warning}", soft_wrap=True)
    _say_left_out(console, found.left_out)
    _print_summary(found, seconds, path)
    if plot is not None:
        from maulstick.plots.brush_fit import fit_plot

        atomic_write(plot, fit_plot(found))
        print(plot, flush=True)
    print(f"maulstick plan photo.jpg --brush {name}", flush=True)


def _check_plot(plot: Path, overwrite: bool) -> None:
    if plot.suffix.lower() != ".png":
        raise InputError(f"--plot is {plot}; a picture is written as PNG, so let its name end in .png")
    check_place(plot, "--plot", overwrite)


def _source(trials: Trials) -> str:
    """Return where the brush comes from, for people."""
    return f"{trials.medium}, fitted to the trials in {made_printable(trials.folder.resolve().name)}"


@contextmanager
def _progress_bar(console: Console) -> Iterator[Callable[[str, int, int], None]]:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("reading")
        yield lambda stage, done, total: bar.update(task, description=stage, completed=done, total=total)


def _say_left_out(console: Console, left_out: Sequence[str]) -> None:
    for reason in left_out[:_MOST_SAID]:
        console.print(f"left out: {reason}", soft_wrap=True)
    if len(left_out) > _MOST_SAID:
        console.print(f"and {len(left_out) - _MOST_SAID} more", soft_wrap=True)


def _print_summary(found: "Fit", seconds: float, path: Path) -> None:
    from maulstick.plots.brush_fit import measured

    rows = {
        "strokes": f"{found.strokes}{f' (and {len(found.left_out)} left out)' if found.left_out else ''}",
        **measured(found),
        "beyond the paper": ", ".join(found.kept) or "nothing that makes unseen strokes clearly better",
        "L1 per pixel": f"{found.l1:.4f}; with the paper's seven numbers {found.l1_paper:.4f}",
        "scatter": f"{1e3 * found.place_scatter:.2g} mm in place, {found.ink_scatter:.0%} in darkness",
        "fitted in": f"{seconds:.2g} s",
        "kept as": f"{path}",
    }
    table = Table(title=Text(f"the brush {found.brush.name}"), show_header=False)
    table.add_column()
    table.add_column(overflow="fold")
    for row, value in rows.items():
        table.add_row(row, Text(value))
    Console().print(table)
