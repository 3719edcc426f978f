"""Session: a run from its request to the end of painting, and its estimate."""

from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from glob import escape
from itertools import count
from pathlib import Path

import numpy as np

from maulstick.errors import InputError, OutputError, Remedy, option
from maulstick.jobs.paint.estimate import Estimate
from maulstick.jobs.paint.machine_lock import machine_lock
from maulstick.jobs.paint.operator import Operator
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.setup import PaintSetup
from maulstick.jobs.paintable import Paintable, is_svg, read_paintable, strokes_sum
from maulstick.robot.easel import Easel
from maulstick.robot.journal import Journal, journal_of, locked
from maulstick.robot.robot import Robot, StoppedError
from maulstick.robot.room import check_accepted
from maulstick.robot.routine import Action, Prompt, routine, ways_of
from maulstick.robot.workplace import Workplace


@dataclass(frozen=True)
class PaintRequest:
    """A painting.json or an SVG, and how to paint it.

    from_stroke: the first one, counted from 1; those before count as painted.  resume: go on where the journal ends.
    restart: begin again on a new sheet; the journal of the earlier run is kept elsewhere.
    robot: a machine of one's own, instead of the one that the options name.
    """

    painting: Path
    options: PaintOptions
    from_stroke: int | None = None
    resume: bool = False
    restart: bool = False
    robot: Robot | None = None


def rehearse(request: PaintRequest) -> Estimate:
    """Return the estimate of a run without any motion; asks the machine for its limits. Raises what `paint` would."""
    if not request.resume:
        setup = PaintSetup.of(request.options, _plan_of(request), request.robot)
        return _rehearsed(setup, setup.first(request.from_stroke))
    with _reopened(request) as (setup, journal):
        return _rehearsed(setup, journal.painted)


def paint(
    request: PaintRequest,
    is_painted: Callable[[int], bool],
    operator_for: Callable[[PaintSetup, Collection[int]], Operator],
) -> None:
    """Paint, or go on painting, until nothing is left or the operator stops it.

    is_painted: returns whether the stroke with this id, which an earlier run left unfinished, is on the paper.
    operator_for: returns the operator for a setup in which the strokes with these ids are painted already.
    Raises InputError, OutputError and MachineError, as well as StoppedError and KeyboardInterrupt after a stop.
    """
    if not request.resume:
        setup = PaintSetup.of(request.options, _plan_of(request), request.robot)
        with machine_lock(request.options.machine):
            _check_not_begun(request)
            _paint(request, setup, None, operator_for)
        return
    with _reopened(request) as (setup, journal), machine_lock(setup.options.machine):
        if (stroke := journal.unfinished) is not None:
            (journal.end if is_painted(stroke) else journal.again)(stroke)
        _paint(request, setup, journal, operator_for)


def _plan_of(request: PaintRequest) -> Paintable:
    """Return the painting of a request. Raises InputError where it has no strokes, or not the first one named."""
    plan, number = read_paintable(request.painting, request.options.drawing), request.from_stroke
    count = len(plan.painting.strokes)
    if not count:
        raise InputError(f"{request.painting} has no strokes; plan it again with more")
    if number is not None and not 1 <= number <= count:
        raise InputError.of_range(option("from_stroke"), number, f"1 to the {count} strokes")
    return plan


@contextmanager
def _reopened(request: PaintRequest) -> Iterator[tuple[PaintSetup, Journal]]:
    """Open the journal of an earlier run, with the setup that it says. Raises InputError where there is none."""
    path = journal_of(request.painting)
    if not path.exists():
        raise InputError(f"there is no journal {path}, so nothing was begun", Remedy.START)
    with Journal.open(path) as journal:
        if journal.revision is None:
            raise InputError(f"the journal {path} is empty, so nothing was begun", Remedy.START)
        options, file = request.options.after(journal.options), journal.painting()
        plan = read_paintable(file, options.drawing if is_svg(file) else None)
        if options.strokes_sha256 is not None and is_svg(file) and strokes_sum(plan.painting) != options.strokes_sha256:
            changed = "by another Maulstick, or a hand that has changed"
            raise InputError(f"{file} has other strokes than when it was begun, {changed}", Remedy.RESTART)
        yield PaintSetup.of(options, plan, request.robot), journal


def _was_begun(path: Path) -> bool:
    return path.exists() and path.stat().st_size > 0


def _check_not_begun(request: PaintRequest) -> None:
    """Raise InputError where the painting was begun and is not to be restarted, or is being painted."""
    path = journal_of(request.painting)
    if _was_begun(path) and not request.restart:
        raise InputError(f"{path} says that this painting was begun", Remedy.RESUME_OR_RESTART)
    with locked(path):  # raises before the machine is connected
        return


