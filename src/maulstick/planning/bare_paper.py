"""Bare paper: where no ink may lie, and marks that are moved off it or cut at it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.ndimage import distance_transform_edt

from maulstick.painting.brush import Brush
from maulstick.painting.raster import Canvas
from maulstick.storage.arrays import Bools, Floats, Ints
from maulstick.strokes.refine import SAGITTA, refine

_FINE_PX = 3000  # longest side of the field of distances to bare paper, as far as whole multiples of pixels go
_FINER = 4  # at most so many of its samples per pixel
_SLACK = 2e-5  # metres that a mark is kept from bare paper
_MOVES = 40  # moves at most that bring a finished stroke off bare paper, before it is left out


@dataclass(frozen=True)
class BarePaper:
    """Pixels of a canvas that are `bare`, (H, W)."""

    bare: Bools
    canvas: Canvas

    @cached_property
    def exists(self) -> bool:
        """Whether any paper is bare."""
        return bool(self.bare.any())

    def is_off(self, trajectory: Floats, brush: Brush) -> bool:
        """Return whether no mark of a commanded trajectory (n, 3) lies on bare paper."""
        return not self.exists or bool(self._deepest(*_mark(trajectory, brush))[0] <= 0)

    def kept_off(self, trajectories: Floats, brush: Brush) -> Floats:
        """Return commanded trajectories (N, n, 3), those whose marks lie on bare paper moved off it where they can."""
        kept = trajectories.copy()
        for row in range(len(kept) if self.exists else 0):
            for _ in range(_MOVES):
                move = self.moves_off(*_mark(kept[row], brush))[0]
                if not move.any():
                    break
                kept[row, :, :2] += move
        return kept

    def parts_off(self, trajectory: Floats, brush: Brush) -> list[Floats]:
        """Return the parts of a commanded trajectory (n, 3), in order, of which no mark lies on bare paper."""
        if self.is_off(trajectory, brush):
            return [trajectory]
        (path,) = refine([trajectory])
        points, half_widths, _ = brush.bare_mark(path)
        last = len(path) - 1
        pieces = int(np.ceil(np.hypot(*np.diff(points, axis=0).T).max(initial=0) * self._samples_per_metre))
        places = np.linspace(0, last, last * pieces + 1)
        clear = self._depth(_at(places, np.column_stack([points, half_widths]))) <= -SAGITTA
        cuts = np.flatnonzero(np.diff(clear)) + 1
        found: list[Floats] = []
        for run, (is_clear, *_) in zip(np.split(places, cuts), np.split(clear, cuts), strict=True):
            if is_clear and 0 < np.ptp(run) < last:
                corners = np.arange(np.floor(run[0]) + 1, np.ceil(run[-1]))
                found += self.parts_off(_at(np.array([run[0], *corners, run[-1]]), path), brush)
        return found

    def moves_off(self, points: Floats, half_widths: Floats) -> Floats:
        """Return the moves (N, 2), metres, that bring the deepest dot of each mark off bare paper.

        points: (N, n, 2), metres.  half_widths: (N, n), metres.
        """
        depth, slope = self._deepest(points, half_widths)
        most, length = depth.clip(min=0), np.maximum(np.hypot(*slope.T), 1e-9)[:, None]
        moves: Floats = slope / length * (most + _SLACK * (most > 0))[:, None]
        return moves

    def _deepest(self, points: Floats, half_widths: Floats) -> tuple[Floats, Floats]:
        """Return how deep the deepest dot of each mark lies on bare paper, metres, (N,), and the way off it, (N, 2).

        Between points a mark is sampled where it may be deeper there than at any of them.
        """
        dots = np.concatenate([points, half_widths.clip(min=0)[..., None]], axis=2)
        depth, every = self._depth(dots), np.arange(len(dots))
        deepest = depth.argmax(axis=1)
        steps = np.diff(dots, axis=1)
        lengths = np.hypot(steps[..., 0], steps[..., 1])
        most = np.maximum(depth[:, :-1], depth[:, 1:]) + lengths / 2
        mark, step = np.nonzero(most > depth[every, deepest].clip(min=0)[:, None])
        pieces = int(np.ceil(lengths[mark, step].max(initial=0) * self._samples_per_metre))
        shares = np.linspace(0, 1, pieces, endpoint=False)[:, None]
        between = (dots[mark, step][:, None] + shares * steps[mark, step][:, None]).reshape(-1, 3)
        dots, owners = np.concatenate([dots[every, deepest], between]), np.concatenate([every, mark.repeat(pieces)])
        depth = self._depth(dots)
        deepest = np.lexsort((depth, owners))[np.cumsum(np.bincount(owners)) - 1]
        return depth[deepest], self._away[1][:, *self._samples(dots[deepest])].T

    def _depth(self, dots: Floats) -> Floats:
        """Return how deep dots of x, y and half-width, (..., 3), metres, lie on bare paper."""
        return np.asarray(dots[..., 2] + _SLACK - self._away[0][self._samples(dots)])

    def _samples(self, dots: Floats) -> tuple[Ints, Ints]:
        """Return the rows and the columns of dots, (..., 2 or more), metres, in the field of distances."""
        height, width = self._away[0].shape
        place = (dots[..., :2] * self._samples_per_metre).astype(int)
        return place[..., 1].clip(0, height - 1), place[..., 0].clip(0, width - 1)

    @property
    def _samples_per_metre(self) -> float:
        return len(self._away[0]) / self.canvas.height

    @cached_property
    def _away(self) -> tuple[Floats, Floats]:
        """Signed distance from bare paper, metres, (h, w), half a sample too small or more, and slopes, (2, h, w)."""
        finer = max(1, min(_FINER, _FINE_PX // max(self.bare.shape)))
        bare = self.bare.repeat(finer, 0).repeat(finer, 1)
        scale = bare.shape[0] / self.canvas.height
        if bare.all():
            distance = np.full(bare.shape, -1.0)
        else:
            distance = (distance_transform_edt(~bare) - distance_transform_edt(bare) - 2) / scale
        down, across = np.gradient(distance)
        return distance, np.stack([across, down])


def _mark(trajectory: Floats, brush: Brush) -> tuple[Floats, Floats]:
    """Return the points (1, n, 2) and the half-widths (1, n), metres, of the mark that is drawn of a trajectory."""
    points, half_widths, _ = brush.bare_mark(refine([trajectory])[0])
    return points[None], half_widths[None]


def _at(places: Floats, path: Floats) -> Floats:
    """Return the rows of a path (n, k) at places (m,), which count them and go on between them, (m, k)."""
    return np.column_stack([np.interp(places, np.arange(len(path)), column) for column in path.T])
