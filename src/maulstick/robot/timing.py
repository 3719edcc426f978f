"""Timing of a machine's motion: straight segments under an acceleration limit, with look-ahead over corners.

Speed changes at the machine's acceleration; at a corner it is at most what lets a circle that passes within `deviation`
of it be driven at that acceleration (Grbl's junction deviation); where two segments meet, speed is such that braking
in time is possible. The same profile estimates the time of a plan, and drives machines that are sent set-points.
docs/equations.md has the equation.
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from maulstick.robot.limits import Limits
from maulstick.storage.arrays import Bools, Floats, Ints

_STRAIGHT = 1e-12  # metres, or metres per second: less counts as no motion, so that no division is by zero


@dataclass(frozen=True)
class Profile:
    """Profile of speed along a path, of a tip that starts and ends at rest.

    points: (n, 3) metres.  along: (n,) arc length at each, metres.  speeds: (n,) at each, metres per second.
    cruise: (n - 1,) highest speed within each segment, metres per second.  times: (n,) seconds at each point.
    acceleration: (n - 1,) by which that speed is reached and left, metres per second squared.
    """

    points: Floats
    along: Floats
    speeds: Floats
    cruise: Floats
    times: Floats
    acceleration: Floats

    @classmethod
    def of(cls, points: Floats, speed: Floats, limits: Limits) -> "Profile":
        """Return the fastest profile along points (n, 3), metres, with at most these speeds (n,), metres per second."""
        points = np.asarray(points, dtype=np.float64)
        rests = np.zeros(len(points), dtype=bool)
        rests[[0, -1]] = True
        lengths, speeds, cruise, seconds, acceleration = _segments(points, speed, rests, limits)
        times = np.concatenate([[0.0], np.cumsum(seconds)])
        along = np.concatenate([[0.0], np.cumsum(lengths)])
        return cls(points, along, speeds, cruise, times, acceleration)

    @property
    def seconds(self) -> float:
        """Duration of the motion, seconds."""
        return float(self.times[-1])

    def at(self, when: Floats) -> Floats:
        """Return where the tip is, (k, 3) metres, at times (k,), seconds; after the end it stays there."""
        return self._places(self.distance(when))

    def distance(self, when: Floats) -> Floats:
        """Return how far along the path the tip is, (k,) metres, at times (k,), seconds."""
        if len(self.points) == 1:
            return np.zeros(len(when))
        segment = np.clip(np.searchsorted(self.times, when, side="right") - 1, 0, len(self.points) - 2)
        since = np.clip(when - self.times[segment], 0, self.times[segment + 1] - self.times[segment])
        before, after, cruise = self.speeds[segment], self.speeds[segment + 1], self.cruise[segment]
        acceleration = self.acceleration[segment]
        faster, slower = (cruise - before) / acceleration, (cruise - after) / acceleration
        level = np.maximum(self.times[segment + 1] - self.times[segment] - faster - slower, 0)
        rising, cruising = np.minimum(since, faster), np.clip(since - faster, 0, level)
        falling = np.clip(since - faster - level, 0, slower)
        gone = before * rising + acceleration * rising**2 / 2 + cruise * (cruising + falling)
        return np.asarray(
            np.minimum(self.along[segment] + gone - acceleration * falling**2 / 2, self.along[segment + 1])
        )

    def _places(self, along: Floats) -> Floats:
        kept = np.concatenate([[True], np.diff(self.along) > 0])
        return np.stack([np.interp(along, self.along[kept], column[kept]) for column in self.points.T], axis=1)


def seconds_of_paths(points: Floats, speed: Floats, starts: Ints, limits: Limits) -> Floats:
    """Return the seconds (k,) that `Profile` gives for each of k paths, which all begin and end at rest.

    points: (n, 3) metres, one path after the other.  speed: (n,) metres per second at most.
    starts: (k,) index of the first point of each path, ascending from 0.
    """
    rests = np.zeros(len(points), dtype=bool)
    rests[starts] = True
    rests[[*(starts[1:] - 1), -1]] = True
    seconds = _segments(points, speed, rests, limits)[3]
    seconds = np.append(seconds, 0.0)  # one for each point, so that a path of one point has one
    seconds[starts[1:] - 1] = 0.0  # from a path to the next
    return np.asarray(np.add.reduceat(seconds, starts))


def _segments(
    points: Floats, speed: Floats, rests: Bools, limits: Limits
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Return lengths, speeds at the points (n,), cruise, seconds and accelerations of segments (n - 1,), as `Profile`.

    rests: (n,) whether the tip is at rest at a point.
    """
    steps = np.diff(points, axis=0)
    lengths = np.sqrt((steps**2).sum(axis=1))
    allowed = np.minimum(speed[:-1], speed[1:]).clip(max=limits.speed)
    climbing = np.abs(steps[:, 2]) / np.maximum(lengths, _STRAIGHT)
    allowed = np.minimum(allowed, limits.climb / np.maximum(climbing, _STRAIGHT))
    most = np.zeros(len(points))
    most[1:-1] = np.minimum(np.minimum(allowed[:-1], allowed[1:]), _corner_speeds(steps, lengths, limits))
    most[rests] = 0.0
    acceleration = limits.acceleration_along(steps / np.maximum(lengths, _STRAIGHT)[:, None])
    gain = 2 * acceleration * lengths
    speeds = _reachable(_reachable(most, gain)[::-1], gain[::-1])[::-1]
    before, after = speeds[:-1], speeds[1:]
    peak = np.sqrt((before**2 + after**2 + gain) / 2)
    cruise = np.minimum(peak, np.maximum(allowed, np.maximum(before, after)))
    ramps = (2 * cruise - before - after) / acceleration
    level = lengths - (2 * cruise**2 - before**2 - after**2) / (2 * acceleration)
    seconds = ramps + level.clip(min=0) / np.maximum(cruise, _STRAIGHT)
    return lengths, speeds, cruise, np.where(lengths > 0, seconds, 0.0), acceleration


def _reachable(speeds: Floats, gain: Floats) -> Floats:
    """Return the speeds (n,), each at most what can be reached from the one before it.

    gain: (n - 1,) by how much the square of the speed may grow in each segment.
    """
    reached = speeds.tolist()  # plain numbers, since thousands of them are looked at one by one
    for i, most in enumerate(gain.tolist()):
        reached[i + 1] = min(reached[i + 1], sqrt(reached[i] * reached[i] + most))
    return np.array(reached)


def _corner_speeds(steps: Floats, lengths: Floats, limits: Limits) -> Floats:
    """Return the highest speed (n - 2,) at each inner point, metres per second: Grbl's junction deviation."""
    moves = lengths > _STRAIGHT
    before = np.maximum.accumulate(np.where(moves, np.arange(len(steps)), 0))  # a repeated point hides no corner
    units = (steps / np.maximum(lengths, _STRAIGHT)[:, None])[before]
    half_sine = np.sqrt((1 + (units[:-1] * units[1:]).sum(axis=1)).clip(0, 2) / 2)  # sin(θ/2) of the angle between
    fast = half_sine > 1 - 1e-9
    radius = (limits.deviation or 0.0) * half_sine / np.where(fast, 1.0, 1 - half_sine)
    inwards = units[1:] - units[:-1]
    inwards /= np.maximum(np.sqrt((inwards**2).sum(axis=1)), _STRAIGHT)[:, None]
    speeds = np.where(fast, np.inf, np.sqrt(limits.acceleration_along(inwards) * radius))
    return np.asarray(np.where(moves[1:], speeds, np.inf))
