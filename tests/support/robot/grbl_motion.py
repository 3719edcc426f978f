"""The motion of a Grbl 1.1, by its documentation: blocks planned ahead, stepped at 1 kHz, independent of the package.

Millimetres and seconds, but for settings, which are Grbl's.
"""

from collections import deque
from dataclasses import dataclass

TICK = 1e-3  # seconds
BLOCKS = 15

Vector = tuple[float, float, float]


@dataclass
class Block:
    """A straight motion; `entry` is planned again whenever another one comes."""

    start: Vector
    unit: Vector
    length: float
    rate: float
    acceleration: float
    fastest_entry: float = 0.0
    entry: float = 0.0

    def at(self, gone: float) -> Vector:
        x, y, z = (start + part * gone for start, part in zip(self.start, self.unit, strict=True))
        return x, y, z


class GrblMotion:
    """Planner of the tip: its place and speed, and the blocks that are queued."""

    def __init__(self, settings: dict[int, float], place: Vector) -> None:
        self._settings = settings
        self.place = place
        self.fastest = 0.0
        self.forget()

    def forget(self) -> None:
        """Stop, with an empty queue."""
        self.speed = 0.0
        self.goal = self.place
        self._blocks: deque[Block] = deque()
        self._gone = 0.0  # along the first block

    @property
    def busy(self) -> bool:
        return bool(self._blocks)

    @property
    def full(self) -> bool:
        return len(self._blocks) >= BLOCKS

    def add(self, goal: Vector, rate: float) -> None:
        """Plan a straight motion to the goal at no more than this rate."""
        x, y, z = (after - before for after, before in zip(goal, self.goal, strict=True))
        length = (x * x + y * y + z * z) ** 0.5
        if length == 0:
            return
        unit = (x / length, y / length, z / length)
        block = Block(self.goal, unit, length, min(rate, self._along(unit, 110) / 60), self._along(unit, 120))
        if self._blocks:
            last = self._blocks[-1]
            block.fastest_entry = min(block.rate, last.rate, self._corner(last.unit, unit))
        self.goal = goal
        self._blocks.append(block)
        self._look_ahead()

    def step(self, braking: bool) -> list[Vector]:
        """Move for one tick, or brake; returns the ends of blocks that were reached."""
        left, ended = TICK, []
        while left > 0 and self._blocks:
            block = self._blocks[0]
            leaving = self._blocks[1].entry if len(self._blocks) > 1 else 0.0
            to_go = block.length - self._gone
            if braking:
                aim = max(self.speed - block.acceleration * left, 0.0)
            else:
                in_time = (leaving**2 + 2 * block.acceleration * max(to_go, 0.0)) ** 0.5
                aim = min(self.speed + block.acceleration * left, block.rate, in_time)
            mean = max((self.speed + aim) / 2, 1e-3)
            took = min(left, to_go / mean)
            self._gone += mean * took
            self.speed = aim
            self.fastest = max(self.fastest, aim)
            left -= took
            if block.length - self._gone < 1e-9:
                self._gone = 0.0
                self.speed = min(self.speed, max(leaving, block.acceleration * TICK))
                self.place = block.at(block.length)
                ended.append(self.place)
                self._blocks.popleft()
            else:
                self.place = block.at(self._gone)
            if braking and self.speed == 0:
                return ended
        if not self._blocks:
            self.speed = 0.0
        return ended

    def _along(self, unit: Vector, first_setting: int) -> float:
        """Return what all axes allow along a direction, of a value that each axis limits."""
        return min(
            self._settings[first_setting + axis] / abs(part) for axis, part in enumerate(unit) if abs(part) > 1e-12
        )

    def _corner(self, before: Vector, after: Vector) -> float:
        """Return the speed on a circle that touches both segments and passes the corner by the junction deviation."""
        cosine = -sum(a * b for a, b in zip(before, after, strict=True))
        if cosine > 0.999999:
            return 0.0
        if cosine < -0.999999:
            return float("inf")
        x, y, z = (a - b for a, b in zip(after, before, strict=True))
        size = (x * x + y * y + z * z) ** 0.5
        half = (0.5 * (1 - cosine)) ** 0.5
        inwards = self._along((x / size, y / size, z / size), 120)
        return float((inwards * self._settings[11] * half / (1 - half)) ** 0.5)

    def _look_ahead(self) -> None:
        first, *others = self._blocks
        leaving = 0.0
        for block in reversed(others):
            block.entry = min(block.fastest_entry, (leaving**2 + 2 * block.acceleration * block.length) ** 0.5)
            leaving = block.entry
        arriving = (self.speed**2 + 2 * first.acceleration * (first.length - self._gone)) ** 0.5
        for block in others:
            block.entry = min(block.entry, arriving)
            arriving = (block.entry**2 + 2 * block.acceleration * block.length) ** 0.5
