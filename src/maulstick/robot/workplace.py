"""The workplace: the machine, the sheet before it, the journal of the painting and the operator."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from maulstick.errors import Remedy
from maulstick.ordering.sequence import sequenced
from maulstick.painting.painting import Painting
from maulstick.robot.duration import timed
from maulstick.robot.easel import Easel
from maulstick.robot.execute import PaintProgress, Pause, execute
from maulstick.robot.journal import Journal
from maulstick.robot.pace import Pace
from maulstick.robot.robot import Robot
from maulstick.robot.routine import NOTHING, Action, PaintLoad, Prompt, routine
from maulstick.robot.stops import Stops
from maulstick.robot.tray import Tray, Well
from maulstick.storage.arrays import Floats

_AT_HOME = 1e-4  # metres: covers rounding to steps or decimals


def _ignore(progress: PaintProgress) -> None:
    """Do nothing with the progress."""


@dataclass(frozen=True)
class Workplace:
    """Machine, sheet and operator, with which a painting can be painted.

    ask, watch, pause, pace: as in `execute`.  tray: None for tools that are not dipped.
    speed: highest speed, metres per second, as in `routine`.  stops: pauses and refills.
    """

    robot: Robot
    easel: Easel
    journal: Journal
    ask: Callable[[Prompt], None]
    watch: Callable[[PaintProgress], None] = _ignore
    pause: Pause = field(default_factory=Pause)
    tray: Tray | None = None
    speed: float | None = None
    stops: Stops = field(default_factory=Stops)
    pace: Pace | None = None

    def left_of(self, painting: Painting, load: PaintLoad = NOTHING) -> list[Action]:
        """Return the actions of a painting that are still to be done; raises InputError as `routine` does."""
        limits, painted = self.robot.limits, self.journal.painted
        actions = routine(painting, self.easel, limits, self.tray, speed=self.speed, done=painted, load=load)
        return self.stops.put_into(actions, painting, self.easel, limits, load)

    def in_order(self, painting: Painting) -> Painting:
        """Return the painting with the strokes that are left in a quick order from where the tip is."""
        painted = tuple(stroke for stroke in painting.strokes if stroke.id in self.journal.painted)
        left = tuple(stroke for stroke in painting.strokes if stroke.id not in self.journal.painted)
        x, y, _ = self.easel.machine_to_canvas(self.robot.place).tolist()
        ordered = sequenced(painting.model_copy(update={"strokes": left}), (x, y))
        return painting.model_copy(update={"strokes": (*painted, *ordered.strokes)})

    def where_it_stands(self, paint: int, goes_on: bool) -> list[Action]:
        """Return the prompt of a machine that may have lost count of its steps since its last run; none for others.

        goes_on: whether a run goes on. One that begins at home needs no prompt: there its pen is put beforehand.
        """
        robot = self.robot
        if not (is_away(robot) or (goes_on and robot.counts_steps)):
            return []
        x, y, z = self.easel.machine_to_canvas(robot.place).tolist()
        stands = f"{1e3 * x:.0f} mm from the left and {1e3 * y:.0f} mm from the upper edge of the sheet"
        if robot.limits.varies_pressure:  # it counts its height, too
            stands += f", and {1e3 * z:.0f} mm above it"
        remedy = Remedy.FIND_HOME if robot.home is None else Remedy.PUT_HOME  # no home: it finds that by switches
        return [Prompt(f"see that the pen stands {stands}", paint, renews=False, elsewhere=remedy)]

    def do(
        self, actions: list[Action], load: PaintLoad = NOTHING, enough: Callable[[int], bool] = lambda painted: False
    ) -> PaintLoad:
        """Carry out the actions until `enough`; returns the load at the end, and raises as `execute` does.

        Prompts for a tool say how long it then draws.
        """
        # As this run began: before the first stroke of a further copy the tip stands over the sheet before it.
        home = home_of(self.robot) if self.journal.home is None else self.journal.home
        actions = timed(at_home(actions, self.robot, home), self.robot.limits, self.robot.place)
        return execute(actions, self.robot, self.journal, self.ask, self.watch, self.pause, load, enough, self.pace)

    def moved_to(self, easel: Easel) -> "Workplace":
        """Return the workplace with its sheet on another easel; the tray stays where it stands."""
        if self.tray is None:
            return replace(self, easel=easel)
        paints = {name: _seen_from(easel, well, self.easel) for name, well in self.tray.paints.items()}
        water, cloth = (_seen_from(easel, well, self.easel) for well in (self.tray.water, self.tray.cloth))
        tray = self.tray.model_copy(update={"paints": paints, "water": water, "cloth": cloth})
        return replace(self, easel=easel, tray=tray)

    def step_aside(self, home: Floats) -> None:
        """Move the lifted tip over `home` (3,), metres in the machine's frame, so that a camera sees the sheet."""
        lower, upper = self.robot.limits.lower, self.robot.limits.upper
        over = self.easel.travel if self.tray is None else self.tray.clearance
        surface = self.easel.machine_to_canvas(self.robot.place) * (1, 1, 0) + (0, 0, over)
        heights = home[2], self.robot.place[2], self.easel.canvas_to_machine(surface)[2]
        height = float(np.clip(max(heights), lower[2], upper[2]))
        self.robot.lift(height)
        self.robot.move(np.clip([home[0], home[1], height], lower, upper))


def at_home(actions: Sequence[Action], robot: Robot, home: Floats) -> list[Action]:
    """Return the actions; a plotter's pen is changed or refilled at `home` (3,), unless another place is asked for."""
    if not robot.counts_steps:
        return list(actions)
    x, y, z = home.tolist()
    return [
        replace(action, aside=(x, y, z))
        if isinstance(action, Prompt) and action.renews and action.aside is None
        else action
        for action in actions
    ]


def is_away(robot: Robot) -> bool:
    """Return whether a machine that is switched on at home counts its pen elsewhere: it may have been pushed since."""
    return robot.home is not None and bool(np.abs(robot.place[:2] - robot.home).max() > _AT_HOME)


def home_of(robot: Robot, journal: Journal | None = None) -> Floats:
    """Return the place (3,) of a machine's tip while a sheet is put in or photographed.

    It is the machine's home; for one without, where it stood when the first stroke was begun, as the journal says, or
    else where it stands now. Where narrower limits leave that out, it is the nearest place within them.
    """
    home = robot.place
    if robot.home is not None:
        home[:2] = robot.home
    elif journal is not None and journal.begun and journal.home is not None:
        home = journal.home
    return home.clip(robot.limits.lower, robot.limits.upper)


def _seen_from(easel: Easel, well: Well, before: Easel) -> Well:
    """Return a well that stays where it stands, in the canvas frame of another easel than `before`."""
    place = before.canvas_to_machine(np.array([well.x, well.y, well.height]))
    x, y, height = easel.machine_to_canvas(place).tolist()
    return well.model_copy(update={"x": x, "y": y, "height": height})
