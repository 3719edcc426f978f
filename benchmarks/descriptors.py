"""Each stroke of a drawing among its neighbours, as numbers that no motion and no scale of the drawing changes.

The unit of length is the drawing's median stroke length. θ is the direction of a stroke's principal axis, λ its
straightness: (a - b) / (a + b) of the second moments along and across it.
"""

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from maulstick.strokes.strokes import path_lengths, resample

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NAMES = (
    "median gap",
    "least gap",
    "gap variation",
    "gap share",
    "parallel",
    "oblique",
    "centre distance",
    "end to end",
    "length ratio",
    "spread",
    "crossing",
    "rank distance",
    "jump",
    "same direction",
    "goes on along",
)
ORDERLESS = 11
"""So many of the numbers do not depend on the order that strokes were drawn in: the first of them."""
JUDGING = tuple(NAMES.index(name) for name in ("gap share", "spread", "crossing"))
"""Numbers that no price on features of pairs of near strokes shares."""

NEAREST = 4
_NEAR = 0.05  # a point that is as near to another stroke counts in the gap share
_STEP = 0.01  # between points that a gap is measured to
_LEAST = 0.005  # gaps below it are one: a crossing's would be 0


def describe(paths: Floats) -> Floats:
    """Numbers (N, 15) of strokes (N, n, 2) of positive length in the order drawn, N at least 5; see `NAMES`.

    Of the gap to the nearest other stroke at each point: log median, log least, log variation, share below 0.05. Over
    the four strokes with the nearest centres: mean λλ' cos 2Δθ, mean λλ' |sin 2Δθ|, log median distance of centres,
    mean (along - across) / (along + across) of the offset in the stroke's frame, mean |log ratio of lengths|, relative
    spread of the distances, share that it crosses. Of the order: log (1 + median distance in rank to the nearest
    stroke at each point), log jump from the end of the one before, cosine between their chords, and whether it lies
    along or beside that one, as above. The first stroke has the second's jump, cosine and side.
    """
    paths = paths / np.median(path_lengths(paths))
    gaps, nearest = _nearest_others(paths)
    ranks = np.median(np.abs(nearest - np.arange(len(paths))[:, None]), axis=1)
    of_order = np.column_stack([np.log1p(ranks), _steps(paths)])
    return np.column_stack([_of_gaps(gaps), _of_neighbours(paths), of_order])


def straightened(paths: Floats) -> Floats:
    """Strokes (N, n, 2) without shape: straight, on the principal axes of the strokes, as long as these extend."""
    centres, axes, _ = principal(paths)
    along = ((paths - centres[:, None]) * axes[:, None]).sum(axis=-1)
    reach = np.linspace(along.min(axis=1), along.max(axis=1), paths.shape[1], axis=1)
    return centres[:, None] + reach[..., None] * axes[:, None]


def _of_gaps(gaps: Floats) -> Floats:
    variation = gaps.std(axis=1) / gaps.mean(axis=1).clip(min=_LEAST)
    logs = [np.log(each.clip(min=_LEAST)) for each in (np.median(gaps, axis=1), gaps.min(axis=1), variation)]
    return np.column_stack([*logs, (gaps < _NEAR).mean(axis=1)])


def _of_neighbours(paths: Floats) -> Floats:
    centres, axes, straightness = principal(paths)
    distances, near = (each[:, 1:] for each in cKDTree(centres).query(centres, NEAREST + 1))
    cosines = (axes[:, None] * axes[near]).sum(axis=-1)
    sines = _cross(axes[:, None], axes[near])
    both = straightness[:, None] * straightness[near]
    lengths = np.log(path_lengths(paths))
    lines = shapely.linestrings(paths)
    return np.column_stack(
        [
            (both * (cosines**2 - sines**2)).mean(axis=1),
            (both * np.abs(2 * sines * cosines)).mean(axis=1),
            np.log(np.median(distances, axis=1).clip(min=_LEAST)),
            end_to_end(centres[near] - centres[:, None], axes[:, None]).mean(axis=1),
            np.abs(lengths[near] - lengths[:, None]).mean(axis=1),
            distances.std(axis=1) / distances.mean(axis=1).clip(min=_LEAST),
            shapely.intersects(lines[:, None], lines[near]).mean(axis=1),
        ]
    )


def _steps(paths: Floats) -> Floats:
    """From each stroke to the one after: log jump, cosine between chords, along or beside (N, 3)."""
    jumps = np.linalg.norm(paths[1:, 0] - paths[:-1, -1], axis=1)
    chords = paths[:, -1] - paths[:, 0]
    chords = chords / np.linalg.norm(chords, axis=1, keepdims=True).clip(min=_LEAST)
    cosines = (chords[1:] * chords[:-1]).sum(axis=1)
    centres, axes, _ = principal(paths)
    along = end_to_end(np.diff(centres, axis=0), axes[:-1])
    steps = np.column_stack([np.log(jumps.clip(min=_LEAST)), cosines, along])
    return np.concatenate([steps[:1], steps])


def end_to_end(offsets: Floats, axes: Floats) -> Floats:
    """1 for offsets (..., 2) along the axes (..., 2), -1 for those across."""
    along, across = np.abs((offsets * axes).sum(axis=-1)), np.abs(_cross(axes, offsets))
    return (along - across) / (along + across).clip(min=_LEAST)


def _cross(a: Floats, b: Floats) -> Floats:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def principal(paths: Floats) -> tuple[Floats, Floats, Floats]:
    """Centres (N, 2), principal axes (N, 2) of length 1, and straightness (N,)."""
    centres = paths.mean(axis=1)
    away = paths - centres[:, None]
    moments, axes = np.linalg.eigh(away.transpose(0, 2, 1) @ away)
    across, along = moments.T
    return centres, axes[..., 1], (along - across) / (along + across)


def _nearest_others(paths: Floats) -> tuple[Floats, Ints]:
    """Distance from each point to the nearest other stroke, and which that is, (N, n) each.

    Two different strokes differ in some binary digit of their numbers. So for each digit those that have it look among
    those that do not, and every stroke meets every other, but never itself.
    """
    finer = [resample(path, 2 + int(length / _STEP)) for path, length in zip(paths, path_lengths(paths), strict=True)]
    points, of = np.concatenate(finer), np.repeat(np.arange(len(paths)), [len(each) for each in finer])
    numbers = np.arange(len(paths))
    gaps, nearest = np.full(paths.shape[:2], np.inf), np.zeros(paths.shape[:2], dtype=np.int64)
    for digit in range((len(paths) - 1).bit_length()):
        for value in (0, 1):
            ours, theirs = numbers[numbers >> digit & 1 == value], np.flatnonzero(of >> digit & 1 != value)
            found, rows = cKDTree(points[theirs]).query(paths[ours])
            nearer = found < gaps[ours]
            gaps[ours] = np.where(nearer, found, gaps[ours])
            nearest[ours] = np.where(nearer, of[theirs][rows], nearest[ours])
    return gaps, nearest
