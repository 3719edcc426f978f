"""A run: from what was asked to a machine that paints, and what it will come to."""

from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from glob import escape
from itertools import count
from pathlib import Path

import numpy as np

from maulstick.errors import InputError, OutputError
from maulstick.jobs.paint.estimate import Outlook
from maulstick.jobs.paint.machine_lock import driven_alone
from maulstick.jobs.paint.operator import Person
from maulstick.jobs.paint.options import Asked
from maulstick.jobs.paint.setup import Scene
from maulstick.painting.painting import Painting, read_painting
from maulstick.robot.journal import Journal, journal_of, locked
from maulstick.robot.robot import StoppedError
from maulstick.robot.routine import routine
from maulstick.robot.workplace import Workplace


@dataclass(frozen=True)
class Errand:
    """What is to be painted, and how.

    from_stroke: the first one, counted from 1; those before count as painted.  resume: go on where the journal ends.
    anew: on a new sheet, whatever the journal says, which is kept.
    """

    painting: Path
    asked: Asked
    from_stroke: int | None = None
    resume: bool = False
    anew: bool = False


def rehearse(errand: Errand) -> Outlook:
    """Everything but motion: the machine is asked for its limits. Raises what `paint` would."""
    plan = _plan_of(errand)
    if not errand.resume:
        scene = Scene.of(errand.asked, plan)
        return _rehearsed(scene, scene.first(errand.from_stroke))
    with _reopened(errand) as (scene, journal):
        return _rehearsed(scene, journal.painted)


def paint(
    errand: Errand, is_painted: Callable[[int], bool], person_beside: Callable[[Scene, Collection[int]], Person]
) -> None:
    """Paint, or go on painting, until nothing is left or somebody stops it.

    is_painted: whether the stroke with this id, which was under the brush when an earlier run ended, is on the paper.
    person_beside: the machine of a scene on which these strokes are painted.
    Raises InputError, OutputError and MachineError, as well as StoppedError and KeyboardInterrupt after a stop.
    """
    plan = _plan_of(errand)
    if not errand.resume:
        scene = Scene.of(errand.asked, plan)
        with driven_alone(errand.asked.machine):
            _see_that_it_may_begin(errand)
            _paint(errand, scene, None, person_beside)
        return
    with _reopened(errand) as (scene, journal), driven_alone(scene.asked.machine):
        if (stroke := journal.unfinished) is not None:
            (journal.end if is_painted(stroke) else journal.again)(stroke)
        _paint(errand, scene, journal, person_beside)


def _plan_of(errand: Errand) -> Painting:
    plan, number = read_painting(errand.painting), errand.from_stroke
    if not plan.strokes:
        raise InputError(f"{errand.painting} has no strokes; plan it again with more")
    if number is not None and not 1 <= number <= len(plan.strokes):
        raise InputError.of_range("--from-stroke", number, f"1 to the {len(plan.strokes)} strokes")
    return plan


@contextmanager
def _reopened(errand: Errand) -> Iterator[tuple[Scene, Journal]]:
    path = journal_of(errand.painting)
    if not path.exists():
        raise InputError(f"there is no journal {path}; nothing was begun, so leave out --resume")
    with Journal.open(path) as journal:
        if journal.revision is None:
            raise InputError(f"the journal {path} is empty; nothing was begun, so leave out --resume")
        yield Scene.of(errand.asked.after(journal.words), read_painting(journal.painting())), journal


def _was_begun(path: Path) -> bool:
    return path.exists() and path.stat().st_size > 0


def _see_that_it_may_begin(errand: Errand) -> None:
    path = journal_of(errand.painting)
    if _was_begun(path) and not errand.anew:
        raise InputError(
            f"{path} says that this painting was begun; go on with --resume, or start on a new sheet with --anew"
        )
    with locked(path):  # rather than once the machine is connected
        return


@contextmanager
def _new_journal(painting: Path) -> Iterator[Journal]:
    path = journal_of(painting)
    if _was_begun(path):
        _make_room(path, painting.stem)
    with Journal.open(path) as journal:
        yield journal


def _make_room(path: Path, stem: str) -> None:
    """For a new journal."""
    kept = next(folder for i in count(1) if not (folder := path.with_name(f"{stem}.run{i}")).exists())
    with locked(path):
        try:
            kept.mkdir()
            beside = (f"{escape(stem)}.r[0-9]*.*", f"{escape(stem)}.eye.npz", path.name)
            for old in [found for name in beside for found in path.parent.glob(name)]:
                old.rename(kept / old.name)
        except OSError as error:
            raise OutputError(f"cannot move {path} to {kept}: {error.strerror}; do, and run again") from error


def _rehearsed(scene: Scene, done: Collection[int]) -> Outlook:
    with driven_alone(scene.asked.machine):
        scene.robot.ask_limits()
    actions = routine(scene.plan, scene.easel, scene.robot.limits, scene.tray, speed=scene.asked.speed, done=done)
    start = scene.easel.canvas_to_machine(np.zeros(3))
    return Outlook.of(actions, scene.plan, scene.robot.limits, start)


def _paint(
    errand: Errand,
    scene: Scene,
    before: Journal | None,
    person_beside: Callable[[Scene, Collection[int]], Person],
) -> None:
    """before: the journal that is gone on with; without, a new one takes its place once the machine is connected."""
    first = scene.first(errand.from_stroke)
    done = {*first, *(() if before is None else before.painted)}
    scene.paint_again(done)
    person = person_beside(scene, done)
    with ExitStack() as stack:
        with person.beside_a_machine_that_rests():
            eye = (
                None
                if scene.watching is None
                else stack.enter_context(scene.watching.opened(scene.plan, scene.simulation, before))
            )
        robot = stack.enter_context(scene.robot)
        actions = routine(scene.plan, scene.easel, robot.limits, scene.tray, speed=scene.asked.speed, done=done)
        person.expect(Outlook.of(actions, scene.plan, robot.limits, robot.place))
        if not actions:
            return
        if person.stopped:
            raise StoppedError
        journal = before or stack.enter_context(_new_journal(errand.painting))
        if before is None:
            if scene.watching is not None and eye is not None:
                scene.watching.keep(eye, journal)
            journal.revise(errand.painting, painted=first)
        journal.tell(scene.asked.words)
        ask = person.ask if scene.simulation is None else scene.simulation.ask
        place = Workplace(robot, scene.easel, journal, ask, person.watch, person.pause, scene.tray, scene.asked.speed)
        try:
            with person.on_duty():
                if scene.watching is None or eye is None:
                    place.do(actions)
                else:
                    scene.watching.paint(scene.plan, place, eye, person)
        finally:
            if scene.simulation is not None:
                person.leave(scene.simulation.write_photograph(errand.painting))
