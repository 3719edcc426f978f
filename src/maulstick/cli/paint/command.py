"""``maulstick paint``: from a photograph to a painting in a folder."""

import io
import time
from functools import partial
from importlib.resources import files
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from maulstick.canvas import Canvas, parse_size
from maulstick.cli import STOPPED
from maulstick.cli.folder import all_or_nothing, check_free, made_folder
from maulstick.cli.render import png
from maulstick.cli.watch import Camera, progress_bar, stop_on_interrupt
from maulstick.errors import InputError
from maulstick.files import atomic_write
from maulstick.film import Film
from maulstick.medium import load_brush
from maulstick.painting import Painting, write_painting
from maulstick.picture import FITS, picture_hash, read_picture
from maulstick.svg import painting_svg

if TYPE_CHECKING:
    from maulstick.figures import Figures
    from maulstick.plan.planner import Progress as Step

_PREVIEW_PX, _WIDEST_PX = 1024, 4096
_READ_PX = 4096
_PAINTS = 12
_MOST_STROKES, _MOST_STEPS, _MOST_SEED = 100_000, 1_000_000, 2**32 - 1
_FEWEST_PX, _MOST_PX = 16, 4096

_painting = partial(typer.Option, rich_help_panel="The painting")
_planning = partial(typer.Option, rich_help_panel="How it is planned")
_writing = partial(typer.Option, rich_help_panel="What is written")


def paint(
    photo: Annotated[Path | None, typer.Argument(help="The picture to paint: JPEG, PNG, TIFF, WebP …")] = None,
    demo: Annotated[bool, typer.Option("--demo", metavar="", help="Paint the portrait that comes along.")] = False,
    size: Annotated[
        str, _painting(metavar="SIZE", help="Of the sheet: 200x160mm, 8x10in, A4-landscape.")
    ] = "200x160mm",
    fit: Annotated[
        str, _painting(metavar="FIT", help="contain: all of the picture; cover: all of the sheet.")
    ] = "contain",
    strokes: Annotated[int, _painting(metavar="N", help="At most so many; those that do nothing are left out.")] = 400,
    exact: Annotated[bool, _painting("--exact", metavar="", help="Exactly so many strokes.")] = False,
    paints: Annotated[
        int | None, _painting(metavar="N", show_default=f"{_PAINTS}", help="How many to mix, of the picture's colours.")
    ] = None,
    ink: Annotated[
        str | None, _painting(metavar="COLOUR", help="One ink instead of paints: black, or #rrggbb.")
    ] = None,
    brush: Annotated[
        str, _painting(metavar="BRUSH", help="round, marker, fineliner, one of your own, or a JSON file.")
    ] = "round",
    style: Annotated[
        str, _painting(metavar="STYLE", help="Whose strokes: a name out of maulstick style list, or a JSON file.")
    ] = "free",
    steps: Annotated[int, _planning(metavar="N", help="More are finer, and take longer.")] = 1500,
    px: Annotated[
        int | None,
        _planning(
            metavar="N", show_default="as the brush needs", help="Pixels over the picture's height while planning."
        ),
    ] = None,
    seed: Annotated[int, _planning(metavar="N", help="Another seed, another painting; the same repeats it.")] = 0,
    out: Annotated[Path, _writing(metavar="FOLDER", help="Where the painting goes.")] = Path("painting"),
    overwrite: Annotated[bool, _writing("--overwrite", metavar="", help="Replace what an earlier run wrote.")] = False,
    film: Annotated[str | None, _writing(metavar="FORMAT", help="Film the planning, too: mp4 or gif.")] = None,
) -> None:
    """Plan a painting of a photograph.

    Writes painting.json (the plan itself), painting.svg (for plotters: real millimetres, a layer a paint), preview.png
    and palette.png. Ctrl-C stops early and saves the plan so far; a second one leaves without it.
    """
    path = _picture_path(photo, demo)
    sheet, chosen_brush = parse_size(size), load_brush(brush)
    if fit not in FITS:
        raise InputError.of_choice("fit", fit, FITS)
    _check("--strokes", strokes, 1, _MOST_STROKES)
    _check("--steps", steps, 1, _MOST_STEPS)
    _check("--px", px, _FEWEST_PX, _MOST_PX)
    _check("--seed", seed, 0, _MOST_SEED)
    mixed, colour = _paints_or_ink(paints, ink, strokes)
    camera = Camera(Film(film), steps) if film is not None else None
    check_free(out, overwrite)
    picture = read_picture(path, longest_px=_READ_PX)

    from maulstick.brush.preview import preview  # loads torch
    from maulstick.plan.photograph import figures_of, lay_out_for, making, plan_photograph
    from maulstick.plan.commission import PlanOptions
    from maulstick.style import load_style

    options = PlanOptions(strokes, exact, mixed, (colour,), steps, seed=seed)
    layout = lay_out_for(picture, sheet, chosen_brush, fit, px)
    hand = load_style(style, layout.canvas)
    made = making(options, path.name, picture_hash(path), size=size, fit=fit, px=px, brush=brush, style=style)
    console = Console(stderr=True, markup=False, highlight=False)
    thinnest = chosen_brush.thinnest * layout.canvas.pixels_per_metre
    if 0 < thinnest < 1:
        console.print(
            f"note: the thinnest mark of the brush {chosen_brush.name} is {thinnest:.2f} pixels in half-width at this "
            "resolution, so fine lines are planned pale",
            soft_wrap=True,
        )
    started = time.monotonic()
    with made_folder(out), stop_on_interrupt(console) as wanted:
        with progress_bar(console, strokes) as show:

            def watch(step: "Step") -> bool:
                show(step)
                if camera is not None:
                    camera.watch(step)
                return wanted()

            painting = plan_photograph(layout, chosen_brush, hand, options, made, watch)
        seconds = time.monotonic() - started
        if camera is not None:
            camera.film.add(preview(painting, layout.canvas))
        written = _write_results(painting, out, camera.film if camera is not None else None)
        stopped = not wanted()
    _print_summary(painting, figures_of(painting, layout), seconds, out, written)
    if stopped:
        raise typer.Exit(STOPPED)


