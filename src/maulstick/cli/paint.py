"""``maulstick paint``: from a photograph to a painting in a folder."""

import io
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from maulstick.canvas import Canvas, parse_size
from maulstick.cli.render import png
from maulstick.errors import InputError, OutputError
from maulstick.figures import Figures
from maulstick.files import atomic_write
from maulstick.film import Film
from maulstick.medium import load_brush
from maulstick.painting import Painting, write_painting
from maulstick.palette import parse_colour, swatches
from maulstick.picture import picture_hash, read_picture
from maulstick.svg import painting_svg

if TYPE_CHECKING:
    from maulstick.plan.planner import Progress as Step

STOPPED = 130
_PREVIEW_PX = 1024
_READ_PX = 4096
_FRAMES = 160


def paint(
    photo: Annotated[Path | None, typer.Argument(help="The picture to paint: JPEG, PNG, TIFF, WebP …")] = None,
    demo: Annotated[bool, typer.Option("--demo", help="Paint the portrait that comes along instead.")] = False,
    out: Annotated[Path, typer.Option(help="Folder for the painting.")] = Path("painting"),
    size: Annotated[str, typer.Option(help="Of the sheet: 200x160mm, 8x10in, A4, A4-landscape …")] = "200x160mm",
    fit: Annotated[str, typer.Option(help="contain: all of the picture. cover: all of the sheet.")] = "contain",
    strokes: Annotated[int, typer.Option(help="At most so many; those that do nothing are left out.")] = 400,
    exact: Annotated[bool, typer.Option("--exact", help="Exactly so many strokes.")] = False,
    paints: Annotated[int, typer.Option(help="How many paints to mix, of the picture's colours.")] = 12,
    ink: Annotated[str | None, typer.Option(help="One ink instead of paints: black, or #rrggbb.")] = None,
    brush: Annotated[str, typer.Option(help="round, marker, fineliner, or a brush's JSON file.")] = "round",
    style: Annotated[str, typer.Option(help="Whose strokes; free: nobody's, any smooth stroke.")] = "free",
    steps: Annotated[int, typer.Option(help="Of the planner: more is finer, and takes longer.")] = 1500,
    seed: Annotated[int, typer.Option(help="Another seed, another painting; the same repeats it.")] = 0,
    px: Annotated[int | None, typer.Option(help="Height of the picture while planning, pixels.")] = None,
    film: Annotated[str | None, typer.Option(help="Film the planning, too: mp4 or gif.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the painting in the folder.")] = False,
) -> None:
    """Plan a painting of a photograph.

    Writes into the folder: painting.json (the plan itself), painting.svg (for plotters: real millimetres, a layer a
    paint), preview.png and palette.png. Ctrl-C stops early and saves the plan so far; a second one saves nothing.
    """
    path = _picture_path(photo, demo)
    picture = read_picture(path, longest_px=_READ_PX)
    sheet, chosen_brush = parse_size(size), load_brush(brush)
    colour = parse_colour(ink) if ink is not None else None
    recorder = _Recorder(Film(film) if film is not None else None, steps)
    _check_folder(out, overwrite)

    from maulstick.plan.photograph import figures_of, lay_out_for, making, plan_photograph  # loads torch
    from maulstick.plan.planner import PlanOptions
    from maulstick.style import load_style

    options = PlanOptions(strokes, exact, None if colour else paints, colour or (0.0, 0.0, 0.0), steps, seed)
    layout = lay_out_for(picture, sheet, chosen_brush, fit, px)
    hand = load_style(style, layout.canvas)
    thinnest = chosen_brush.thinnest * layout.canvas.pixels_per_metre
    console = Console(stderr=True)
    if 0 < thinnest < 1:
        note = (
            f"thinnest mark is {thinnest:.2f} pixels in half-width at this resolution, so fine lines are planned pale"
        )
        console.print(f"note: the {chosen_brush.name}'s {note}", highlight=False)
    made = making(options, path.name, picture_hash(path), size=size, fit=fit, px=px, brush=brush, style=style)
    started = time.monotonic()
    with _progress_bar(console, strokes) as show, _stop_on_interrupt(console) as wanted:

        def watch(step: "Step") -> bool:
            show(step)
            recorder.watch(step)
            return wanted()

        painting = plan_photograph(layout, chosen_brush, hand, options, made, watch)
        stopped = not wanted()
    seconds = time.monotonic() - started
    _write_results(painting, out, recorder)
    _print_summary(painting, figures_of(painting, layout), seconds, out)
    if stopped:
        raise typer.Exit(STOPPED)


