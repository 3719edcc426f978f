"""Setup of a run: the plan in order, the machine, the easel, the tray, and replanning."""

from collections.abc import Collection
from dataclasses import dataclass

from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.replanning import Replanning
from maulstick.jobs.paint.simulation import Simulation
from maulstick.jobs.paintable import Paintable
from maulstick.ordering.sequence import sequenced
from maulstick.painting.painting import Painting
from maulstick.robot.easel import Easel, read_easel
from maulstick.robot.machines import machine
from maulstick.robot.robot import Robot
from maulstick.robot.tray import Tray, read_tray


@dataclass(frozen=True)
class PaintSetup:
    """All that a run needs, read and checked; nothing is connected.

    simulation: None where the machine is a real one.  replanning: None where the sheet is not looked at on the way.
    notes: sentences about what of a drawing's file is not drawn as it says.
    """

    options: PaintOptions
    plan: Painting
    robot: Robot
    easel: Easel
    tray: Tray | None
    simulation: Simulation | None
    replanning: Replanning | None
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, options: PaintOptions, paintable: Paintable, robot: Robot | None = None) -> "PaintSetup":
        """Return the setup that the options name. Raises InputError where something of it cannot be used."""
        plan, replanning = paintable.painting, Replanning.of(options)
        if replanning is not None:
            replanning.check(plan)
        easel = read_easel(options.easel) if options.easel is not None else None
        tray = read_tray(options.tray) if options.tray is not None else None
        plan = sequenced(plan, (0.0, 0.0))  # not from where the pen is: --from-stroke counts in an order that stays
        simulation = Simulation.of(options.machine, plan, easel, tray) if options.simulated else None
        if robot is None:
            robot = machine(options.machine, easel) if simulation is None else simulation.robot
        easel = easel or robot.easel(plan.sheet.width, plan.sheet.height)
        return cls(options, plan, robot, easel, tray, simulation, replanning, paintable.notes)

    def first(self, from_stroke: int | None) -> tuple[int, ...]:
        """Return the ids of the strokes before that one, counted from 1."""
        return () if from_stroke is None else tuple(stroke.id for stroke in self.plan.strokes[: from_stroke - 1])

    def paint_again(self, done: Collection[int]) -> None:
        """Paint the strokes that are done onto a simulated sheet, which then looks as an earlier run left it."""
        if self.simulation is not None:
            self.simulation.paint_again(self.easel, done)
