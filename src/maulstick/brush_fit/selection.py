"""Choice of additions to the paper's seven numbers, by how well a machine would draw strokes that were held out."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import count

import numpy as np
import torch
from torch import Tensor

from maulstick.brush_fit import descent
from maulstick.brush_fit.descent import descend
from maulstick.brush_fit.evidence import ENOUGH, Evidence
from maulstick.brush_fit.executed import Executed
from maulstick.brush_fit.initialise import first_guess
from maulstick.storage.arrays import Bools, Floats, Ints

FAINT = "faint"
ADDITIONS = (*descent.ADDITIONS, FAINT)
"""Names of what may be added to the paper's brush."""

_DIRECTED = {"lag", "nib"}
"""Additions that depend on where a stroke goes, so that flat strokes say little of what they do to bent ones."""

STEPS = 200
"""Steps of descent for each candidate."""

_OPENED = 5  # of so many strokes that bend about alike, one is opened once
_BETTER = 0.995  # an addition stays if it lowers the error of two halves to that share,
_SIGMAS, _SIGMAS_EACH = 2.5, 1.0  # by so many standard errors together, and by so many each
_SHORTEST = 1e-9  # metres: keeps the chord of a closed stroke out of the denominator


@dataclass(frozen=True)
class Split:
    """Strokes by their part in a choice, as indices, or as a mask of those that choose.

    choosing: something is chosen by them: what is fitted to one half of them is judged by the other, and the reverse.
    mixed, bent: which of these are in one half, of two that bend alike, and of two of which one bends more.
    opened: nothing is chosen by them, and the error that is told is theirs.
    Where there are too few strokes to hold some out, all are choosing and opened, and nothing is to be chosen.
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

    @cache
    def judged(additions: tuple[str, ...], by_bend: bool) -> tuple[Tensor, Tensor]:
        """Errors of each half with what the other taught."""
        first = split.bent if by_bend else split.mixed
        halves = known.pick(np.flatnonzero(first)), known.pick(np.flatnonzero(~first))
        tick = ticking(progress, " + ".join(("seven", *additions)), 2 * STEPS)
        return fitted(halves[1], additions, tick).l1(halves[0]), fitted(halves[0], additions, tick).l1(halves[1])

    kept: tuple[str, ...] = ()
    refused: dict[str, int] = {}  # number of additions that had been kept then
    for addition in (*tried, *tried) if len(evidence) >= ENOUGH else ():  # twice: one may help only beside another
        if addition in kept or refused.get(addition) == len(kept):
            continue
        by_bend = addition in _DIRECTED
        if _is_better(judged((*kept, addition), by_bend), judged(kept, by_bend)):
            kept = (*kept, addition)
        else:
            refused[addition] = len(kept)
    chosen = fitted(known, kept, ticking(progress, "what was chosen", STEPS))
    paper = fitted(known, (), ticking(progress, "the paper's numbers", STEPS)) if kept else chosen
    return Choice(kept, chosen, float(chosen.l1(opened).mean()), float(paper.l1(opened).mean()))


def fitted(evidence: Evidence, additions: Collection[str], progress: Callable[[], None]) -> Executed:
    """Fit the paper's numbers and some additions. `progress` is called `STEPS` times."""
    start = first_guess(evidence).adding(name for name in additions if name != FAINT)
    return Executed.of(descend(evidence.mosaic(), start, STEPS, progress), evidence, FAINT in additions)


def _is_better(errors: tuple[Tensor, Tensor], before: tuple[Tensor, Tensor]) -> bool:
    """Return whether the errors of two halves are clearly below those `before`, and those of neither by chance."""
    gains = [(old / new).log() for old, new in zip(before, errors, strict=True)]  # so that no bad stroke dominates
    less = torch.cat(errors).mean() < _BETTER * torch.cat(before).mean()
    return bool(less and _certainty(torch.cat(gains)) > _SIGMAS and min(map(_certainty, gains)) > _SIGMAS_EACH)


def _certainty(gain: Tensor) -> float:
    """Return the mean of (N,) in its standard errors."""
    return float(gain.mean() / gain.std().clamp(min=1e-9)) * len(gain) ** 0.5


def ticking(progress: Callable[[str, int, int], None], stage: str, total: int) -> Callable[[], None]:
    """Return a function that tells `progress` of one step more of `stage` each time that it is called."""
    done = count(1)
    return lambda: progress(stage, next(done), total)
