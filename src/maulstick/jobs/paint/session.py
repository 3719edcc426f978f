"""Session: a run from its request to the end of painting, and its estimate."""

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from maulstick.errors import InputError, Remedy, nothing_is_painted
from maulstick.jobs.paint.estimate import Estimate
from maulstick.jobs.paint.journals import check_free, check_not_begun, check_own
from maulstick.jobs.paint.machine_lock import machine_lock
from maulstick.jobs.paint.operator import Operator
from maulstick.jobs.paint.request import PaintRequest
from maulstick.jobs.paint.setup import PaintSetup
from maulstick.jobs.paint.sheet import PaintSheet, actions_left, paint_sheet
from maulstick.jobs.paintable import Paintable, is_svg, read_paintable, strokes_sum
from maulstick.kinds import check_whole
from maulstick.robot.journal import Journal, journal_of, latest_sheet
from maulstick.robot.routine import NOTHING, PaintLoad
from maulstick.robot.stops import UNKNOWN
from maulstick.robot.workplace import at_home
from maulstick.storage.text import counted


def rehearse(request: PaintRequest) -> Estimate:
    """Return the estimate of a run without any motion; asks the machine for its limits.

    Raises what `paint` would before anything moves. Of a run that does not go on it writes nothing, and so does not
    see that another process paints the same.
    """
    if not request.resume:
        setup = PaintSetup.of(request.options, _plan_of(request), request.robot)
        check_not_begun(request.painting, request.options, request.restart)
        with nothing_is_painted():
            return _rehearsed(setup, setup.first(request.from_stroke, request.from_pen), 1, NOTHING)
    with _reopened(request) as (setup, begun, journal):
        sheet = _to_go_on(begun, journal, setup)
        return _rehearsed(setup, () if sheet.journal is None else journal.painted, sheet.number, sheet.load)


def paint(
    request: PaintRequest,
    is_painted: Callable[[int], bool],
    operator_for: Callable[[PaintSetup, Collection[int]], Operator],
) -> None:
    """Paint, or go on painting, until nothing is left or the operator stops it.

    is_painted: returns whether the stroke of this number, which an earlier run left unfinished, is on the paper; it is
    counted from 1 in the order of painting, as the operator saw it.
    operator_for: returns the operator for a setup in which the strokes with these ids are painted already.
    Raises InputError, OutputError and MachineError, as well as StoppedError and KeyboardInterrupt after a stop.
    """
    if not request.resume:
        setup = PaintSetup.of(request.options, _plan_of(request), request.robot)
        with machine_lock(request.options.machine):
            check_not_begun(request.painting, request.options, request.restart)
            check_free(request.painting)  # before the machine is connected
            _paint_sheets(request, setup, PaintSheet(1), operator_for)
        return
    with _reopened(request) as (setup, sheet, journal), machine_lock(setup.options.machine):
        if (stroke := journal.unfinished) is not None:
            (journal.end if is_painted(len(journal.painted) + 1) else journal.again)(stroke)
        _paint_sheets(request, setup, _to_go_on(sheet, journal, setup), operator_for)


def _plan_of(request: PaintRequest) -> Paintable:
    """Return the painting of a request. Raises InputError where it has no strokes, or not the first one named."""
    plan, number = read_paintable(request.painting, request.options.drawing), request.from_stroke
    count = len(plan.painting.strokes)
    if not count:
        raise InputError(f"{request.painting} has no strokes; plan it again with more")
    if number is not None:
        check_whole("from_stroke", number, 1, count, f"1 to the {counted(count, 'stroke')}")
    return plan


@contextmanager
def _reopened(request: PaintRequest) -> Iterator[tuple[PaintSetup, PaintSheet, Journal]]:
    """Open the journal of the latest sheet, with the setup that it says. Raises InputError where there is none."""
    check_own(request.painting)
    number = latest_sheet(request.painting)
    path = journal_of(request.painting, number)
    with Journal.open(path) as journal:
        if journal.revision is None:
            raise InputError(f"the journal {path} is empty, so nothing was begun", Remedy.START)
        drawn = journal.painted - {*journal.revision.painted}
        sheet = PaintSheet(number, journal, UNKNOWN if drawn or number > 1 else NOTHING)
        options, file = request.options.after(journal.options, path.parent), journal.painting()
        plan = read_paintable(file, options.drawing if is_svg(file) else None)
        if options.strokes_sha256 is not None and is_svg(file) and strokes_sum(plan.painting) != options.strokes_sha256:
            changed = "by another Maulstick, or a hand that has changed"
            raise InputError(f"{file} has other strokes than when it was begun, {changed}", Remedy.RESTART)
        said = replace(plan, notes=())  # when it was begun
        yield PaintSetup.of(options, said, request.robot), sheet, journal


def _to_go_on(sheet: PaintSheet, journal: Journal, setup: PaintSetup) -> PaintSheet:
    """Return the sheet, or where all of it is painted and another is wanted, the next one."""
    if len(journal.painted) < len(setup.plan.strokes) or sheet.number >= setup.options.sheets:
        return sheet
    return replace(sheet, number=sheet.number + 1, journal=None)


def _rehearsed(setup: PaintSetup, done: Collection[int], number: int, load: PaintLoad) -> Estimate:
    """Return the estimate of a run in which the strokes `done` of the sheet of that number are painted already."""
    robot, corner = setup.robot, setup.easel.canvas_to_machine(np.zeros(3))
    with machine_lock(setup.options.machine), robot.connected():
        actions = actions_left(setup, done, load)
        home = corner if robot.home is None else np.array([*robot.home, corner[2]])
    estimate = Estimate.of(at_home(actions, robot, home), setup.plan, robot.limits, corner)
    return replace(estimate, more_sheets=max(setup.options.sheets - number, 0), notes=setup.notes)


def _paint_sheets(
    request: PaintRequest,
    setup: PaintSetup,
    sheet: PaintSheet,
    operator_for: Callable[[PaintSetup, Collection[int]], Operator],
) -> None:
    """Paint a sheet and all that follow it; the machine is left between two, with its pen lifted."""
    while sheet.number < setup.options.sheets:
        sheet = paint_sheet(request, setup, sheet, operator_for)
    paint_sheet(request, setup, sheet, operator_for)