def _picture_path(photo: Path | None, demo: bool) -> Path:
    if demo == (photo is not None):
        raise InputError("name one picture to paint, or --demo for the portrait that comes along")
    return photo or Path(str(files("skimage.data").joinpath("astronaut.png")))


def _check(name: str, number: int | None, least: int, most: int) -> None:
    if number is not None and not least <= number <= most:
        raise InputError.of_range(name, number, f"from {least} to {most}")


def _paints_or_ink(paints: int | None, ink: str | None, strokes: int) -> tuple[int | None, tuple[float, float, float]]:
    """How many paints, or None and the colour of the only ink."""
    if ink is None:
        if paints is not None and not 1 <= paints <= strokes:
            raise InputError.of_range("--paints", paints, f"from 1 to the {strokes} strokes")
        return paints or min(_PAINTS, strokes), (0.0, 0.0, 0.0)
    if paints is not None:
        raise InputError("--ink paints in one colour and --paints in several; leave one of them out")
    from maulstick.palette import parse_colour  # takes a moment

    return None, parse_colour(ink)


def _write_results(painting: Painting, out: Path, film: Film | None) -> list[str]:
    """Write all files; their names."""
    with all_or_nothing(out) as folder:
        write_painting(painting, folder / "painting.json")
        atomic_write(folder / "painting.svg", painting_svg(painting).encode())
        atomic_write(folder / "preview.png", _preview(painting))
        atomic_write(folder / "palette.png", _palette(painting))
        if film is not None:
            atomic_write(folder / f"progress.{film.kind}", film.encode())
        return sorted(path.name for path in folder.iterdir())


def _preview(painting: Painting) -> bytes:
    from maulstick.brush.preview import preview

    width, height = painting.canvas.width, painting.canvas.height
    return png(preview(painting, Canvas(width, height, min(_PREVIEW_PX / height, _WIDEST_PX / width))))


def _palette(painting: Painting) -> bytes:
    from maulstick.palette import swatches

    metres = _metres_of_paints(painting)
    labels = [f"{i + 1}   {paint.hex}   {metres[i]:.2f} m" for i, paint in enumerate(painting.paints)]
    file = io.BytesIO()
    swatches([paint.colour for paint in painting.paints], labels).save(file, format="PNG")
    return file.getvalue()


def _metres_of_paints(painting: Painting) -> list[float]:
    steps = np.diff(painting.trajectories()[..., :2], axis=1)
    lengths = np.hypot(steps[..., 0], steps[..., 1]).sum(axis=1)
    paint_of = np.array([stroke.paint for stroke in painting.strokes], dtype=int)
    return [float(lengths[paint_of == i].sum()) for i in range(len(painting.paints))]


def _print_summary(painting: Painting, figures: "Figures", seconds: float, out: Path, written: list[str]) -> None:
    structure = "" if isnan(figures.ssim) else f", {figures.ssim:.2f} SSIM"
    rows = {
        "strokes": f"{len(painting.strokes)}",
        "drawn": f"{sum(_metres_of_paints(painting)):.1f} m",
        "paints": f"{len(painting.paints)} (changes: {painting.paint_changes()})",
        "likeness": f"{figures.psnr:.1f} dB PSNR{structure}",
        "planned in": f"{seconds:.0f} s",
        "files": ", ".join(written),
    }
    table = Table(title=Text(str(out)), show_header=False)
    table.add_column()
    table.add_column(overflow="fold")
    for name, value in rows.items():
        table.add_row(name, value)
    Console().print(table)
