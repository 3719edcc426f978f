"""The routine of a painting: strokes, visits to the tray and prompts, in the machine's frame."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from math import dist
from typing import Final, Literal

import numpy as np

from maulstick.errors import InputError, Remedy, Wording
from maulstick.painting.brush import Brush
from maulstick.painting.painting import Painting, Stroke
from maulstick.painting.refined import refined
from maulstick.robot.easel import Easel
from maulstick.robot.limits import SLACK, Limits, Point
from maulstick.robot.pressing import check_depth, check_pressure, depth_at
from maulstick.robot.room import Way, check_room
from maulstick.robot.tray import Tray, Well
from maulstick.storage.arrays import Floats

_SAME = 1e-7  # metres, or pressure: points that differ by less in everything count as one
_APART = 0.02  # metres between the places of a way over that are looked at; an arm's reach changes little within


@dataclass(frozen=True)
class Motion:
    """Motion of the tip: down to the first point of a path, along it, and up again.

    path: (n, 3) metres in the machine's frame.  speed: (n,) metres per second at most.
    above: z at which the tip arrives over the start.  after: z to which it is lifted at the end.
    """

    path: Floats
    speed: Floats
    above: float
    after: float

    @property
    def start(self) -> Floats:
        """Place (3,) above the first point, with the tip lifted, metres."""
        return np.array([*self.path[0, :2], self.above])

    @property
    def end(self) -> Floats:
        """Place (3,) above the last point, with the tip lifted again, metres."""
        return np.array([*self.path[-1, :2], self.after])

    @property
    def length(self) -> float:
        """Length of the path, metres."""
        return float(np.sqrt((np.diff(self.path, axis=0) ** 2).sum(axis=1)).sum())


@dataclass(frozen=True)
class Draw:
    """Action that paints the stroke with this id."""

    stroke: int
    paint: int
    motion: Motion


Visit = Literal["rinse", "wipe", "dip"]


@dataclass(frozen=True)
class TrayVisit:
    """Action that rinses, wipes or dips the brush for a paint."""

    what: Visit
    paint: int
    motion: Motion


@dataclass(frozen=True)
class Prompt:
    """Action of the operator, with the tip above a place `aside`; where it `renews`, the tool is full afterwards.

    seconds: for which the tool then draws, until the next prompt that renews it; None where that is not known.
    elsewhere: what helps once they have stopped, where what they are to see is not so.
    """

    message: str
    paint: int
    renews: bool = True
    aside: Point | None = None
    seconds: float | None = None
    elsewhere: Remedy | None = None

    def told(self, wording: Wording) -> str:
        """Return all that the operator is told to do, in the words of a front end."""
        if self.elsewhere is None:
            return self.message
        return f"{self.message} (elsewhere: stop, {wording.remedy(self.elsewhere)})"


Action = Draw | TrayVisit | Prompt


@dataclass(frozen=True)
class PaintLoad:
    """Paint in the machine's tool, None where it has none yet; metres and seconds painted since it was taken up."""

    paint: int | None = None
    painted: float = 0.0
    seconds: float = field(default=0.0, compare=False)

    def after(self, paint: int, metres: float, seconds: float = 0.0) -> "PaintLoad":
        """Return the load after a stroke of so many metres and seconds."""
        return PaintLoad(paint, self.painted + metres, self.seconds + seconds)


NOTHING: Final = PaintLoad()
"""Load of a machine that has taken up no paint yet."""


