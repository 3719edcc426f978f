"""Setup of a run: the plan in order, the machine, the easel, the tray, and replanning."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from maulstick.errors import InputError, option
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.replanning import Replanning
from maulstick.jobs.paint.simulation import Simulation
from maulstick.jobs.paintable import Paintable
from maulstick.kinds import check_whole
from maulstick.ordering.sequence import sequenced
from maulstick.painting.brush import Brush, load_pen_brush
from maulstick.painting.painting import Painting
from maulstick.robot.easel import Easel, read_easel
from maulstick.robot.machines import machine
from maulstick.robot.robot import Robot
from maulstick.robot.stops import Stops
from maulstick.robot.tray import Tray, read_tray
from maulstick.storage.text import counted

_SAME_WIDTH = 0.05  # of a width: nobody sees less


@dataclass(frozen=True)
class PaintSetup:
    """All that a run needs, read and checked; nothing is connected.

    sha256: of the plan's file, as it was read.
    simulation: None where the machine is a real one.  replanning: None where the sheet is not looked at on the way.
    notes: sentences about what is not drawn as its file says, or with another pen than planned.
    """

    options: PaintOptions
    plan: Painting
    sha256: str
    robot: Robot
    easel: Easel
    tray: Tray | None
    simulation: Simulation | None
    replanning: Replanning | None
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, options: PaintOptions, paintable: Paintable, robot: Robot | None = None) -> "PaintSetup":
        """Return the setup that the options name. Raises InputError where something of it cannot be used."""
        options.check_together()
        if paintable.painting.literal and (options.replan or options.look):
            raise InputError(
                f"a drawing is not planned, so it is not planned again either; leave out {option('replan')}"
            )
        plan, replanning = paintable.painting, Replanning.of(options)
        if replanning is not None:
            replanning.check(plan)
        easel = read_easel(options.easel) if options.easel is not None else None
        tray = read_tray(options.tray) if options.tray is not None else None
        plan, note = (plan, "") if options.pen is None else _with_pen(plan, options.pen)
        plan = sequenced(plan, (0.0, 0.0))  # not from where the pen is: --from-stroke counts in an order that stays
        simulation = Simulation.of(options.machine, plan, easel, tray) if options.simulated else None
        if robot is None:
            robot = machine(options.machine, easel) if simulation is None else simulation.robot
        easel = easel or robot.easel(plan.sheet.width, plan.sheet.height)
        notes = (*paintable.notes, *([note] if note else []))
        return cls(options, plan, paintable.sha256, robot, easel, tray, simulation, replanning, notes)

    def first(self, from_stroke: int | None, from_pen: int | None = None) -> tuple[int, ...]:
        """Return the ids of the strokes before that one, or before that time a pen is put in, counted from 1.

        Raises InputError where so many pens are never put in.
        """
        strokes = self.plan.strokes
        if from_pen is not None:
            starts = [i for i, stroke in enumerate(strokes) if i == 0 or stroke.paint != strokes[i - 1].paint]
            check_whole("from_pen", from_pen, 1, len(starts), f"1 to {len(starts)}, the times that a pen is put in")
            return tuple(stroke.id for stroke in strokes[: starts[from_pen - 1]])
        return () if from_stroke is None else tuple(stroke.id for stroke in strokes[: from_stroke - 1])

    @property
    def stops(self) -> Stops:
        """The stops that the options ask for. Raises InputError where one is before a stroke that there is not."""
        asked, strokes = self.options, self.plan.strokes
        numbers = asked.pause_at or ()
        if wrong := [number for number in numbers if not 1 <= number <= len(strokes)]:
            raise InputError.of_range(option("pause_at"), wrong[0], f"1 to the {counted(len(strokes), 'stroke')}")
        pauses = {strokes[number - 1].id: number for number in numbers}
        return Stops(pauses, asked.refill_metres, asked.refill_seconds, asked.refill_at)

    def paint_again(self, done: Collection[int]) -> None:
        """Paint the strokes that are done onto a simulated sheet, which then looks as an earlier run left it."""
        if self.simulation is not None:
            self.simulation.paint_again(self.easel, done)


def _with_pen(plan: Painting, name: str) -> tuple[Painting, str]:
    """Return the painting as a pen of that name draws it, and a sentence where its lines have another width, or "".

    Raises InputError where there is no such pen.
    """
    pen, _ = load_pen_brush(name)
    paints = tuple(paint.model_copy(update={"brush": pen.name}) for paint in plan.paints)
    others = [b for b in plan.brushes.values() if b.pressure_matters or abs(b.widest / pen.widest - 1) > _SAME_WIDTH]
    return plan.model_copy(update={"brushes": {pen.name: pen}, "paints": paints}), _width_note(plan, others, pen, name)


def _width_note(plan: Painting, others: Sequence[Brush], pen: Brush, name: str) -> str:
    """Return a sentence about the brushes of a painting whose width is not that of the pen of this name, or ""."""
    if not others:
        return ""
    wider = f"{others[0].widest / pen.widest:.2g} times"
    if plan.literal:
        return f"the lines of the drawing are {wider} as wide as those of {name}, and are drawn as wide as it draws"
    width = "varies" if others[0].pressure_matters else f"is {wider} that of {name}"
    return f"it was planned for the brush {others[0].name}, whose width {width}; plan it for {name} to have it so"
