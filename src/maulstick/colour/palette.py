"""Palettes: k-means of colours in CIELAB, where distance is what the eye sees (paper: Planning)."""

import warnings
from collections.abc import Sequence
from math import ceil

import numpy as np
from PIL import Image, ImageColor, ImageDraw, ImageFont
from skimage.color import lab2rgb, rgb2lab
from threadpoolctl import threadpool_limits

from maulstick.errors import InputError
from maulstick.storage.arrays import Bools, Floats, Ints

_ROUNDS = 10  # of mixing others beside pinned paints, which is settled after a few


def mix_paints(
    colours: Floats, amounts: Floats, k: int, seed: int, pinned: Sequence[tuple[float, float, float]] = ()
) -> Floats:
    """Return at most k paints (k, 3) for colours (N, 3) that cover `amounts` (N,) of canvas, light first; all in sRGB.

    k-means in CIELAB, repeated from several starts; fewer colours than k give fewer paints.
    pinned: paints among them that are as they are; the others are for colours that none of these is nearest to.
    """
    if pinned:
        kept = np.array(pinned)
        both = np.concatenate([_mixed_beside(kept, colours, amounts, k - len(kept), seed), kept])
        return both[light_first(both)]
    from sklearn.cluster import KMeans  # takes a second to load
    from sklearn.exceptions import ConvergenceWarning

    with threadpool_limits(1), warnings.catch_warnings():  # several threads add up in any order
        warnings.simplefilter("ignore", ConvergenceWarning)  # fewer different colours than k
        lab = rgb2lab(colours)
        k = min(k, len(np.unique(lab.round(3), axis=0)))
        found = KMeans(k, n_init=4, random_state=seed).fit(lab, sample_weight=amounts)
    centres = found.cluster_centers_[np.argsort(-found.cluster_centers_[:, 0])]
    paints: Floats = np.clip(lab2rgb(centres), 0, 1)
    return paints


def _mixed_beside(pinned: Floats, colours: Floats, amounts: Floats, k: int, seed: int) -> Floats:
    """Return at most k paints for those of the colours that none of the pinned paints (n, 3) is nearest to."""
    others, left = pinned[:0], np.ones(len(colours), dtype=bool)
    for _ in range(_ROUNDS if k > 0 else 0):
        if not left.any():
            return pinned[:0]
        others = mix_paints(colours[left], amounts[left], k, seed)
        before, left = left, nearest_paint(colours, np.concatenate([pinned, others])) >= len(pinned)
        if np.array_equal(left, before):
            break
    return others


def nearest_paint(colours: Floats, paints: Floats, allowed: Bools | None = None) -> Ints:
    """Return the index (N,) of the paint (k, 3) nearest in CIELAB to each colour (N, 3), sRGB in [0, 1].

    allowed: (N, k), which paints each may have; all when left out.
    """
    difference = rgb2lab(colours)[:, None] - rgb2lab(paints)[None]
    away = (difference**2).sum(-1)
    nearest: Ints = np.argmin(away if allowed is None else np.where(allowed, away, np.inf), axis=1)
    return nearest


def lightness(colours: Floats) -> Floats:
    """CIELAB lightness (N,) in [0, 100] of colours (N, 3), sRGB in [0, 1]."""
    lab: Floats = rgb2lab(colours)[:, 0]
    return lab


def light_first(colours: Floats) -> Ints:
    """Return the indices (N,) of colours (N, 3), sRGB in [0, 1], from the lightest to the darkest."""
    return np.argsort(-lightness(colours), kind="stable")


def parse_colour(text: str) -> tuple[float, float, float]:
    """Return sRGB in [0, 1] of a colour's name, such as ``black``, or of ``#rrggbb``. Raises InputError for others."""
    refusal = InputError(f"{text!r} is not a colour; write a name such as black, or #rrggbb")
    try:
        red, green, blue = ImageColor.getrgb(text)[:3]
    except ValueError:
        raise refusal from None
    if not 0 <= min(red, green, blue) <= max(red, green, blue) <= 255:  # Pillow takes rgb(999, 0, 0) for a colour
        raise refusal
    return red / 255, green / 255, blue / 255


def swatches(paints: Sequence[tuple[float, float, float]], labels: Sequence[str]) -> Image.Image:
    """Return a picture of the paints, sRGB in [0, 1], one labelled row per paint, as wide as the labels need."""
    height, row, left = 56, 48, 152
    font = ImageFont.load_default(20)
    longest = max((ceil(font.getlength(label)) for label in labels), default=0)
    width = max(480, left + longest + 8)
    sheet = Image.new("RGB", (width, height * max(len(paints), 1)), "white")
    draw = ImageDraw.Draw(sheet)
    for i, (paint, label) in enumerate(zip(paints, labels, strict=True)):
        top = height * i + (height - row) // 2
        fill = tuple(round(255 * channel) for channel in paint)
        draw.rectangle((8, top, 136, top + row), fill=fill, outline="lightgrey")
        draw.text((left, top + row // 2), label, fill="black", font=font, anchor="lm")
    return sheet
