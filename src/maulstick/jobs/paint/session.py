"""Session: a run from its request to the end of painting, and its estimate."""

from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from functools import partial
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
from maulstick.painting.painting import Painting, read_painting
from maulstick.robot.execute import PaintProgress
from maulstick.robot.journal import Journal, journal_of, locked
from maulstick.robot.logbook import Tally
from maulstick.robot.pace import STEP
from maulstick.robot.robot import Robot, StoppedError
from maulstick.robot.routine import NOTHING, PaintLoad, Prompt, routine
from maulstick.robot.stops import UNKNOWN
from maulstick.robot.workplace import Workplace
from maulstick.storage.arrays import Floats


@dataclass(frozen=True)
class PaintRequest:
    """A painting, and how to paint it.

    from_stroke: the first one, counted from 1; those before count as painted.  resume: go on where the journal ends.
    restart: begin again on a new sheet; the journal of the earlier run is kept elsewhere.
    robot: a machine of one's own, instead of the one that the options name.
    from_pen: the first time that a pen is put in, counted from 1; as from_stroke.
    """

    painting: Path
    options: PaintOptions
    from_stroke: int | None = None
    resume: bool = False
    restart: bool = False
    robot: Robot | None = None
    from_pen: int | None = None


@dataclass(frozen=True)
class _Sheet:
    """One of the sheets that a painting is painted on, counted from 1.

    journal: that of an earlier run which began this sheet; None where none did.
    load: the paint that the machine holds.  home: place (3,) where the machine was at first, None before that.
    pace: per cent of the planned speed.
    """

    number: int
    journal: Journal | None = None
    load: PaintLoad = NOTHING
    home: Floats | None = None
    pace: int = 100


def rehearse(request: PaintRequest) -> Estimate:
    """Return the estimate of a run without any motion; asks the machine for its limits. Raises what `paint` would."""
    plan = _plan_of(request)
    if not request.resume:
        setup = PaintSetup.of(request.options, plan, request.robot)
        return _rehearsed(setup, setup.first(request.from_stroke, request.from_pen), 1, NOTHING)
    with _reopened(request) as (setup, sheet, journal):
        return _rehearsed(setup, journal.painted, sheet.number, sheet.load)


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
    plan = _plan_of(request)
    if not request.resume:
        setup = PaintSetup.of(request.options, plan, request.robot)
        with machine_lock(request.options.machine):
            _check_not_begun(request)
            _paint_sheets(request, setup, _Sheet(1), operator_for)
        return
    with _reopened(request) as (setup, sheet, journal), machine_lock(setup.options.machine):
        if (stroke := journal.unfinished) is not None:
            (journal.end if is_painted(stroke) else journal.again)(stroke)
        _paint_sheets(request, setup, sheet, operator_for)


def _plan_of(request: PaintRequest) -> Painting:
    """Return the painting of a request. Raises InputError where it has no strokes, or not the first one named."""
    plan, number = read_painting(request.painting), request.from_stroke
    if not plan.strokes:
        raise InputError(f"{request.painting} has no strokes; plan it again with more")
    if number is not None and not 1 <= number <= len(plan.strokes):
        raise InputError.of_range(option("from_stroke"), number, f"1 to the {len(plan.strokes)} strokes")
    return plan


@contextmanager
def _reopened(request: PaintRequest) -> Iterator[tuple[PaintSetup, _Sheet, Journal]]:
    """Open the journal of the latest sheet, with the setup that it says. Raises InputError where there is none."""
    path = journal_of(request.painting)
    if not path.exists():
        raise InputError(f"there is no journal {path}, so nothing was begun", Remedy.START)
    number = next(number for number in count(1) if not _was_begun(journal_of(request.painting, number + 1)))
    path = journal_of(request.painting, number)
    with Journal.open(path) as journal:
        if journal.revision is None:
            raise InputError(f"the journal {path} is empty, so nothing was begun", Remedy.START)
        drawn = journal.painted - {*journal.revision.painted}
        sheet = _Sheet(number, journal, UNKNOWN if drawn or number > 1 else NOTHING)
        options = request.options.after(journal.options)
        yield PaintSetup.of(options, read_painting(journal.painting()), request.robot), sheet, journal


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
def _new_journal(painting: Path, sheet: int) -> Iterator[Journal]:
    """Open an empty journal of a sheet; those of an earlier run are moved away."""
    path = journal_of(painting, sheet)
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
            beside = (*(escape(stem) + end for end in (".r[0-9]*.*", ".copy[0-9]*.log.jsonl", ".eye.npz")), path.name)
            for old in [found for name in beside for found in path.parent.glob(name)]:
                old.rename(kept / old.name)
        except OSError as error:
            raise OutputError(f"cannot move {path} to {kept}: {error.strerror}; do, and run again") from error


