"""Painting of one sheet: what is left of it, the prompts before it, and its end."""

from collections.abc import Callable, Collection
from contextlib import ExitStack, nullcontext
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from maulstick.errors import OutputError, nothing_is_painted
from maulstick.jobs.paint.estimate import Estimate
from maulstick.jobs.paint.journals import new_journal
from maulstick.jobs.paint.operator import Operator
from maulstick.jobs.paint.request import PaintRequest
from maulstick.jobs.paint.setup import PaintSetup
from maulstick.jobs.paintable import is_svg, strokes_sum
from maulstick.robot.execute import PaintProgress
from maulstick.robot.journal import Journal
from maulstick.robot.logbook import Tally
from maulstick.robot.pace import STEP
from maulstick.robot.robot import Robot, StoppedError
from maulstick.robot.room import check_accepted
from maulstick.robot.routine import NOTHING, Action, PaintLoad, Prompt, prompt_for, routine, ways_of
from maulstick.robot.workplace import Workplace, at_home, home_of
from maulstick.storage.arrays import Floats


@dataclass(frozen=True)
class PaintSheet:
    """One of the sheets that a painting is painted on, counted from 1.

    journal: that of an earlier run which began this sheet; None where none did.
    load: the paint that the machine holds.  home: place (3,) of the machine while sheets are changed, None at first.
    pace: per cent of the planned speed.
    """

    number: int
    journal: Journal | None = None
    load: PaintLoad = NOTHING
    home: Floats | None = None
    pace: int = 100


def actions_left(setup: PaintSetup, done: Collection[int], load: PaintLoad) -> list[Action]:
    """Return the actions that are left once the strokes `done` are painted; the machine must be connected.

    Raises InputError where the machine cannot do one of them.
    """
    robot, easel = setup.robot, setup.easel
    actions = routine(setup.plan, easel, robot.limits, setup.tray, speed=setup.options.speed, done=done, load=load)
    actions = setup.stops.put_into(actions, setup.plan, easel, robot.limits, load)
    check_accepted(ways_of(actions), easel, robot)
    return actions


