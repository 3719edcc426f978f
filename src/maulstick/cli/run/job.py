"""A run: from the words to a machine that paints, and what is left to say afterwards."""

from collections.abc import Collection, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from glob import escape
from itertools import count
from pathlib import Path

import numpy as np
from rich.console import Console

from maulstick.arrays import Floats
from maulstick.cli.run.asked import Asked
from maulstick.cli.run.operator import Operator, confirm
from maulstick.cli.run.scene import Scene
from maulstick.errors import InputError, OutputError
from maulstick.painting import read_painting
from maulstick.robot.journal import Journal, journal_of, locked
from maulstick.robot.routine import Action, Draw, drawn_metres, routine, seconds_of
from maulstick.robot.workplace import Workplace


@dataclass(frozen=True)
class Job:
    """What is to be done; unfinished: whether the stroke under the brush was painted, where that is known."""

    painting: Path
    asked: Asked
    dry_run: bool
    from_stroke: int | None
    resume: bool
    unfinished: bool | None
    anew: bool


def paint(job: Job) -> None:
    """Paint, go on painting, or say what would be painted."""
    console = Console(stderr=True, markup=False, highlight=False)
    plan = read_painting(job.painting)
    if not plan.strokes:
        raise InputError(f"{job.painting} has no strokes; plan it again with more")
    if job.from_stroke is not None and not 1 <= job.from_stroke <= len(plan.strokes):
        raise InputError.of_range("--from-stroke", job.from_stroke, f"1 to the {len(plan.strokes)} strokes")
    path = journal_of(job.painting)
    if not job.resume:
        scene = Scene.of(job.asked, plan)
        if job.dry_run:
            _rehearse(scene, scene.first(job.from_stroke), console)
            return
        _make_room(path, job)
        with Journal.open(path) as journal:
            _paint(job, scene, journal, console)
        return
    if not path.exists():
        raise InputError(f"there is no journal {path}; nothing was begun, so leave out --resume")
    with Journal.open(path) as journal:
        if journal.revision is None:
            raise InputError(f"the journal {path} is empty; nothing was begun, so leave out --resume")
        scene = Scene.of(job.asked.after(journal.words), read_painting(journal.painting()))
        if job.dry_run:
            _rehearse(scene, journal.painted, console)
            return
        if journal.unfinished is not None:
            _settle(journal, journal.unfinished, job.unfinished, console)
        _paint(job, scene, journal, console)


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
    with locked(path):
        try:
            kept.mkdir()
            beside = (f"{escape(stem)}.r[0-9]*.*", f"{escape(stem)}.eye.npz", path.name)
            for old in [found for name in beside for found in path.parent.glob(name)]:
                old.rename(kept / old.name)
        except OSError as error:
            raise OutputError(f"cannot move {path} to {kept}: {error.strerror}; do, and run again") from error


def _settle(journal: Journal, stroke: int, painted: bool | None, console: Console) -> None:
    """Write down what became of the stroke under the brush."""
    question = f"stroke {stroke} was under the brush when the run ended. Is it on the paper?"
    if painted is None:
        painted = confirm(console, question, "add --unfinished painted, or --unfinished again")
    (journal.end if painted else journal.again)(stroke)


def _rehearse(scene: Scene, done: Collection[int], console: Console) -> None:
    """Everything but motion: the machine is asked for its limits."""
    scene.robot.ask_limits()
    actions = routine(scene.plan, scene.easel, scene.robot.limits, scene.tray, speed=scene.asked.speed, done=done)
    _say(console, actions, scene, seconds_of(actions, scene.robot.limits, scene.easel.canvas_to_machine(np.zeros(3))))


def _paint(job: Job, scene: Scene, journal: Journal, console: Console) -> None:
    first = scene.first(job.from_stroke)
    scene.paint_again({*first, *journal.painted})
    operator = Operator(console, scene.plan, scene.robot, len(first) + len(journal.painted))
    with ExitStack() as stack:
        eye = stack.enter_context(scene.watching.opened(scene, journal)) if scene.watching is not None else None
        robot = stack.enter_context(scene.robot)
        done = {*first, *journal.painted}
        actions = routine(scene.plan, scene.easel, robot.limits, scene.tray, speed=scene.asked.speed, done=done)
        _say(console, actions, scene, seconds_of(actions, robot.limits, robot.place))
        if not actions:
            return
        if journal.revision is None:
            journal.revise(job.painting, painted=first)
        journal.tell(scene.asked.words)
        ask = operator.ask if scene.simulation is None else scene.simulation.ask
        place = Workplace(
            robot, scene.easel, journal, ask, operator.watch, operator.pause, scene.tray, scene.asked.speed
        )
        try:
            with operator.on_duty(f"maulstick run {job.painting} --resume goes on"):
                if scene.watching is None or eye is None:
                    place.do(actions)
                else:
                    scene.watching.paint(scene.plan, place, eye, operator)
        finally:
            if scene.simulation is not None:
                print(scene.simulation.write_photograph(job.painting), flush=True)


def _say(console: Console, actions: Sequence[Action], scene: Scene, seconds: Floats) -> None:
    if not actions:
        console.print("all strokes are painted")
        return
    strokes, minutes = sum(isinstance(action, Draw) for action in actions), int(np.ceil(seconds.sum() / 60))
    done = len(scene.plan.strokes) - strokes
    what = f"{_counted(strokes, 'stroke')}, {1e3 * drawn_metres(actions):.0f} mm"
    painted = f"; {done} are painted" if done else ""
    console.print(f"{what}, {_counted(len(scene.plan.paints), 'paint')}, about {minutes} min{painted}", soft_wrap=True)


def _counted(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