def _rehearsed(setup: PaintSetup, done: Collection[int], number: int, load: PaintLoad) -> Estimate:
    """Return the estimate of a run in which the strokes `done` of the sheet of that number are painted already."""
    stops = setup.stops
    with machine_lock(setup.options.machine):
        setup.robot.ask_limits()
    limits, easel = setup.robot.limits, setup.easel
    actions = routine(setup.plan, easel, limits, setup.tray, speed=setup.options.speed, done=done, load=load)
    actions = stops.put_into(actions, setup.plan, easel, limits, load)
    estimate = Estimate.of(actions, setup.plan, limits, easel.canvas_to_machine(np.zeros(3)))
    return replace(estimate, more_sheets=max(setup.options.sheets - number, 0))


def _paint_sheets(
    request: PaintRequest,
    setup: PaintSetup,
    sheet: _Sheet,
    operator_for: Callable[[PaintSetup, Collection[int]], Operator],
) -> None:
    """Paint a sheet and all that follow it; the machine is left between two, with its pen lifted."""
    while sheet.number < setup.options.sheets:
        sheet = _paint(request, setup, sheet, operator_for)
    _paint(request, setup, sheet, operator_for)


def _paint(
    request: PaintRequest,
    setup: PaintSetup,
    sheet: _Sheet,
    operator_for: Callable[[PaintSetup, Collection[int]], Operator],
) -> _Sheet:
    """Paint a sheet with a setup; returns the next one. A new journal is begun once the machine is connected."""
    before, stops = sheet.journal, setup.stops
    first = setup.first(request.from_stroke, request.from_pen) if sheet.number == 1 else ()
    done = {*first, *(() if before is None else before.painted)}
    setup.paint_again(done)
    operator = operator_for(setup, done)
    for note in (setup.note, setup.simulation.note if setup.simulation is not None else None):
        if note:
            operator.note(note)
    with ExitStack() as stack:
        with operator.interruptible():
            eye = (
                None
                if setup.replanning is None
                else stack.enter_context(setup.replanning.opened(setup.plan, setup.simulation, before))
            )
        robot = stack.enter_context(setup.robot)
        home = robot.place if sheet.home is None else sheet.home
        speed = setup.options.speed
        actions = routine(setup.plan, setup.easel, robot.limits, setup.tray, speed=speed, done=done, load=sheet.load)
        actions = stops.put_into(actions, setup.plan, setup.easel, robot.limits, sheet.load)
        operator.expect(Estimate.of(actions, setup.plan, robot.limits, robot.place))
        if not actions:
            return _Sheet(sheet.number + 1, load=sheet.load, home=home)
        if operator.stopped:
            raise StoppedError
        journal = before or stack.enter_context(_new_journal(request.painting, sheet.number))
        if before is None:
            if setup.replanning is not None and eye is not None:
                setup.replanning.keep(eye, journal)
            journal.revise(request.painting, painted=first)
        journal.write_options(setup.options.as_json())
        operator.pace.change((sheet.pace - operator.pace.percent) // STEP)
        if sheet.number > 1 and not done:
            actions = [_new_sheet(sheet.number, setup.options.sheets, actions[0].paint, home), *actions]
        tally = Tally(setup.plan)

        def watch(progress: PaintProgress) -> None:
            tally.note(progress)
            operator.watch(progress)

        place = Workplace(
            robot,
            setup.easel,
            journal,
            partial(_ask, setup, operator),
            watch,
            operator.pause,
            setup.tray,
            speed,
            stops,
            operator.pace,
        )
        try:
            with operator.on_duty():
                if setup.replanning is None or eye is None:
                    load = place.do(actions, sheet.load)
                    return _Sheet(sheet.number + 1, load=load, home=home, pace=operator.pace.percent)
                setup.replanning.paint(setup.plan, place, eye, operator)
                return _Sheet(sheet.number + 1, home=home)
        finally:
            if setup.simulation is None:
                _log(tally, setup, request.painting, operator)
            else:
                operator.leave(setup.simulation.write_photograph(request.painting))


def _log(tally: Tally, setup: PaintSetup, painting: Path, operator: Operator) -> None:
    """Write what was drawn into the logbook; where that fails, the operator is told, since all is painted."""
    try:
        tally.write(setup.options.machine, painting)
    except OutputError as error:
        operator.note(str(error))


def _new_sheet(number: int, sheets: int, paint: int, home: Floats) -> Prompt:
    """Return the prompt for the sheet of that number, with the machine where it was at first, (3,) metres."""
    x, y, z = home.tolist()
    return Prompt(f"put in a new sheet for copy {number} of {sheets}", paint, renews=False, aside=(x, y, z))


def _ask(setup: PaintSetup, operator: Operator, prompt: Prompt) -> None:
    """Ask the operator; a simulation changes and refills its pens by itself."""
    if setup.simulation is None or not prompt.renews:
        operator.ask(prompt)
    else:
        setup.simulation.ask(prompt)
