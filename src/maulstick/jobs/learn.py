"""Learning a style from recorded strokes."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from maulstick.errors import InputError, Remedy
from maulstick.recording.mocap.take import KIND as TAKE
from maulstick.storage.arrays import Floats, kind_of
from maulstick.strokes.ink import Ink, read_ink
from maulstick.strokes.strokes import POINTS, Strokes, read_strokes

if TYPE_CHECKING:
    from maulstick.style.store import Fitted

Recorded = Ink | Strokes | str | Path
"""Ink, strokes, or the path of a file of one of them."""

KINDS: Final = ("exemplar", "trajvae")
"""Kinds of style that are learned from strokes."""


def strokes_of(recorded: Sequence[Recorded]) -> Strokes:
    """Return the strokes of all recordings together, each recording farther right than any near stroke of another.

    Raises InputError for a file that holds neither ink nor strokes, and for strokes that are given twice.
    """
    parts = [_strokes_in(each) for each in recorded]
    if not parts:
        raise InputError("there are no strokes to learn from; give ink, or the path of a recording")
    contents = [part.trajectories.tobytes() for part in parts if len(part)]
    if len(contents) != len(set(contents)):
        raise InputError("a recording, or its copy, is named twice, and its strokes would count twice; name each once")
    return Strokes(
        np.concatenate([part.trajectories for part in parts]),
        np.concatenate([part.times for part in parts]),
        np.concatenate(_side_by_side(parts)),
    )


def learn_style(name: str, strokes: Strokes, kind: str) -> "Fitted":
    """Return a style of this kind, learned from the strokes. Raises InputError where they do not make one."""
    if kind not in KINDS:
        raise InputError.of_choice("kind", kind, KINDS)
    from maulstick.style.hand import Hand  # these load torch

    hand = Hand.of(strokes)
    if kind == "exemplar":
        from maulstick.style.exemplar import Exemplar
        from maulstick.style.store import load_hands

        return Exemplar.fit(name, hand, load_hands())
    from maulstick.style.train import fine_tune, pretrained

    return fine_tune(pretrained(), hand, seed=0, name=name)


def _side_by_side(parts: list[Strokes]) -> list[Floats]:
    """Return poses of all parts; each but the first is moved to the right of those before, by the longest stroke."""
    apart = max(part.lengths.max(initial=0.0) for part in parts)
    poses: list[Floats] = []
    right = None
    for part in (part for part in parts if len(part)):
        xs = part.placed()[..., 0]
        moved = 0.0 if right is None else right + apart - xs.min()
        poses.append(part.poses + np.array([moved, 0.0, 0.0]))
        right = xs.max() + moved
    return poses or [parts[0].poses]


def _strokes_in(recorded: Recorded) -> Strokes:
    if isinstance(recorded, Ink):
        return Strokes.of(recorded)
    if isinstance(recorded, Strokes):
        return _of_points(recorded)
    kind = kind_of(recorded)
    if kind == "ink":
        return Strokes.of(read_ink(recorded))
    if kind == "strokes":
        return _of_points(read_strokes(recorded), f" in {recorded}")
    if kind == TAKE:
        raise InputError(f"{recorded} holds a take", Remedy.READ_TAKE)
    raise InputError(f"{recorded} is neither ink nor strokes", Remedy.MAKE_INK)


def _of_points(strokes: Strokes, where: str = "") -> Strokes:
    if (points := strokes.trajectories.shape[1]) != POINTS:
        raise InputError.of_range(f"the number of points of a stroke{where}", points, f"{POINTS}")
    return strokes
