"""Export of a routine as G-code, HPGL or JSON lines."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from maulstick.errors import InputError
from maulstick.robot.easel import Pen
from maulstick.robot.export.gcode import Dialect, Gcode
from maulstick.robot.export.hpgl import CAROUSEL, CarouselLoad, hpgl
from maulstick.robot.limits import Limits
from maulstick.robot.routine import Action, Draw, Prompt, TrayVisit


def as_gcode(actions: Sequence[Action], limits: Limits, dialect: Dialect, pen: Pen | None) -> str:
    """Return the routine as G-code, which begins by lifting the pen to the highest height of the routine.

    It pauses at prompts.
    Raises InputError where a motion leaves the limits.
    """
    writer = Gcode(dialect, limits, pen)
    highest = max(
        (action.motion.above for action in actions if not isinstance(action, Prompt)), default=limits.upper[2]
    )
    place = np.array([*limits.lower[:2], highest])
    lines = [*writer.begin(), *writer.lift(place)]
    for action in actions:
        if isinstance(action, Prompt):
            lines += writer.pause(action.message)
            continue
        motion = action.motion
        lines += [*writer.travel(place, motion.start), *writer.draw(motion.start, motion.path, motion.speed)]
        place = np.array([*motion.path[-1, :2], motion.after])
        lines += writer.lift(place)
    return "\n".join([*lines, ""])


def as_hpgl(
    actions: Sequence[Action],
    limits: Limits,
    carousel: int = CAROUSEL,
    speed: float | None = None,
    shrink: bool = False,
) -> list[CarouselLoad]:
    """Return the strokes as HPGL, one pen per paint; further arguments are those of `hpgl`.

    Raises InputError where they need a tray, and as `hpgl`.
    """
    if any(isinstance(action, TrayVisit) for action in actions):
        raise InputError("HPGL knows pens and no wells; leave out the tray, or export gcode")
    strokes = [(action.paint, action.motion.path) for action in actions if isinstance(action, Draw)]
    return hpgl(strokes, limits, carousel, speed, shrink)


def as_json(actions: Sequence[Action]) -> str:
    """Return one JSON object per line and action: draw, dip, rinse, wipe or ask; metres and metres per second."""
    return "".join(f"{json.dumps(_entry(action))}\n" for action in actions)


def _entry(action: Action) -> dict[str, Any]:
    if isinstance(action, Prompt):
        return {"do": "ask", "paint": action.paint, "message": action.message}
    motion = action.motion
    entry = {
        "paint": action.paint,
        "above": round(motion.above, 6),
        "path": motion.path.round(6).tolist(),
        "speed": motion.speed.round(6).tolist(),
        "after": round(motion.after, 6),
    }
    if isinstance(action, Draw):
        return {"do": "draw", "stroke": action.stroke, **entry}
    return {"do": action.what, **entry}