@contextmanager
def _new_journal(painting: Path) -> Iterator[Journal]:
    """Open an empty journal; that of an earlier run is moved away."""
    path = journal_of(painting)
    if _was_begun(path):
        _make_room(path, painting.stem)
    with Journal.open(path) as journal:
        yield journal


def _make_room(path: Path, stem: str) -> None:
    """Move the journal and the files beside it into a folder of their own, to make room for a new journal."""
    kept = next(folder for i in count(1) if not (folder := path.with_name(f"{stem}.run{i}")).exists())
    with locked(path):
        try:
            kept.mkdir()
            beside = (f"{escape(stem)}.r[0-9]*.*", f"{escape(stem)}.eye.npz", path.name)
            for old in [found for name in beside for found in path.parent.glob(name)]:
                old.rename(kept / old.name)
        except OSError as error:
            raise OutputError(f"cannot move {path} to {kept}: {error.strerror}; do, and run again") from error


def _rehearsed(setup: PaintSetup, done: Collection[int]) -> Estimate:
    """Return the estimate of a run in which the strokes `done` are painted already."""
    with machine_lock(setup.options.machine), setup.robot.connected():
        actions = _actions(setup, done)
    start = setup.easel.canvas_to_machine(np.zeros(3))
    return replace(Estimate.of(actions, setup.plan, setup.robot.limits, start), notes=setup.notes)


def _where_it_stands(easel: Easel, robot: Robot) -> str:
    """Return the prompt of a machine that may have lost count of its steps since the run that is resumed."""
    x, y, _ = easel.machine_to_canvas(robot.place).tolist()
    return (
        f"see that the pen stands {1e3 * x:.0f} mm from the left and {1e3 * y:.0f} mm from the upper edge of the sheet "
        "(elsewhere: stop, switch the machine off and on with its pen at home, and resume)"
    )


def _actions(setup: PaintSetup, done: Collection[int]) -> list[Action]:
    """Return the actions that are left; raises InputError where the machine, which must be connected, cannot do one."""
    robot, speed = setup.robot, setup.options.speed
    actions = routine(setup.plan, setup.easel, robot.limits, setup.tray, speed=speed, done=done)
    check_accepted(ways_of(actions), setup.easel, robot)
    return actions


def _paint(
    request: PaintRequest,
    setup: PaintSetup,
    before: Journal | None,
    operator_for: Callable[[PaintSetup, Collection[int]], Operator],
) -> None:
    """Paint with a setup.

    before: the journal of the run that is resumed; None begins a new one once the machine is connected.
    """
    first = setup.first(request.from_stroke)
    done = {*first, *(() if before is None else before.painted)}
    setup.paint_again(done)
    operator = operator_for(setup, done)
    for sentence in setup.notes if before is None else ():
        operator.note(sentence)
    if setup.simulation is not None and (note := setup.simulation.note) is not None:
        operator.note(note)
    with ExitStack() as stack:
        with operator.interruptible():
            eye = (
                None
                if setup.replanning is None
                else stack.enter_context(setup.replanning.opened(setup.plan, setup.simulation, before))
            )
        stack.enter_context(setup.robot.connected())
        actions = _actions(setup, done)  # before anything moves
        if operator.stopped:  # entering the machine would forget it, and lift the pen
            raise StoppedError
        robot = stack.enter_context(setup.robot)
        if before is not None and robot.counts_steps and actions:
            actions.insert(0, Prompt(_where_it_stands(setup.easel, robot), actions[0].paint))
        operator.expect(Estimate.of(actions, setup.plan, robot.limits, robot.place))
        if not actions:
            return
        if operator.stopped:
            raise StoppedError
        journal = before or stack.enter_context(_new_journal(request.painting))
        if before is None:
            if setup.replanning is not None and eye is not None:
                setup.replanning.keep(eye, journal)
            journal.revise(request.painting, painted=first)
        options = setup.options
        if before is None and is_svg(request.painting):
            options = options.model_copy(update={"strokes_sha256": strokes_sum(setup.plan)})
        journal.write_options(options.as_json())
        ask = operator.ask if setup.simulation is None else setup.simulation.ask
        place = Workplace(
            robot, setup.easel, journal, ask, operator.watch, operator.pause, setup.tray, setup.options.speed
        )
        try:
            with operator.on_duty():
                if setup.replanning is None or eye is None:
                    place.do(actions)
                else:
                    setup.replanning.paint(setup.plan, place, eye, operator)
        finally:
            if setup.simulation is not None:
                operator.leave(setup.simulation.write_photograph(request.painting))
