"""Room: the part of a sheet that ink must not leave, since what is around it is to stay bare."""

from collections.abc import Iterable
from dataclasses import replace
from math import hypot

import numpy as np
import torch

from maulstick.errors import InputError, option
from maulstick.painting.brush import Brush
from maulstick.painting.raster import Canvas
from maulstick.planning.parameters import StrokeParameters
from maulstick.rendering.traj2stroke import Marks, Traj2Stroke
from maulstick.storage.arrays import Floats
from maulstick.strokes.refine import refine
from maulstick.style import Style

Room = tuple[float, float, float, float]
"""Left, top, right and lower edge, metres."""

_SLACK = 2e-6  # metres that a mark is kept from the edge: a painting's points are rounded to a micrometre
_DIGITS = 6  # of a painting's metres
_STEP = 1e-4  # metres by which a stroke that is too long is cut further in each round


def room_of(area: tuple[float, float, float, float]) -> Room:
    """Return the room of an area (x, y, width, height), metres."""
    x, y, width, height = area
    return x, y, x + width, y + height


def surface_of(room: Room | None, canvas: Canvas) -> float:
    """Return how much of a canvas ink may lie on, square metres."""
    return canvas.width * canvas.height if room is None else (room[2] - room[0]) * (room[3] - room[1])


def check_room(room: Room | None, brushes: Iterable[Brush]) -> None:
    """Raise InputError where the broadest mark of the brushes is wider than the room."""
    if room is None:
        return
    brush = max(brushes, key=_reach)
    free = min(room[2] - room[0], room[3] - room[1])
    if free < 2 * _reach(brush) + 2 * _STEP:
        raise InputError(
            f"{option('margin')} leaves {1e3 * free:.3g} mm for the picture, and the brush {brush.name} is "
            f"{2e3 * _reach(brush):.3g} mm wide; choose a smaller margin, a larger sheet or a thinner brush"
        )


@torch.no_grad()
def move_into(room: Room, strokes: StrokeParameters, style: Style, brushes: Traj2Stroke) -> None:
    """Move each stroke by the least that brings its mark into the room; one that is too long, to its middle."""
    marks = brushes.marks(strokes.trajectories(style), 1.0)
    half = marks.thickness[..., None].clamp(min=0)
    least, most = (marks.points - half).amin(dim=1), (marks.points + half).amax(dim=1)
    strokes.centres.add_(torch.from_numpy(_move(room, least.numpy(), most.numpy())))


def cut_marks(room: Room, marks: Marks, pixels_per_metre: float) -> Marks:
    """Return the marks of straight steps, those that leave the room moved to its edge."""
    least, most = (torch.tensor(edge).to(marks.points) * pixels_per_metre for edge in (room[:2], room[2:]))
    thickness = marks.thickness[..., None].clamp(min=0)
    points = torch.minimum(torch.maximum(marks.points, least + thickness), most - thickness)
    return replace(marks, points=points)


def kept_in(room: Room, trajectories: Floats, brush: Brush) -> Floats:
    """Return commanded trajectories (N, n, 3) whose marks, once they are refined, lie in the room; in micrometres.

    Those whose mark leaves it are moved by the least; those that are too long go along its edge.
    """
    own = trajectories.round(_DIGITS)
    own[..., :2] += _move(room, *_refined_extents(own, brush)).round(_DIGITS)[:, None]
    kept = own.round(_DIGITS)
    cut = np.zeros((len(kept), 4))  # metres from each edge of the room, at which strokes that are too long end
    rows = np.flatnonzero(_overhang(room, kept, brush).any(axis=1))
    while len(rows):
        edges = (np.array(room) + cut[rows] * (1, 1, -1, -1))[:, None]
        kept[rows, :, :2] = own[rows, :, :2].clip(edges[..., :2], edges[..., 2:]).round(_DIGITS)
        over = _overhang(room, kept[rows], brush)
        cut[rows] += np.where(over > 0, over + _STEP, 0)
        rows = rows[over.any(axis=1)]
    return kept


def _overhang(room: Room, trajectories: Floats, brush: Brush) -> Floats:
    """Return how far the refined marks lie beyond each edge of the room, (N, 4), metres."""
    least, most = _refined_extents(trajectories, brush)
    return np.concatenate([np.array(room[:2]) - least, most - np.array(room[2:])], axis=1).clip(min=0)


def _refined_extents(trajectories: Floats, brush: Brush) -> tuple[Floats, Floats]:
    """Return where the refined marks of commanded trajectories begin and end, (N, 2) each, metres."""
    ends = np.zeros((2, len(trajectories), 2))
    for row, path in enumerate(refine(list(trajectories))):
        points, half_widths, _ = brush.bare_mark(path)
        half = half_widths.clip(min=0)[:, None]
        ends[:, row] = (points - half).min(axis=0), (points + half).max(axis=0)
    return ends[0], ends[1]


def _move(room: Room, least: Floats, most: Floats) -> Floats:
    """Return the least move (N, 2) into the room of marks from `least` to `most`, or to its middle, if too long."""
    first, last = (np.array(edge, dtype=least.dtype) for edge in (room[:2], room[2:]))
    before, beyond = first + _SLACK - least, most - last + _SLACK
    moved: Floats = np.where(before + beyond <= 0, before.clip(min=0) - beyond.clip(min=0), (before - beyond) / 2)
    return moved


def _reach(brush: Brush) -> float:
    """Return how far a dot of the brush may reach from where it is commanded, metres."""
    off = hypot(brush.b_x, brush.b_y) + hypot(*brush.touch) + brush.lag
    return brush.widest * (1 + hypot(*brush.nib)) + off
