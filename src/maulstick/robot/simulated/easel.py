"""The simulated easel: a machine with limits and a clock over a sheet that takes ink.

It takes places and heights as a real machine does. How the medium marks and where the sheet truly lies can only be
seen in photographs.
"""

import time
from collections.abc import Sequence
from typing import Final, final

import numpy as np

from maulstick.robot.easel import Easel
from maulstick.robot.limits import Limits
from maulstick.robot.robot import Robot, StoppedError
from maulstick.robot.simulated.sheets import Colour, InkedSheet
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats

ARM: Final = Limits(
    lower=(-0.25, -0.85, -0.02),
    upper=(0.85, 0.25, 0.12),
    speed=0.25,
    climb=0.1,
    acceleration=2.0,
    deviation=1e-4,
    varies_pressure=True,
)
"""Limits of a small arm."""

WEIGHTLESS: Final = Limits(
    lower=(-5, -5, -0.02), upper=(5, 5, 0.12), speed=10, climb=1, acceleration=100, deviation=1e-4, varies_pressure=True
)
"""Limits of an arm without mass: it follows any hand's speed, on any sheet."""

_REST = np.array([0.0, 0.0, 0.05])  # metres: where the tip is before it is moved, and the height it is lifted to
_TICK = 0.02  # seconds between two looks at the clock
_IN_A_WELL = 0.01  # metres: a stroke that begins so near to a well takes its colour
_ROUNDING = 1e-6  # pressure: a tip so little above the paper still touches it


@final
class SimulatedEasel(Robot):
    """Simulated arm over a sheet: where its tip is below the paper, the sheet takes ink of the colour it holds.

    sheet: the sheet that is drawn on.  truth: where it really lies, which a measured easel may have wrong.
    offset, scatter: shift of all strokes, and of each at random (one sigma), metres.
    rng: of the scatter.  wells: x and y in the canvas frame, metres, and a colour each.
    pace: speed of its clock, in units of real time; infinity does not wait at all.
    """

    def __init__(
        self,
        sheet: InkedSheet,
        truth: Easel | None = None,
        *,
        offset: tuple[float, float] = (0.0, 0.0),
        scatter: float = 0.0,
        rng: np.random.Generator | None = None,
        wells: Sequence[tuple[float, float, Colour]] = (),
        pace: float = float("inf"),
        limits: Limits = WEIGHTLESS,
    ) -> None:
        super().__init__(limits)
        self.sheet = sheet
        self.seconds = 0.0
        self.colour: Colour = (0.0, 0.0, 0.0)
        self._truth = truth or self.easel(sheet.canvas.width, sheet.canvas.height)
        self._offset, self._scatter = np.array(offset), scatter
        self._rng = rng or np.random.default_rng(0)
        self._wells, self._pace = wells, pace
        self._at = _REST

    def easel(self, width: float, height: float) -> Easel:
        """Return an easel at the machine's origin, with the depth of the sheet's medium."""
        return Easel(corner=(0, 0, 0), right=(1, 0, 0), down=(0, -1, 0), deepest=self.sheet.deepest, travel=5e-3)

    def hold(self, colour: Colour) -> None:
        """Hold a pen of this colour from now on."""
        self.colour = colour

    def mark(self, path: Floats) -> None:
        """Mark the sheet with a stroke along a path (n, 3), metres, that an earlier run drew; nothing moves."""
        self._ink(path, self._offset)

    def _connect(self) -> None:
        pass

    def _open(self) -> Floats:
        if self._at[2] < _REST[2]:
            self._at = np.array([*self._at[:2], _REST[2]])
        return self._at

    def _close(self) -> None:
        pass

    def _move(self, place: Floats) -> Floats:
        self._follow(Profile.of(np.stack([self._at, place]), np.full(2, self.limits.speed), self.limits))
        return place

    def _stroke(self, path: Floats, speed: Floats) -> Floats:
        self._move(path[0])
        shift = self._offset + self._scatter * self._rng.standard_normal(2)
        profile = Profile.of(path, speed, self.limits)
        start = self.seconds
        try:
            self._follow(profile)
        finally:  # a stroke that is stopped has left its ink so far
            seconds = self.seconds - start
            times = np.append(profile.times[profile.times < seconds], seconds)
            self._ink(profile.at(times), shift)
        return path

    def _lift(self, place: Floats) -> Floats:
        return self._move(place)

    def _halt(self) -> None:
        pass

    def _recover(self) -> None:
        self._at = np.array([*self._at[:2], max(self._at[2], _REST[2])])

    def _follow(self, profile: Profile) -> None:
        begun, clock = self.seconds, time.monotonic()
        while (now := (time.monotonic() - clock) * self._pace) < profile.seconds:
            if self._stopping.wait(min(_TICK, (profile.seconds - now) / self._pace)):
                self.seconds = begun + min((time.monotonic() - clock) * self._pace, profile.seconds)
                self._at = profile.at(np.array([self.seconds - begun]))[0]
                raise StoppedError
        if self._stopping.is_set():
            raise StoppedError
        self.seconds = begun + profile.seconds
        self._at = profile.points[-1]

    def _ink(self, path: Floats, shift: Floats) -> None:
        """Mark the sheet where a tip follows a path (n, 3) of the machine, shifted by (2,) metres."""
        path = self._truth.machine_to_canvas(path)
        for x, y, colour in self._wells:
            if np.hypot(*(path[0, :2] - (x, y))) < _IN_A_WELL:
                self.colour = colour
        pressure = -path[:, 2] / self.sheet.depth
        touching = pressure > -_ROUNDING
        for run in np.split(np.arange(len(path)), np.flatnonzero(np.diff(touching)) + 1):
            if touching[run[0]]:
                drawn = np.concatenate([path[run, :2] + shift, pressure[run, None].clip(0, 1)], axis=1)
                self.sheet.draw(drawn, self.colour)