def routine(
    painting: Painting,
    easel: Easel,
    limits: Limits,
    tray: Tray | None = None,
    *,
    speed: float | None = None,
    done: Collection[int] = (),
    load: PaintLoad = NOTHING,
) -> list[Action]:
    """Return the actions that are still to be done, in order, when the strokes with the ids in `done` are painted.

    Strokes are `refined`: a machine goes straight from point to point.

    speed: metres per second, the speed of strokes that have none of their own, and a bound for the others; left out,
    the machine's highest.  load: the paint that the machine holds at the beginning.
    Raises InputError, which names what does not fit and by how much, where the painting, its brushes or the tray do not
    fit `limits` or `easel`. So all actions that are returned may be sent.
    """
    _check_easel(easel, limits)
    if speed is not None and not speed > 0:  # NaN is neither
        raise InputError.of_range("the speed", f"{1e3 * speed:g} mm/s", "above 0")
    painted = set(done)
    used = bool(painted) or load.painted > 0
    left = tuple(stroke for stroke in painting.strokes if stroke.id not in painted)
    wanted = refined(painting.model_copy(update={"strokes": left})).strokes
    for paint in {stroke.paint for stroke in wanted}:
        check_depth(painting.brushes[painting.paints[paint].brush], easel, limits)
    if not limits.varies_pressure:
        check_pressure(wanted, painting)
    actions: list[Action] = []
    for stroke in wanted:
        brush = painting.brushes[painting.paints[stroke.paint].brush]
        draw = Draw(stroke.id, stroke.paint, _motion(stroke, brush, easel, limits, speed))
        if load.paint != stroke.paint or _runs_dry(load, draw.motion, tray):
            taking_up = _taking_up(stroke.paint, load, painting, tray, used, easel, limits)
            if tray is not None:  # the way there and back is high
                actions[-1:] = [_lifted(last, easel, tray) for last in actions[-1:]]
                above = _height(easel, draw.motion.path[0], tray.clearance)
                draw = replace(draw, motion=replace(draw.motion, above=above))
            actions += taking_up
            load = PaintLoad(stroke.paint)
        load = load.after(stroke.paint, draw.motion.length)
        actions.append(draw)
    if tray is not None:
        visits = [action for action in actions if isinstance(action, TrayVisit)]
        dipped = {visit.paint for visit in visits if visit.what == "dip"}
        tray.check_places(painting, dipped, rinsed=any(visit.what != "dip" for visit in visits))
    check_room(ways_of(actions), easel, limits)
    return actions


def prompt_for(painting: Painting, paint: int) -> Prompt:
    """Return the prompt that asks for the pen or the brush of a paint."""
    wanted = painting.paints[paint]
    return Prompt(f"put in the {wanted.brush} with the paint {wanted.label}", paint)


def ways_of(actions: Sequence[Action]) -> list[Way]:
    """Return where the tip goes in each action, and straight over to it from the one before."""
    ways: list[Way] = []
    for action in actions:
        if isinstance(action, Prompt):
            if action.aside is not None:
                ways.append(_way_aside(action.aside, ways[-1].path[-1] if ways else np.array(action.aside)))
            continue
        motion = action.motion
        name = f"stroke {action.stroke}" if isinstance(action, Draw) else f"the {action.what} for paint {action.paint}"
        if ways:
            ways.append(Way(f"the way to {name}", _straight_over(ways[-1].path[-1], motion.start), None))
        path = np.concatenate([[motion.start], motion.path, [motion.end]])
        ways.append(Way(name, path, motion.speed, in_tray=isinstance(action, TrayVisit)))
    return ways


def _way_aside(aside: Point, start: Floats) -> Way:
    """Return the way from a place (3,) to one where the operator works on the pen: no lower than either."""
    height = max(aside[2], float(start[2]))
    path = _straight_over(np.array([*start[:2], height]), np.array([*aside[:2], height]))
    return Way("the way aside to the operator", path, None)


def _straight_over(start: Floats, end: Floats) -> Floats:
    """Return places (k, 3) from one place (3,) straight to another, at most 20 mm apart."""
    if (count := int(dist(start, end) / _APART)) == 0:
        return np.stack([start, end])
    return np.linspace(start, end, count + 2)


def _runs_dry(load: PaintLoad, motion: Motion, tray: Tray | None) -> bool:
    """Return whether the paint left on the brush is less than a stroke needs; never for a brush that is just dipped."""
    return tray is not None and load.painted > 0 and load.painted + motion.length > tray.reach


