"""A run: from the words to a machine that paints, and what is left to say afterwards."""

from collections.abc import Sequence
from dataclasses import dataclass
from glob import escape
from itertools import count
from pathlib import Path

import numpy as np
from rich.console import Console
from typer import Exit

from maulstick.arrays import Floats
from maulstick.cli import STOPPED
from maulstick.cli.run.eyes import Watching
from maulstick.cli.run.operator import Operator, confirm
from maulstick.cli.run.simulation import Simulation
from maulstick.errors import InputError, OutputError
from maulstick.painting import Painting, read_painting
from maulstick.robot.easel import read_easel
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.machines import machine
from maulstick.robot.robot import StoppedError
from maulstick.robot.routine import Action, Draw, drawn_metres, routine, seconds_of
from maulstick.robot.sequence import sequenced
from maulstick.robot.tray import read_tray
from maulstick.robot.workplace import Workplace

_HOME = np.zeros(3)  # of the canvas, where a dry run begins


@dataclass(frozen=True)
class Job:
    """What was asked for; speed in metres a second, unfinished: whether the stroke under the brush was painted."""

    painting: Path
    robot: str
    easel: Path | None
    tray: Path | None
    speed: float | None
    watching: Watching | None
    dry_run: bool
    from_stroke: int | None
    resume: bool
    unfinished: bool | None
    anew: bool


def paint(job: Job) -> None:
    """Paint, or go on painting."""
    console = Console(stderr=True, markup=False, highlight=False)
    plan = read_painting(job.painting)
    if not plan.strokes:
        raise InputError(f"{job.painting} has no strokes; plan it again with more")
    if job.from_stroke is not None and not 1 <= job.from_stroke <= len(plan.strokes):
        raise InputError.of_range("--from-stroke", job.from_stroke, f"1 to the {len(plan.strokes)} strokes")
    if job.watching is not None:
        job.watching.check(plan)
    path = journal_of(job.painting)
    if job.dry_run:
        _paint(job, plan, None, console)
        return
    if not job.resume:
        _make_room(path, job)
    elif not path.exists():
        raise InputError(f"there is no journal {path}; nothing was begun, so leave out --resume")
    with Journal.open(path) as journal:
        if job.resume:
            plan = _where_it_was(journal, job, console)
        _paint(job, plan, journal, console)


def _make_room(path: Path, job: Job) -> None:
    """For a new journal."""
    if not path.exists() or path.stat().st_size == 0:
        return
    if not job.anew:
        raise InputError(
            f"{path} says that this painting was begun; go on with --resume, or start on a new sheet with --anew"
        )
    stem = job.painting.stem
    kept = next(folder for i in count(1) if not (folder := path.with_name(f"{stem}.run{i}")).exists())
    with Journal.open(path):  # that no other process is painting by it
        try:
            kept.mkdir()
            for old in (*path.parent.glob(f"{escape(stem)}.r[0-9]*.*"), path):  # its revisions, with their photographs
                old.rename(kept / old.name)
        except OSError as error:
            raise OutputError(f"cannot move {path} to {kept}: {error.strerror}; do, and run again") from error


def _where_it_was(journal: Journal, job: Job, console: Console) -> Painting:
    """The painting as it is painted now, once it is known what became of the stroke under the brush."""
    if journal.revision is None:
        raise InputError(f"the journal {journal.path} is empty; nothing was begun, so leave out --resume")
    plan = read_painting(journal.painting())
    if (stroke := journal.unfinished) is not None:
        question = f"stroke {stroke} was under the brush when the run ended. Is it on the paper?"
        painted = job.unfinished if job.unfinished is not None else confirm(console, question)
        (journal.end if painted else journal.again)(stroke)
    return plan


def _paint(job: Job, plan: Painting, journal: Journal | None, console: Console) -> None:
    easel = read_easel(job.easel) if job.easel is not None else None
    tray = read_tray(job.tray) if job.tray is not None else None
    plan = sequenced(plan, (0.0, 0.0))  # not from where the pen is: --from-stroke counts in an order that stays
    simulation = Simulation.of(job.robot, plan, easel, tray) if job.robot.startswith("sim") else None
    robot = machine(job.robot, easel) if simulation is None else simulation.robot
    easel = easel or robot.easel(plan.canvas.width, plan.canvas.height)
    first = [] if job.from_stroke is None else [stroke.id for stroke in plan.strokes[: job.from_stroke - 1]]
    done = {*first, *(journal.painted if journal is not None else ())}
    if simulation is not None:
        simulation.paint_again(easel, done)
    if journal is None:
        robot.ask_limits()
        actions = routine(plan, easel, robot.limits, tray, speed=job.speed, done=done)
        _say(console, actions, plan, seconds_of(actions, robot.limits, easel.canvas_to_machine(_HOME)), len(done))
        return
    with robot:
        actions = routine(plan, easel, robot.limits, tray, speed=job.speed, done=done)
        _say(console, actions, plan, seconds_of(actions, robot.limits, robot.place), len(done))
        if journal.revision is None:
            journal.revise(job.painting, painted=first)
        operator = Operator(console, plan, robot, len(done))
        ask = operator.ask if simulation is None else simulation.ask
        try:
            with operator.on_duty():
                place = Workplace(robot, easel, journal, ask, operator.watch, operator.pause, tray, job.speed)
                if job.watching is None:
                    place.do(actions)
                else:
                    job.watching.paint(plan, place, simulation, console)
        except (StoppedError, KeyboardInterrupt):
            if not operator.stopped:
                raise
            console.print(
                f"stopped, with the pen lifted; maulstick run {job.painting} --resume goes on", soft_wrap=True
            )
            raise Exit(STOPPED) from None
        finally:
            if simulation is not None:
                print(simulation.write_photograph(job.painting), flush=True)


def _say(console: Console, actions: Sequence[Action], plan: Painting, seconds: Floats, done: int) -> None:
    strokes = sum(isinstance(action, Draw) for action in actions)
    minutes = int(np.ceil(seconds.sum() / 60))
    console.print(
        f"{strokes} strokes, {1e3 * drawn_metres(actions):.0f} mm, {len(plan.paints)} paints, "
        f"{plan.paint_changes()} changes of paint, about {minutes} min" + (f"; {done} are painted" if done else ""),
        soft_wrap=True,
    )
