"""Setting up a machine by hand: moves step by step, the sheet's outline, a test square, the pen's height, an origin."""

from typing import Final, Literal, final

import numpy as np

from maulstick.errors import InputError, option
from maulstick.robot.easel import Easel, Pen
from maulstick.robot.plotter import HasServo, KeepsOrigin, LetsGo
from maulstick.robot.robot import Robot
from maulstick.storage.arrays import Floats

SQUARE: Final = 0.02
"""Side of the test square, metres: small enough for any sheet, large enough to be measured with a ruler."""

_SLOW = 0.02  # metres per second: any pen draws well at this
_ANY_SHEET = 0.01  # metres: sides of a sheet that fits every machine, where its size is not known
_TURNS: Final = ((1, -1), (1, 1), (-1, -1), (-1, 1))  # directions right and down in which a square may fit


@final
class Bench:
    """Machine and the sheet before it, for a person who sets them up; the machine is entered before anything is done.

    Every motion goes through `Robot`, so none leaves its limits: it raises InputError, and nothing moves.
    easel: where the sheet lies; None takes the machine's usual place.  size: width and height of the sheet, metres.
    changed: whether `easel` is no longer what it was at the beginning.  may_be_written: whether it is a sheet's.
    Raises InputError where the machine has no usual place, so that an easel is needed.
    """

    def __init__(self, robot: Robot, easel: Easel | None, size: tuple[float, float] | None) -> None:
        self.robot, self.size = robot, size
        self.may_be_written = easel is not None or size is not None
        self.easel = easel or robot.easel(*(size or (_ANY_SHEET, _ANY_SHEET)))
        self.changed = False
        self._home = np.array(easel.corner if easel is not None else (0.0, 0.0, 0.0))
        pen = None if self.servo is None else self.servo.pen
        self._upwards = -1 if pen is not None and pen.up < pen.down else 1

    @property
    def servo(self) -> HasServo | None:
        """The machine, where a servo lifts its pen; None where its height does."""
        return self.robot if isinstance(self.robot, HasServo) and self.robot.pen is not None else None

    def jog(self, axis: int, metres: float) -> None:
        """Move along x, y or z (0, 1 or 2); a tip that has come down is not lifted: it may touch the paper."""
        if axis == 2 and not self.robot.limits.varies_pressure:
            raise InputError("a servo lifts this pen, which has no height; lift or lower it, or set its servo")
        step = np.zeros(3)
        step[axis] = metres
        self.robot.jog(self.robot.place + step)

    def lift(self) -> None:
        """Lift the pen to the height of travel, or to the one that it was jogged down from if that is higher."""
        if not self.robot.lifted:
            height = max(self._above(self.robot.place)[2], self.robot.clear)
            self.robot.lift(min(height, self.robot.limits.upper[2]))

    def lower(self) -> None:
        """Lower the pen onto the paper where it is; the pen stays there until `lift`."""
        x, y, _ = self.easel.machine_to_canvas(self.robot.place).tolist()
        path = self.easel.canvas_to_machine(np.array([[x, y, -self._depth]]))
        self.robot.limits.check_path(path)
        self._go(path[0])
        self.robot.stroke(path, self._speed(1))

    def go_home(self) -> None:
        """Move to the corner at the origin, or that of the easel's file, at the height of travel."""
        self._go(self._home)

    def outline(self) -> None:
        """Go around the sheet with the pen lifted, and return to where it began, as near as the limits let it."""
        if self.size is None:
            raise InputError(f"the sheet's size is not known; name it with {option('size')}")
        width, height = self.size
        corners = np.array([(0, 0, 0), (width, 0, 0), (width, height, 0), (0, height, 0), (0, 0, 0)])
        start = self.robot.place.clip(self.robot.limits.lower, self.robot.limits.upper)
        places = np.array([self._above(place) for place in self.easel.canvas_to_machine(corners)])
        self.robot.limits.check_path(places)
        self._go(places[0])
        for place in places[1:]:
            self.robot.move(place)
        self._go(start)

    def square(self) -> None:
        """Draw a square of 20 mm whose first corner is where the tip is, to a side where there is room; then lift."""
        x, y, _ = self.easel.machine_to_canvas(self.robot.place).tolist()
        path = self._square_at(x, y)
        self._go(path[0])
        self.robot.stroke(path, self._speed(len(path)))
        self.lift()

    def set_servo(self, steps: int, share: float) -> Pen:
        """Raise (above 0) or lower the pen's servo by steps of a share of its range, for the way the pen is now.

        It stays within that range. Returns the new positions. Raises InputError where none lifts the pen, or would.
        """
        if (servo := self.servo) is None or (pen := servo.pen) is None:
            raise InputError("no servo lifts this pen; move it to the paper, and make that the paper's height")
        lowest, highest = servo.servo_range
        change = self._upwards * steps * share * (highest - lowest)
        name = "up" if self.robot.lifted else "down"
        moved = pen.model_copy(update={name: float(np.clip(getattr(pen, name) + change, lowest, highest))})
        if moved.up == moved.down:
            raise InputError("up and down would be the same, so that the pen is never lifted; take another step")
        servo.set_pen(moved)
        self.easel = self.easel.model_copy(update={"pen": moved})
        self.changed = True
        return moved

    def set_origin(self, what: Literal["corner", "paper"]) -> str:
        """Make this place the sheet's corner, or its height the paper's; returns a sentence about what that means.

        A machine that keeps no origin of its own gets another easel, which has to be written.
        """
        if self.robot.drawing:
            raise InputError("the pen is down; lift it before the origin is set")
        if what == "paper" and not self.robot.limits.varies_pressure:
            raise InputError("a servo lifts this pen, and the paper's height does not matter")
        if isinstance(self.robot, KeepsOrigin):
            self.robot.set_origin(what)
            if what == "paper":
                self._go(self.robot.place)
            where = "at this height: the paper's" if what == "paper" else "here: the sheet's lower left corner"
            return f"the machine's work origin is {where}; it keeps that"
        place, corner = self.robot.place, np.array(self.easel.corner)
        moved = np.array([*place[:2], corner[2]] if what == "corner" else [*corner[:2], place[2]])
        self.easel = self.easel.model_copy(update={"corner": tuple(moved.tolist())})
        self._home, self.changed = moved, True
        where = "height is this one" if what == "paper" else "upper left corner is here"
        return f"the sheet's {where}, once the easel is written and given to painting"

    def let_go(self) -> None:
        """Switch the motors off; the machine has to be entered again."""
        if not isinstance(self.robot, LetsGo):
            raise InputError("the motors of this machine cannot be switched off from here; move it step by step")
        self.robot.let_go()

    @property
    def _depth(self) -> float:
        """Metres below first touch at which the pen draws here: half of what the easel allows."""
        return self.easel.deepest / 2 if self.robot.limits.varies_pressure else 0.0

    def _speed(self, points: int) -> Floats:
        return np.full(points, min(_SLOW, self.robot.limits.speed))

    def _above(self, place: Floats) -> Floats:
        """Return the place (3,) at the height of travel, straight above or below a place (3,), metres."""
        height = self.easel.machine_to_canvas(place)[2]
        return np.array([*place[:2], place[2] + (self.easel.travel - height) / self.easel.up[2]])

    def _go(self, place: Floats) -> None:
        """Lift to the height of travel if the tip is lower, and move above a place (3,), metres."""
        here, there = self._above(self.robot.place), self._above(place)
        highest = max(here[2], there[2], self.robot.clear)
        path = np.array([[*here[:2], highest], [*there[:2], highest], there])
        beside = not self.robot.limits.holds(self.robot.place[None])  # put there, or at home beside narrower limits
        path = path[1:] if beside else path
        self.robot.limits.check_path(path)
        if beside:
            self.robot.lift(highest)
        for point in path:
            self.robot.move(point)

    def _square_at(self, x: float, y: float) -> Floats:
        """Return the square (5, 3), metres in the machine's frame, from x and y of the canvas to where there is room.

        Raises InputError, as `Limits.check_path`, where there is room on no side.
        """
        faults = []
        for right, down in _TURNS:
            far_x, far_y = x + right * SQUARE, y + down * SQUARE
            ring = np.array([(x, y), (far_x, y), (far_x, far_y), (x, far_y), (x, y)])
            path = self.easel.canvas_to_machine(np.insert(ring, 2, -self._depth, axis=1))
            try:
                self.robot.limits.check_path(np.concatenate([path, [self._above(point) for point in path]]))
            except InputError as error:
                faults.append(error)
            else:
                return path
        raise faults[0]
