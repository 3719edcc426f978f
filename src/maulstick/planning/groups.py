"""Groups of a hand's strokes, placed one after another where the picture misses most ink, along its edges."""

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import gaussian_filter

from maulstick.planning.placement import Places, at_pixels, colours_at, edge_size
from maulstick.planning.tracing import NOTHING_ALONG, Along
from maulstick.storage.arrays import Complexes, Floats, Ints
from maulstick.strokes.strokes import path_lengths
from maulstick.style.arrangement import Arrangement

_TRIED = 48  # places that are tried for a group: more find a better one, and take longer
_UNWANTED = 0.02  # of the most that is missing: what is less is none
_MISPLACED = 2.0  # times the mean of what is missing: ink where none is, by eye, or long strokes lie across faces
_BLUR_IN_SPACINGS = 0.5  # as fine as so many strokes can draw a picture
_CELLS_IN_BLUR = 2  # side of the cells that ink is counted in
_REACH_IN_BLURS = 4  # farther than this no ink is blurred


def place_groups(
    target: Floats,
    lines: Complexes,
    density: Floats,
    arrangement: Arrangement,
    groups: Sequence[Ints],
    room: float,
    scale: float,
    rng: np.random.Generator,
    along: Along = NOTHING_ALONG,
) -> tuple[Places, Ints]:
    """Place groups of a hand by the density (H, W) along lines (H, W) of a target (C, H, W).

    Return the places, and the rows of the hand's strokes that they are like, (N,): those that lie `along` the target's
    lines already, then the longest groups first.
    Each is laid where its lines miss most of what the density wants, turned along the lines there; where there are none
    it lies as the hand drew it.

    lines: as `directions` returns them.  groups: rows of the hand's strokes that lie together.
    room: distance between strokes, pixels.  scale: pixels per metre.
    """
    height, width = density.shape
    paths = arrangement.paths * scale
    chosen = sorted(groups, key=lambda rows: -path_lengths(paths[rows]).sum())
    strokes = np.concatenate([along.rows, *chosen])
    wanted = density + 1e-9  # an empty density counts as an even one
    ink = _Ink(wanted * (path_lengths(paths[strokes]).sum() / wanted.sum()), _BLUR_IN_SPACINGS * room)
    for path in along.paths:
        ink.draw(path[None])
    centres, turns = [along.paths.mean(axis=1)], [along.turns]
    for rows in chosen:
        middle = paths[rows].mean(axis=(0, 1))
        tried = ink.likely(_TRIED, rng)
        at = at_pixels(tried, width, height)
        turn = _turns(arrangement.directions[rows].sum(), lines[at])
        moved = tried[:, None, None] + _turned(paths[rows] - middle, turn)
        best = int(np.argmax(ink.missing(moved)))
        ink.draw(moved[best])
        centres.append(moved[best].mean(axis=1))
        turns.append(np.full(len(rows), turn[best]))
    where = np.concatenate(centres)
    places = Places(
        where,
        arrangement.angles[strokes] + np.concatenate(turns),
        np.full(len(where), room),
        colours_at(target, where, edge_size(room, height, width)),
    )
    return places, strokes


def choose_groups(arrangement: Arrangement, count: int, rng: np.random.Generator) -> list[Ints]:
    """Draw groups of a hand, of `count` strokes in all, each once before one is drawn again; the last is cut to fit."""
    chosen: list[Ints] = []
    left = count
    while left:
        for group in rng.permutation(len(arrangement.groups)):
            rows = arrangement.groups[group][:left]
            if len(rows):
                chosen.append(rows)
            left -= len(rows)
    return chosen


def without(groups: Sequence[Ints], rows: Ints) -> list[Ints]:
    """Return groups of a hand's strokes without some of them, each row as often as it is among those."""
    taken = np.bincount(rows, minlength=1 + max((int(group.max()) for group in groups), default=0))
    left = []
    for group in groups:
        stays = taken[group] == 0  # no group has a stroke twice
        np.subtract.at(taken, group[~stays], 1)
        if stays.any():
            left.append(group[stays])
    return left


def _turns(group: complex, lines: Complexes) -> Floats:
    """Turns (k,), at most a quarter, of a group that lies this way: along sure lines, and without lines none."""
    main = np.angle(group)
    wanted = lines + (1 - np.abs(lines)) * np.exp(1j * main)
    turns: Floats = ((np.angle(wanted) - main) / 2 + np.pi / 2) % np.pi - np.pi / 2
    return turns


def _turned(paths: Floats, turns: Floats) -> Floats:
    """Paths (m, n, 2) turned about the origin by each of the turns (k,), (k, m, n, 2)."""
    x, y = paths[..., 0], paths[..., 1]
    cos, sin = (each[:, None, None] for each in (np.cos(turns), np.sin(turns)))
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


class _Ink:
    """What ink is still missing, blurred: lengths of line in cells, in pixels."""

    def __init__(self, wanted: Floats, blur: float) -> None:
        self._side = max(1, int(blur / _CELLS_IN_BLUR))
        self._sigma = blur / self._side
        rows, columns = (-(-size // self._side) for size in wanted.shape)
        padded = np.pad(
            wanted, [(0, n * self._side - size) for n, size in zip((rows, columns), wanted.shape, strict=True)]
        )
        cells = padded.reshape(rows, self._side, columns, self._side).sum(axis=(1, 3))
        self._size = np.array(wanted.shape[::-1])
        self._missing = gaussian_filter(cells, self._sigma, mode="constant")
        wants = self._missing > _UNWANTED * self._missing.max()
        self._misplaced = np.where(wants, 0.0, _MISPLACED * self._missing[wants].mean())

    def likely(self, count: int, rng: np.random.Generator) -> Floats:
        """Draw places (count, 2), pixels, where much is missing."""
        much = np.square(self._missing.clip(min=0)).ravel() + 1e-30
        cells = rng.choice(much.size, count, p=much / much.sum())
        corners = np.stack([cells % self._missing.shape[1], cells // self._missing.shape[1]], axis=1)
        places: Floats = np.minimum((corners + rng.random((count, 2))) * self._side, self._size)
        return places

    def missing(self, paths: Floats) -> Floats:
        """Return how much is missing along paths (k, m, n, 2) on average, (k,).

        Off the sheet there is far too much, and too much where none was missing at first.
        """
        cells = self._cells(paths)
        found = self._missing[cells] - self._misplaced[cells]
        outside = ((paths < 0) | (paths > self._size)).any(axis=-1)
        worst = -np.abs(self._missing).max() - self._misplaced.max()
        means: Floats = np.where(outside, worst, found).mean(axis=(1, 2))
        return means

    def draw(self, paths: Floats) -> None:
        """Draw paths (m, n, 2)."""
        row, column = self._cells(paths)
        reach = int(_REACH_IN_BLURS * self._sigma) + 1
        top, left = max(0, row.min() - reach), max(0, column.min() - reach)
        drawn = np.zeros_like(self._missing[top : row.max() + reach + 1, left : column.max() + reach + 1])
        np.add.at(drawn, (row - top, column - left), (path_lengths(paths) / paths.shape[1])[:, None])
        part = self._missing[top : top + drawn.shape[0], left : left + drawn.shape[1]]
        part -= gaussian_filter(drawn, self._sigma, mode="constant")

    def _cells(self, points: Floats) -> tuple[Ints, Ints]:
        return at_pixels(points / self._side, self._missing.shape[1], self._missing.shape[0])
