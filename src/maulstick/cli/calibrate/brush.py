"""``maulstick calibrate brush``: lets a machine draw strokes, photographs them, and fits a brush."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from maulstick.cli.brush.fit import fit as fit_trials
from maulstick.cli.lengths import metres
from maulstick.cli.paint.operator import TerminalOperator, confirm
from maulstick.errors import InputError, MachineError, OutputError, nothing_is_painted
from maulstick.jobs.paint.machine_lock import machine_lock
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.simulation import Simulation
from maulstick.jobs.plan.options import USUAL_PRESSURE
from maulstick.painting.brush import BRUSHES, Brush, load_brush
from maulstick.painting.painting import Painting, Sheet
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.painting.raster import Canvas, flat_canvas, parse_size
from maulstick.robot.easel import read_easel
from maulstick.robot.journal import Journal, journal_of, was_begun
from maulstick.robot.machines import SPECS, check_spec, kind_of, machine
from maulstick.robot.plotter import only_lifts_pen
from maulstick.robot.workplace import Workplace, home_of
from maulstick.storage.folders import all_or_nothing

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from maulstick.robot.easel import Easel

_FEWEST, _MOST = 5, 1000  # strokes: too few for a fit, and hours of drawing
_PHOTOGRAPHS = ("each", "one")  # one after each stroke, or one of the whole sheet

_fitting = partial(typer.Option, rich_help_panel="The brush and its strokes")
_machine = partial(typer.Option, rich_help_panel="The machine")
_camera = partial(typer.Option, rich_help_panel="The camera")
_writing = partial(typer.Option, rich_help_panel="What is written")


def brush(
    name: Annotated[str, _fitting(metavar="NAME", help="Name of the new brush.")] = "calibrated",
    robot: Annotated[str, _machine(metavar="MACHINE", help=f"The machine that draws: {SPECS}.")] = "sim",
    camera: Annotated[
        str | None,
        _camera(metavar="CAMERA", show_default="the easel's, with sim", help="The camera: usb:0, or folder:PATH."),
    ] = None,
    like: Annotated[
        str,
        _fitting(metavar="BRUSH", help="Brush of about the same width that varies with pressure, or not, as it does."),
    ] = "marker",
    style: Annotated[str, _fitting(metavar="STYLE", help="Style of the strokes.")] = "loops",
    strokes: Annotated[int, _fitting(metavar="N", help="Number of strokes.")] = 60,
    photographs: Annotated[
        str,
        _camera(metavar="each|one", help="Photograph the sheet after each stroke, or once, which is quicker."),
    ] = "each",
    size: Annotated[str, _machine(metavar="SIZE", help="Size of the sheet: 200x160mm, A4-landscape.")] = "A4-landscape",
    easel: Annotated[
        Path | None,
        _machine(metavar="FILE", help="Place of the sheet, from `maulstick calibrate touch`. Arms need it."),
    ] = None,
    tag: Annotated[str, _camera(metavar="MM", help="Side of the black squares of the tags.")] = "20",
    view: Annotated[
        Path | None,
        _camera(metavar="FILE", help="The camera's view, from `maulstick calibrate camera --keep`, instead of tags."),
    ] = None,
    speed: Annotated[
        float | None, _machine(metavar="MM/S", show_default="the machine's", help="Speed of drawing, at most.")
    ] = None,
    out: Annotated[
        Path,
        _writing(
            metavar="FOLDER",
            help="Folder for strokes and photographs. An unfinished one is continued, a finished one fitted again.",
        ),
    ] = Path("calibration"),
    overwrite: Annotated[
        bool, _writing("--overwrite", metavar="", help="Replace your earlier brush of that name.")
    ] = False,
) -> None:
    """Draw strokes apart from one another, photograph them, and fit a brush to them.

    Put in the pen or brush and a bare sheet first. Ctrl-C stops; the same command goes on.

    Example: maulstick calibrate brush --name sharpie --robot axidraw --camera usb:0 --strokes 60
    """
    BRUSHES.check_own_name(name, overwrite)
    if not _FEWEST <= strokes <= _MOST:
        raise InputError.of_range("--strokes", strokes, f"{_FEWEST} to {_MOST}")
    if photographs not in _PHOTOGRAPHS:
        raise InputError.of_choice("way to photograph", photographs, _PHOTOGRAPHS)
    options = PaintOptions(
        robot=robot,
        easel=easel,
        speed=None if speed is None else speed * 1e-3,
        camera=camera,
        view=view,
        tag=metres(tag, "--tag"),
    )
    options.check()
    if options.simulated:
        if camera is not None:
            raise InputError("the simulated easel has a camera of its own; leave out --camera")
    else:
        check_spec(options.machine)
        if camera is None:
            raise InputError("a camera over the sheet is needed; name it with --camera usb:0, or folder:PATH")
    place = read_easel(easel) if easel is not None else None
    model = load_brush(like)
    if not options.simulated and model.pressure_matters and only_lifts_pen(machine(options.machine, place)):
        held = model.held_at(USUAL_PRESSURE)  # as plans for such a machine are painted
        model = held.model_copy(update={"depth": (0.0, 0.0)})  # how deep it is pressed is not known
    sheet = _sheet(out, parse_size(size), model, style, strokes, place)
    _check_machine(out, options.machine)
    _collect(sheet, out, options, place, each=photographs == "each")
    try:
        fit_trials(out / "trials", name, None, overwrite)
    except InputError as error:  # the same command would fit the same strokes again
        raise InputError(f"{error}; to draw other strokes on a new sheet, choose another --out") from error


def _sheet(
    out: Path, size: tuple[float, float], like: Brush, style: str, strokes: int, easel: "Easel | None"
) -> Painting:
    """Return the strokes to draw: those of an unfinished folder, or new ones.

    Strokes of other options are replaced where no machine has begun them.
    """
    path = out / "practice.json"
    if path.exists():
        begun = read_painting(path)
        there = (begun.sheet.width, begun.sheet.height), [*begun.brushes], begun.provenance.options.get("style")
        if (*there, len(begun.strokes)) == (size, [like.name], style, strokes):
            return begun
        if was_begun(journal_of(path)) or not begun.provenance.options.get("practice"):
            raise InputError(f"{out} was begun with other options; go on with the same ones, or choose another --out")
    elif out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise OutputError(f"{out} holds something else; choose another --out")
    from maulstick.jobs.practice import practice  # loads torch
    from maulstick.style import load_style

    hand = load_style(style, Canvas(*size, 1.0))
    if easel is not None and like.pressure_matters:
        like = like.model_copy(update={"depth": (0.0, easel.deepest)})
    return practice(hand, like, Sheet(width=size[0], height=size[1]), strokes)


def _keep(sheet: Painting, path: Path) -> None:
    """Write the strokes, unless a machine has begun them; the folder is made where missing."""
    if was_begun(journal_of(path)):
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot make the folder {path.parent}: {error.strerror}; choose another --out") from error
    write_painting(sheet, path)


def _check_machine(out: Path, robot: str) -> None:
    """Raise InputError where another kind of machine drew in the folder: one brush is not learned from two."""
    journal = journal_of(out / "practice.json")
    if not was_begun(journal):
        return
    before = str(Journal.read(journal).options.get("robot", robot))
    if kind_of(before) != kind_of(robot):
        raise InputError(f"the strokes in {out} were drawn by {before}, not by {robot}; choose another --out")


def _collect(sheet: Painting, out: Path, options: PaintOptions, place: "Easel | None", *, each: bool) -> None:
    """Draw what is left, take the photographs, and cut the trials out of them."""
    from maulstick.calibration.camera import read_view
    from maulstick.calibration.collect import collect, trials_of
    from maulstick.calibration.eye import Eye
    from maulstick.jobs.practice import room_around
    from maulstick.robot.camera.camera import open_camera
    from maulstick.robot.camera.tag_frame import TagFrame

    console = Console(stderr=True, markup=False, highlight=False)

    def tell(sentence: str) -> None:
        console.print(f"note: {sentence}", soft_wrap=True)

    def look() -> "NDArray[np.float32]":
        with operator.interruptible():
            seen = eye.look()
        for note in seen.notes:
            operator.note(note)
        if seen.shift is not None:
            raise MachineError("strokes are learned by their places, and the sheet has moved; put it back, and go on")
        return seen.image

    size = sheet.sheet.width, sheet.sheet.height
    tags, canvas = TagFrame(*size, side=options.tag_side), flat_canvas(*size)
    if (out / "trials").exists():
        tell(f"all strokes in {out} were drawn before, and are only fitted again; to draw others, choose another --out")
        return
    view = None if options.view is None else read_view(options.view)
    path, (brush,) = out / "practice.json", sheet.brushes.values()
    simulation = Simulation.of(options.machine, sheet, place, None) if options.simulated else None
    robot = machine(options.machine, place) if simulation is None else simulation.robot
    easel = place or robot.easel(*size)
    seeing = open_camera(options.camera or "", tell) if simulation is None else simulation.camera(tags)
    _keep(sheet, path)  # once machine and camera are known to be such
    with (
        nothing_is_painted(),
        machine_lock(options.machine),
        Journal.open(journal_of(path)) as journal,
        robot,
        seeing,
    ):
        begun = journal.revision is not None
        if not begun:
            journal.revise(path)
        if (stroke := journal.unfinished) is not None:
            question = f"stroke {len(journal.painted) + 1} was under the brush. Is it on the paper?"
            (journal.end if confirm(console, question, "run it in a terminal") else journal.again)(stroke)
        if simulation is not None:
            simulation.paint_again(easel, journal.painted)
        kept = out / "practice.eye.npz"
        if kept.exists():
            eye = Eye.opened_again(seeing, canvas, tags, kept, view)
        else:
            eye = Eye.opened(seeing, canvas, tags, view=view)
            eye.write(kept)
        journal.write_home(home_of(robot, journal))
        journal.write_options({"robot": options.machine})
        operator = TerminalOperator(console, sheet, robot, len(journal.painted), "the same command goes on")
        ask = operator.ask if simulation is None else simulation.ask
        workplace = Workplace(
            robot, easel, journal, ask, operator.watch, operator.pause, speed=options.speed, pace=operator.pace
        )
        with operator.on_duty():
            if asked := workplace.where_it_stands(0, goes_on=begun):
                workplace.do(asked)
            taken = collect(sheet, workplace, look, out, each=each)
    depth = brush.depth if any(brush.depth) else (0.0, easel.deepest)
    with all_or_nothing(out) as staging:
        trials_of(
            sheet,
            taken,
            staging / "trials",
            pixels_per_metre=canvas.pixels_per_metre,
            medium=brush.name,
            depth=depth,
            room=room_around(brush),
        )