def paint_sheet(
    request: PaintRequest,
    setup: PaintSetup,
    sheet: PaintSheet,
    operator_for: Callable[[PaintSetup, Collection[int]], Operator],
) -> PaintSheet:
    """Paint a sheet with a setup; returns the next one. A new journal is begun once the machine is connected."""
    before, replanning = sheet.journal, setup.replanning
    first = setup.first(request.from_stroke, request.from_pen) if sheet.number == 1 else ()
    done = {*first, *(() if before is None else before.painted)}
    setup.paint_again(done)
    operator = operator_for(setup, done)
    _note(operator, setup, first=sheet.home is None)
    can_go_on = before is not None or sheet.number > 1
    with ExitStack() as stack:
        with nullcontext() if can_go_on else nothing_is_painted():
            with operator.interruptible():
                eye = (
                    None
                    if replanning is None
                    else stack.enter_context(replanning.opened(setup.plan, setup.simulation, before, operator.note))
                )
            stack.enter_context(setup.robot.connected())
            actions = actions_left(setup, done, sheet.load)  # before anything moves
            if operator.stopped:  # entering the machine would forget it, and lift the pen
                raise StoppedError
            robot = stack.enter_context(setup.robot)
        home = home_of(robot, before) if sheet.home is None else sheet.home
        estimate = Estimate.of(at_home(actions, robot, home), setup.plan, robot.limits, robot.place)
        operator.expect(replace(estimate, more_sheets=max(setup.options.sheets - sheet.number, 0)))
        if not actions:
            return PaintSheet(sheet.number + 1, load=sheet.load, home=home)
        if operator.stopped:
            raise StoppedError
        journal = before or stack.enter_context(new_journal(request.painting, sheet.number))
        if before is None:
            if replanning is not None and eye is not None:
                replanning.keep(eye, journal)
            journal.revise(request.painting, first, setup.sha256)
        journal.write_home(home)
        _write_options(journal, setup, request)
        operator.pace.change((sheet.pace - operator.pace.percent) // STEP)
        paint = actions[0].paint
        tally = Tally(setup.plan)
        place = _workplace(setup, robot, journal, operator, tally)
        asked = place.where_it_stands(paint, request.resume) if sheet.home is None else []
        if sheet.number > 1 and not done:
            asked.append(_new_sheet(sheet.number, setup.options.sheets, paint, home))
        if request.asks_for_one_pen and _is_one_pen(setup, sheet):
            asked.append(prompt_for(setup.plan, 0))
        try:
            with operator.on_duty():
                if replanning is None or eye is None:
                    load = place.do([*asked, *actions], sheet.load)
                else:
                    load = place.do(asked, sheet.load) if asked else sheet.load
                    load = replanning.paint(setup.plan, place, eye, operator, load)
                _go_home(place)
                return PaintSheet(sheet.number + 1, load=load, home=home, pace=operator.pace.percent)
        finally:
            if setup.simulation is None:
                _log(tally, setup, request.painting, operator)
            else:
                operator.leave(setup.simulation.write_photograph(request.painting))


def _go_home(place: Workplace) -> None:
    """Move a plotter home, where the next run may begin without anybody who sees where its pen stands."""
    if place.robot.home is not None:
        place.step_aside(home_of(place.robot))


def _is_one_pen(setup: PaintSetup, sheet: PaintSheet) -> bool:
    """Return whether one pen draws all, so that the routine never asks for it, and nobody has put it in yet."""
    return len(setup.plan.paints) == 1 and setup.tray is None and sheet.load.paint is None


def _note(operator: Operator, setup: PaintSetup, first: bool) -> None:
    """Show what is not as the file or the machine says; what is about the file before the first sheet of a run."""
    for note in setup.notes if first else ():
        operator.note(note)
    if setup.simulation is not None and setup.simulation.note is not None:
        operator.note(setup.simulation.note)


def _write_options(journal: Journal, setup: PaintSetup, request: PaintRequest) -> None:
    """Write the options into the journal, and for an SVG the sum of its strokes."""
    options, folder = setup.options, request.painting.parent
    if is_svg(request.painting) and options.strokes_sha256 is None:
        options = options.model_copy(update={"strokes_sha256": strokes_sum(setup.plan)})
    journal.write_options(options.as_json(folder, home=request.home or folder))


def _workplace(setup: PaintSetup, robot: Robot, journal: Journal, operator: Operator, tally: Tally) -> Workplace:
    def watch(progress: PaintProgress) -> None:
        tally.note(progress)
        operator.watch(progress)

    return Workplace(
        robot,
        setup.easel,
        journal,
        partial(_ask, setup, operator),
        watch,
        operator.pause,
        setup.tray,
        setup.options.speed,
        setup.stops,
        operator.pace,
    )


def _log(tally: Tally, setup: PaintSetup, painting: Path, operator: Operator) -> None:
    """Write what was drawn into the logbook; where that fails, the operator is told, since all is painted."""
    try:
        tally.write(setup.options.machine, painting)
    except OutputError as error:
        operator.note(str(error))


def _new_sheet(number: int, sheets: int, paint: int, home: Floats) -> Prompt:
    """Return the prompt for the sheet of that number, with the machine at home, (3,) metres."""
    x, y, z = home.tolist()
    return Prompt(f"put in a new sheet for copy {number} of {sheets}", paint, renews=False, aside=(x, y, z))


def _ask(setup: PaintSetup, operator: Operator, prompt: Prompt) -> None:
    """Ask the operator; a simulation changes and refills its pens by itself, unless it is one that asks."""
    simulation = setup.simulation
    if simulation is None or simulation.asks or not prompt.renews:
        operator.ask(prompt)
    if simulation is not None and prompt.renews:
        simulation.ask(prompt)