def _picture_path(photo: Path | None, demo: bool) -> Path:
    if demo == (photo is not None):
        raise InputError("name one picture to paint, or --demo for the portrait that comes along")
    return photo or Path(str(files("skimage.data").joinpath("astronaut.png")))


def _check_folder(out: Path, overwrite: bool) -> None:
    try:
        if out.is_dir() and any(out.iterdir()) and not overwrite:
            raise OutputError(f"the folder {out} is not empty; choose another --out, or add --overwrite")
        out.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise OutputError(f"{out} is a file, not a folder; choose another --out") from None
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(f"cannot make the folder {out}: {error.strerror}; choose another --out") from error


@contextmanager
def _progress_bar(console: Console, strokes: int) -> Iterator[Callable[["Step"], None]]:
    columns = (
        TextColumn(f"{strokes} strokes"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TextColumn("loss {task.fields[loss]:.5f}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console) as bar:
        task = bar.add_task("planning", total=1.0, loss=float("nan"))
        yield lambda step: bar.update(task, completed=step.done, loss=step.loss)
        bar.update(task, completed=1.0)


@contextmanager
def _stop_on_interrupt(console: Console) -> Iterator[Callable[[], bool]]:
    """Whether to go on: until the first Ctrl-C. The second one interrupts as usual."""
    going = [True]

    def stop(*_: object) -> None:
        going[0] = False
        signal.signal(signal.SIGINT, before)
        console.print("stopping: finishing the plan so far (Ctrl-C again leaves without it)")

    before = signal.signal(signal.SIGINT, stop)
    try:
        yield lambda: going[0]
    finally:
        signal.signal(signal.SIGINT, before)


class _Recorder:
    """Takes some 160 frames of a plan as it is made, if there is a film."""

    def __init__(self, film: Film | None, steps: int) -> None:
        self.film = film
        self._every = max(1, steps // _FRAMES)
        self._seen = 0

    def watch(self, step: "Step") -> None:
        if self.film is not None and self._seen % self._every == 0:
            self.film.add(step.canvas.clamp(0, 1).permute(1, 2, 0).numpy())
        self._seen += 1


def _write_results(painting: Painting, out: Path, recorder: _Recorder) -> None:
    from maulstick.brush.preview import preview

    write_painting(painting, out / "painting.json")
    atomic_write(out / "painting.svg", painting_svg(painting).encode())
    canvas = Canvas.of_height((painting.canvas.width, painting.canvas.height), _PREVIEW_PX)
    atomic_write(out / "preview.png", png(preview(painting, canvas)))
    metres = _metres_of_paints(painting)
    labels = [f"{i + 1}   {paint.hex}   {metres[i]:.2f} m" for i, paint in enumerate(painting.paints)]
    file = io.BytesIO()
    swatches([paint.colour for paint in painting.paints], labels).save(file, format="PNG")
    atomic_write(out / "palette.png", file.getvalue())
    if recorder.film is not None:
        atomic_write(out / f"progress.{recorder.film.kind}", recorder.film.encode())


def _metres_of_paints(painting: Painting) -> list[float]:
    steps = np.diff(painting.trajectories()[..., :2], axis=1)
    lengths = np.hypot(steps[..., 0], steps[..., 1]).sum(axis=1)
    paint_of = np.array([stroke.paint for stroke in painting.strokes], dtype=int)
    return [float(lengths[paint_of == i].sum()) for i in range(len(painting.paints))]


def _print_summary(painting: Painting, figures: Figures, seconds: float, out: Path) -> None:
    table = Table(title=str(out), show_header=False)
    rows = {
        "strokes": f"{len(painting.strokes)}",
        "drawn": f"{sum(_metres_of_paints(painting)):.1f} m",
        "paints": f"{len(painting.paints)}, changed {painting.paint_changes()} times",
        "likeness": f"{figures.psnr:.1f} dB PSNR, {figures.ssim:.2f} SSIM",
        "planned in": f"{seconds:.0f} s",
        "files": ", ".join(sorted(path.name for path in out.iterdir())),
    }
    for name, value in rows.items():
        table.add_row(name, value)
    Console().print(table)
