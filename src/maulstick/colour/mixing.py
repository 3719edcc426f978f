"""Recipes for mixing a wanted colour from paints: Kubelka and Munk's theory with one constant (docs/paints.md)."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from math import comb, gcd

import numpy as np
from skimage.color import deltaE_ciede94, deltaE_ciede2000, rgb2lab

from maulstick.colour.srgb import colours_of, light_of
from maulstick.colour.tubes import NamedPaint
from maulstick.errors import InputError
from maulstick.storage.arrays import Floats, Ints

_VEIL = 0.02
"""Reflectance of every paint's surface: without it a black would have infinite K/S and hide all other paints."""

_MOST_PARTS = 12  # in one mix, so that it can be measured out
_TINTS = (16, 24, 40)  # parts of one paint, with ...
_TINGE = 4  # ... at most so many parts of the others
_MOST_PAINTS = 4  # in one mix
_MOST_MIXES = 1_200_000  # that are compared: all mixes of up to 16 paints
_SHORTLIST = 400  # mixes of each number of paints, nearest by CIE94, that are compared by CIEDE2000, which is slow
_UNSEEN = 1.0  # CIEDE2000: a difference that nobody sees, so the simpler recipe wins
_VERDICTS = ((1.0, "the same to the eye"), (2.5, "very near"), (5.0, "near"))  # below each CIEDE2000


@dataclass(frozen=True)
class Recipe:
    """A mix of paints for a wanted colour.

    parts: names of paints and whole numbers of parts, most first.  colour: of the mix, sRGB in [0, 1].
    error: difference from the wanted colour, CIEDE2000.
    """

    parts: tuple[tuple[str, int], ...]
    colour: tuple[float, float, float]
    error: float

    @property
    def verdict(self) -> str:
        """A phrase for how near the mix comes to the wanted colour."""
        return _verdict(self.error)

    def __str__(self) -> str:
        if len(self.parts) == 1:
            return f"{self.parts[0][0]} alone"
        return " + ".join(f"{count} part{'s' if count > 1 else ''} {name}" for name, count in self.parts)


@dataclass(frozen=True)
class _Mixes:
    """All mixes of m paints. paints: (S, m) indices.  parts: (T, m).  colours, lab: (S * T, 3), S first."""

    paints: Ints
    parts: Ints
    colours: Floats
    lab: Floats


def mixed_colours(colours: Floats, parts: Ints) -> Floats:
    """Return the colours (..., T, 3) of mixes of k paints (..., k, 3) with parts (T, k) of them; sRGB in [0, 1].

    Kubelka and Munk (1931): a paint of reflectance R has K/S = (1 - R)² / 2R, which mixes in proportion to the parts.
    """
    reflectance = _VEIL + (1 - _VEIL) * light_of(colours)
    absorption = (1 - reflectance) ** 2 / (2 * reflectance)
    mixed = parts @ absorption / parts.sum(axis=-1, keepdims=True)
    reflected = 1 / (1 + mixed + np.sqrt(mixed * (mixed + 2)))
    return colours_of((reflected - _VEIL) / (1 - _VEIL))


def mixing_advice(wanted: Floats, base: Sequence[NamedPaint]) -> tuple[Recipe, ...]:
    """Return a recipe for each wanted colour (k, 3), sRGB in [0, 1], from the paints of the base.

    It is the simplest (fewest paints, then fewest parts) of those that look like the nearest one, by CIEDE2000, of all
    mixes of at most 4 paints (3 out of more than 16, 2 out of more than 31) in at most 12 parts, or with 16, 24 or 40
    of one paint to at most 4 of the others.
    Raises InputError where there are no paints.
    """
    if not base:
        raise InputError("there are no paints to mix from; name at least one")
    colours = np.array([paint.colour for paint in base], dtype=np.float64)
    kinds = [_mixes(colours, count) for count in range(1, _paints_in_a_mix(len(base)) + 1)]
    return tuple(_recipe(rgb2lab(colour[None]), kinds, base) for colour in np.asarray(wanted, dtype=np.float64))


def _paints_in_a_mix(paints: int) -> int:
    """Number of paints that a mix may have if no more than `_MOST_MIXES` are to be compared."""
    counts = np.cumsum([comb(paints, m) * len(_splits(m)) for m in range(1, _MOST_PAINTS + 1)])
    return min(paints, max(2, int((counts <= _MOST_MIXES).sum())))


def _mixes(colours: Floats, count: int) -> _Mixes:
    paints = np.array(list(combinations(range(len(colours)), count)), dtype=np.int64)
    parts = np.array(_splits(count), dtype=np.int64)
    mixed = mixed_colours(colours[paints], parts).reshape(-1, 3)
    return _Mixes(paints, parts, mixed, rgb2lab(mixed))


def _splits(count: int) -> list[tuple[int, ...]]:
    """Return the numbers of parts that a mix of `count` paints may have, in lowest terms."""
    even = _shared(_MOST_PARTS, count)
    tints = [
        (*rest[:place], much, *rest[place:])
        for much in _TINTS
        for rest in _shared(_TINGE, count - 1)
        for place in range(count)
    ]
    return [split for split in (*even, *tints) if gcd(*split) == 1]


def _shared(most: int, count: int) -> list[tuple[int, ...]]:
    """Return all ways to share at most `most` parts among `count` paints, at least one each."""
    ends = combinations(range(1, most + 1), count)  # where the parts of each paint end
    return [tuple(later - earlier for earlier, later in pairwise((0, *end))) for end in ends]


def _recipe(wanted: Floats, kinds: Sequence[_Mixes], base: Sequence[NamedPaint]) -> Recipe:
    """Return the simplest of the nearest mixes; CIE94, quick and similar to CIEDE2000, makes the shortlist."""
    found: list[tuple[float, _Mixes, int]] = []
    for mixes in kinds:
        rough = deltaE_ciede94(wanted, mixes.lab)
        short = np.argsort(rough, kind="stable")[:_SHORTLIST]
        for index, error in zip(short, deltaE_ciede2000(wanted, mixes.lab[short]), strict=True):
            found.append((float(error), mixes, int(index)))
    least = min(error for error, _, _ in found)
    alike = [each for each in found if each[0] <= least + _UNSEEN and _verdict(each[0]) == _verdict(least)]
    error, mixes, index = min(alike, key=lambda each: (*_effort(each[1], each[2]), each[0]))
    chosen, split = divmod(index, len(mixes.parts))
    named = [(base[p].name, int(n)) for p, n in zip(mixes.paints[chosen], mixes.parts[split], strict=True)]
    red, green, blue = mixes.colours[index].tolist()
    return Recipe(tuple(sorted(named, key=lambda each: -each[1])), (red, green, blue), error)


def _verdict(error: float) -> str:
    return next((words for most, words in _VERDICTS if error < most), "out of reach")


def _effort(mixes: _Mixes, index: int) -> tuple[int, int]:
    """Number of paints and number of parts of a mix: what makes it laborious."""
    return mixes.parts.shape[1], int(mixes.parts[index % len(mixes.parts)].sum())
