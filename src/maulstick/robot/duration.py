"""Durations of a routine's actions, and how much is drawn in them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from maulstick.robot.limits import Limits
from maulstick.robot.routine import Action, Draw, Motion, Prompt
from maulstick.robot.timing import seconds_of_paths
from maulstick.storage.arrays import Bools, Floats


def seconds_of(actions: Sequence[Action], limits: Limits, place: Floats) -> Floats:
    """Return the seconds (k,) that each action takes from a tip at `place` (3,), metres.

    Of a prompt, that is the way to its place aside, if any.
    """
    seconds = np.zeros(len(actions))
    moving = [index for index, action in enumerate(actions) if not isinstance(action, Prompt) or action.aside]
    if moving:
        draws = np.array([not isinstance(actions[index], Prompt) for index in moving])
        seconds[moving] = _seconds([_motion_of(actions[index]) for index in moving], draws, limits, place)
    return seconds


def drawn_metres(actions: Sequence[Action]) -> float:
    """Return the metres of stroke among the actions."""
    return sum(action.motion.length for action in actions if isinstance(action, Draw))


def timed(actions: Sequence[Action], limits: Limits, place: Floats) -> list[Action]:
    """Return the actions, in which each prompt for a full tool knows the seconds until the next one.

    place: (3,), of the tip, metres.
    """
    known: list[Action] = []
    left = 0.0
    for action, seconds in zip(reversed(actions), reversed(seconds_of(actions, limits, place).tolist()), strict=True):
        if isinstance(action, Prompt) and action.renews:
            known.append(replace(action, seconds=left or None))
            left = 0.0
        else:
            known.append(action)
            left += seconds
    return known[::-1]


def _motion_of(action: Action) -> Motion:
    """Return the motion of an action; of a prompt, one of no length at its place aside."""
    if not isinstance(action, Prompt):
        return action.motion
    assert action.aside is not None
    return Motion(np.array([action.aside]), np.ones(1), above=action.aside[2], after=action.aside[2])


def _seconds(motions: Sequence[Motion], draws: Bools, limits: Limits, place: Floats) -> Floats:
    """Return the seconds (k,) of motions one after another: over to each, down, along it, and up again.

    draws: (k,) whether the tip is lowered; where not, it only goes there.
    """
    counts = np.array([len(motion.path) for motion in motions])
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    path = np.concatenate([motion.path for motion in motions])
    first, last = path[starts], path[starts + counts - 1]
    above, after = (np.array([getattr(motion, name) for motion in motions]) for name in ("above", "after"))
    begins, ends = first.copy(), last.copy()
    begins[:, 2], ends[:, 2] = above, after
    over = begins - np.concatenate([place[None], ends[:-1]])
    along = seconds_of_paths(path, np.concatenate([motion.speed for motion in motions]), starts, limits)
    seconds = along + np.where(draws, 2 * limits.settling + 2 * limits.lifting, limits.settling)
    if not limits.varies_pressure:
        over[:, 2] = 0.0  # its height is not a distance
        return np.asarray(seconds + _straight(over, limits))
    heights = np.zeros((2, len(motions), 3))
    heights[:, :, 2] = above - first[:, 2], after - last[:, 2]
    lowering, raising = (_straight(each, limits) for each in heights)
    seconds += draws * limits.settling  # of the way up; a pen that is only lifted moves no motor
    return np.asarray(seconds + _straight(over, limits) + lowering + raising)


def _straight(steps: Floats, limits: Limits) -> Floats:
    """Return the seconds (k,) for steps (k, 3), metres, each straight and at rest at both ends."""
    points = np.stack([np.zeros_like(steps), steps], axis=1).reshape(-1, 3)
    return seconds_of_paths(points, np.full(len(points), limits.speed), np.arange(len(steps)) * 2, limits)