def _motion(stroke: Stroke, brush: Brush, easel: Easel, limits: Limits, speed: float | None) -> Motion:
    """Return the motion of a stroke. Raises InputError where the machine is too slow."""
    points = np.array(stroke.trajectory, dtype=np.float64)
    kept = np.concatenate([[True], np.abs(np.diff(points, axis=0)).max(axis=1) > _SAME])
    points = points[kept]
    most = limits.speed if speed is None else min(speed, limits.speed)
    speeds = np.full(len(points), most)
    if stroke.speed is not None:
        own = np.array(stroke.speed)[kept]
        if speed is None and own.max() > limits.speed + SLACK:
            raise InputError(
                f"stroke {stroke.id} is drawn at {1e3 * own.max():.0f} mm/s, and the machine's fastest is "
                f"{1e3 * limits.speed:g}",
                Remedy.SLOW_DOWN,
                speed=limits.speed,
                millimetres=f"{1e3 * limits.speed:g}",
            )
        speeds = own.clip(max=most)
    heights = -depth_at(points[:, 2], brush, easel) if limits.varies_pressure else np.zeros(len(points))
    path = easel.canvas_to_machine(np.concatenate([points[:, :2], heights[:, None]], axis=1))
    return Motion(path, speeds, *(_height(easel, path[end], easel.travel) for end in (0, -1)))


def _check_easel(easel: Easel, limits: Limits) -> None:
    """Raise InputError where the paper is tilted more than the machine allows."""
    if easel.tilt > limits.tilt:
        came, most = (np.degrees(angle) for angle in (easel.tilt, limits.tilt))
        raise InputError(f"the paper is tilted by {came:.2g} degrees; it must be at most {most:.2g}: lay it flatter")


def _taking_up(
    paint: int, load: PaintLoad, painting: Painting, tray: Tray | None, used: bool, easel: Easel, limits: Limits
) -> list[Prompt | TrayVisit]:
    """Return what has to be done before a paint can be used; used: whether a tool of unknown load may be dirty."""
    wanted = painting.paints[paint]
    if tray is None:
        return [prompt_for(painting, paint)] if len(painting.paints) > 1 else []
    asked: list[Prompt] = []
    visits: list[Visit] = ["dip"]
    held = None if load.paint is None else painting.paints[load.paint].brush
    if len(painting.brushes) > 1 and held != wanted.brush:
        asked = [Prompt(f"put in the {wanted.brush}, clean", paint)]
    elif used if load.paint is None else load.paint != paint:
        visits = ["rinse", "wipe", "dip"]
    places = {"rinse": tray.water, "wipe": tray.cloth, "dip": tray.wells_of(painting)[paint]}
    return [*asked, *(TrayVisit(what, paint, _visit(places[what], tray, easel, limits)) for what in visits)]


def _lifted(action: Action, easel: Easel, tray: Tray) -> Action:
    """Return the action with its lift at the end raised to the height at which the tip passes over the tray."""
    if isinstance(action, Prompt):
        return action
    after = _height(easel, action.motion.path[-1], tray.clearance)
    return replace(action, motion=replace(action.motion, after=after))


def _visit(well: Well, tray: Tray, easel: Easel, limits: Limits) -> Motion:
    """Return the motion of the tip in a well, from and to the height of the tray's clearance."""
    path = easel.canvas_to_machine(well.path())
    speed = np.full(len(path), min(tray.speed, limits.speed))
    return Motion(path, speed, *(_height(easel, path[end], tray.clearance) for end in (0, -1)))


def _height(easel: Easel, place: Floats, above: float) -> float:
    """Return the machine's z, straight above its place (3,), at which the tip is so far `above` the paper; metres."""
    return float(place[2] + (above - easel.machine_to_canvas(place)[2]) / easel.up[2])
