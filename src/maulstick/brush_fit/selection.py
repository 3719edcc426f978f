"""Choice of additions to the paper's seven numbers, by how well a machine would draw strokes that were held out."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import count

import numpy as np
import torch
from torch import Tensor

from maulstick.brush_fit import descent
from maulstick.brush_fit.descent import Unknowns, descend
from maulstick.brush_fit.evidence import ENOUGH, Evidence
from maulstick.brush_fit.executed import Executed
from maulstick.brush_fit.initialise import first_guess
from maulstick.storage.arrays import Bools, Floats, Ints

FAINT = "faint"
ADDITIONS = (*descent.ADDITIONS, FAINT)
"""Names of what may be added to the paper's brush."""

_DIRECTED = {"lag", "nib"}
"""Additions that depend on where a stroke goes, so that flat strokes say little of what they do to bent ones."""

STEPS = 350
"""Steps of descent of a candidate, and of the last fit: after fewer, what is judged is not what will be executed."""

_OPENED = 5  # of so many strokes that bend about alike, one is opened once
_BETTER, _SIGMAS = 0.995, 3.0  # an addition stays if it lowers the error to that share, by so many standard errors
_SHORTEST = 1e-9  # metres: keeps the chord of a closed stroke out of the denominator


@dataclass(frozen=True)
class Split:
    """Strokes by their part in a choice, as indices, and masks of halves of those that choose.

    choosing: additions are chosen by them.  opened: nothing is; the error that is told is theirs; the more bent last.
    mixed, bent: which of the choosing ones are in one half, of two that bend alike, and of two of which one bends more.
    Where there are too few strokes to hold some out, all are choosing and opened, and nothing is chosen.
    """

    choosing: Ints
    mixed: Bools
    bent: Bools
    opened: Ints

    @classmethod
    def of(cls, paths: Sequence[Floats], seed: int) -> "Split":
        """Deal strokes (n, 3) out at random, so that those that are opened bend as much and as little as all."""
        order = np.argsort([bend(path) for path in paths], kind="stable")
        rng = np.random.default_rng(seed)
        choosing, opened = order, order
        if len(paths) >= ENOUGH:
            opened = np.array([rng.choice(alike) for alike in np.array_split(order, len(paths) // _OPENED)])
            choosing = order[~np.isin(order, opened)]
        pairs = -(-len(choosing) // 2)
        mixed = np.concatenate([rng.permutation([False, True]) for _ in range(pairs)])[: len(choosing)]
        return cls(choosing, mixed, np.arange(len(choosing)) >= pairs, opened)


def bend(path: Floats) -> float:
    """Return the largest distance of a path (n, 2 or more) from the straight line between its ends, in its unit."""
    from_start, chord = path[:, :2] - path[0, :2], path[-1, :2] - path[0, :2]
    along = np.clip(from_start @ chord / max(float(chord @ chord), _SHORTEST**2), 0, 1)
    return float(np.linalg.norm(from_start - along[:, None] * chord, axis=1).max())


@dataclass(frozen=True)
class Choice:
    """Additions that were accepted, and the mean errors per pixel of opened strokes, as a machine would draw them.

    executed: what the fit to all other strokes found.
    l1, l1_paper: with the additions, and with the paper's seven numbers alone.
    """

    additions: tuple[str, ...]
    executed: Executed
    l1: float
    l1_paper: float


def choose(evidence: Evidence, split: Split, tried: Sequence[str], progress: Callable[[str, int, int], None]) -> Choice:
    """Fit the paper's numbers, then accept one addition after another that clearly improves strokes as executed."""
    known, opened = evidence.pick(split.choosing), evidence.pick(split.opened)
    half_of = {"flat": ~split.bent, "bent": split.bent, "one": split.mixed, "other": ~split.mixed}
    halves = {name: known.pick(np.flatnonzero(half)) for name, half in half_of.items()}

    @cache
    def taught(half: str, shape: tuple[str, ...]) -> Unknowns:
        return _taught(halves[half], shape, progress)

    def judged(additions: Sequence[str], by_bend: bool) -> Tensor:
        """Errors of the half that bends more with what the other taught, or of both alike halves, each by the other."""
        shape, pales = shape_of(additions), FAINT in additions
        pairs = [("flat", "bent")] if by_bend else [("one", "other"), ("other", "one")]
        return torch.cat([Executed.of(taught(a, shape), halves[a], pales).l1(halves[b]) for a, b in pairs])

    kept: list[str] = []
    refused: dict[str, int] = {}  # number of additions that had been kept then
    for addition in (*tried, *tried) if len(evidence) >= ENOUGH else ():  # twice: one may help only beside another
        if addition in kept or refused.get(addition) == len(kept):
            continue
        by_bend = addition in _DIRECTED
        if _is_better(judged([*kept, addition], by_bend), judged(kept, by_bend)):
            kept.append(addition)
        else:
            refused[addition] = len(kept)
    paper = Executed.of(_taught(known, (), progress), known, pales=False)
    chosen = Executed.of(_taught(known, shape_of(kept), progress), known, FAINT in kept) if kept else paper
    return Choice(tuple(kept), chosen, float(chosen.l1(opened).mean()), float(paper.l1(opened).mean()))


def shape_of(additions: Sequence[str]) -> tuple[str, ...]:
    """Return the additions that a descent finds; `faint` is found from the darkness of whole strokes after it."""
    return tuple(name for name in additions if name != FAINT)


def _taught(evidence: Evidence, shape: tuple[str, ...], progress: Callable[[str, int, int], None]) -> Unknowns:
    tick = ticking(progress, " + ".join(("the paper's numbers", *shape)), STEPS)
    return descend(evidence.mosaic(), first_guess(evidence).adding(shape), STEPS, tick)


def _is_better(errors: Tensor, before: Tensor) -> bool:
    """Return whether the errors (N,) of judged strokes are clearly below those `before`."""
    gain = (before / errors).log()  # a logarithm, so that a few very bad strokes do not dominate
    certain = gain.mean() > _SIGMAS * gain.std() / math.sqrt(len(gain))
    return bool(certain and errors.mean() < _BETTER * before.mean())


def ticking(progress: Callable[[str, int, int], None], stage: str, total: int) -> Callable[[], None]:
    """Return a function that tells `progress` of one step more of `stage` each time that it is called."""
    done = count(1)
    return lambda: progress(stage, next(done), total)
