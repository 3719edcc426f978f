"""Placement of initial strokes: places by tone and detail, directions along the picture's edges."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Literal

import numpy as np
import torch
from numpy.lib.stride_tricks import sliding_window_view
from PIL import Image
from scipy.ndimage import gaussian_filter, gaussian_gradient_magnitude, sobel
from scipy.spatial import cKDTree
from torch import Generator

from maulstick.painting.brush import Brush
from maulstick.planning.parameters import StrokeParameters
from maulstick.rendering.kernels.cpu import THREADS
from maulstick.storage.arrays import Floats, Ints
from maulstick.style import Style

HALF_WIDTH_IN_SPACINGS = 0.4
"""Half-width of an initial stroke, in spacings: it nearly fills the room between its neighbours."""

_ENOUGH_PX = 256  # pixels over the height: densities are blurred by so much that more pixels show no more
_ROUNDS = 12  # rounds of Lloyd's iteration: after so many the places are evenly spread; each costs time
_SAMPLES_PER_STROKE = 60  # random samples of the density per stroke, whose mean becomes the stroke's place
_TRUNCATED = 4.0  # standard deviations at which a Gaussian ends, as SciPy's does
_MOST_AT_ONCE = 4_000_000  # pixels about points that are copied at once: 32 MB
_SHARES_OF_LARGEST = (1.0, 0.66, 0.44, 0.3, 0.2)  # of the largest half-width: those tried for a moved stroke
_LENGTH_IN_SPACINGS = 2.0  # length of an initial stroke: it reaches its neighbours along an edge


@dataclass(frozen=True)
class Places:
    """N places for strokes.

    centres: (N, 2) pixels.  angles: (N,) radians.  spacing: (N,) pixels, the distance to neighbours.  colours: (N, C).
    """

    centres: Floats
    angles: Floats
    spacing: Floats
    colours: Floats


def _on_fewer_pixels(density: Callable[[Floats], Floats]) -> Callable[[Floats], Floats]:
    """Let a density (H, W) of images (C, H, W) be found on 256 to 511 pixels over the height where there are more."""

    @wraps(density)
    def found(images: Floats) -> Floats:
        height, width = images.shape[1:]
        times = height // _ENOUGH_PX
        if times < 2:
            return density(images)
        size = max(width // times, 1), height // times
        fewer = np.stack([_resized(image, size, Image.Resampling.BOX) for image in images])
        return _resized(density(fewer), (width, height), Image.Resampling.BILINEAR)

    return found


def _resized(field: Floats, size: tuple[int, int], by: Image.Resampling) -> Floats:
    """Return a field (H, W) at another size, width by height."""
    return np.array(Image.fromarray(field.astype(np.float32)).resize(size, by), dtype=np.float64)


@_on_fewer_pixels
def detail(target: Floats) -> Floats:
    """Return the density (H, W) of strokes for opaque colours: largest where the target (C, H, W) changes."""
    height = target.shape[1]
    change = np.zeros(target.shape[1:])
    for sigma in (max(height / 256, 0.7), max(height / 100, 0.7)):
        slopes = [gaussian_gradient_magnitude(channel, sigma) for channel in target]
        change += np.sqrt(np.square(slopes).sum(axis=0)) * sigma
    density: Floats = gaussian_filter(change, height / 128) + 0.25 * change.mean()
    return density


@_on_fewer_pixels
def unlike(difference: Floats) -> Floats:
    """Return the density (H, W) of strokes that would mend a difference (C, H, W)."""
    blur = difference.shape[1] / 100
    density: Floats = np.sum([gaussian_filter(channel, blur) ** 2 for channel in difference], axis=0)
    return density


def find_places(target: Floats, density: Floats, count: int, rng: np.random.Generator, room: float = np.inf) -> Places:
    """Return `count` places on the target (C, H, W), spread by the density (H, W), along the edges of the target.

    room: the largest spacing that a place is given, pixels.

    Places come from weighted Voronoi stippling, directions from the structure tensor; where it has no direction they
    are drawn at random.
    """
    centres, spacing = _stipple(density, count, rng)
    height, width = density.shape
    spacing = spacing.clip(max=room)
    sigma = edge_size(float(np.median(spacing)), height, width)
    along_edge, coherence = _directions(*blurred_at(_structure(target), centres, sigma, "edge"))
    wander = rng.normal(size=count) * (1 - coherence) * np.pi / 2
    return Places(centres, along_edge + wander, spacing, colours_at(target, centres, sigma))


def edge_size(spacing: float, height: int, width: int) -> float:
    """Return how large edges are that strokes of this spacing show: a Gaussian's standard deviation, all in pixels."""
    return max(1.0, min(spacing / 3, min(height, width) / 40))


def edges(target: Floats, sigma: float) -> tuple[Floats, Floats]:
    """Return the angle along the edges of the target (C, H, W), radians, and in [0, 1] how sure it is, (H, W) each.

    They are those of the structure tensor of all channels together.
    """
    return _directions(*(gaussian_filter(each, sigma, mode="nearest") for each in _structure(target)))


def _structure(target: Floats) -> Floats:
    """Return the structure tensor of a target (C, H, W), not blurred yet: rows squared, by columns, columns squared."""
    structure = np.zeros((3, *target.shape[1:]))
    for channel in target:
        r, c = (sobel(channel, axis, mode="nearest") for axis in (0, 1))
        for total, one, other in zip(structure, (r, r, c), (r, c, c), strict=True):
            total += one * other
    return structure


def _directions(rr: Floats, rc: Floats, cc: Floats) -> tuple[Floats, Floats]:
    """Return what `edges` does, of a structure tensor that is blurred."""
    return 0.5 * np.arctan2(2 * rc, cc - rr) + np.pi / 2, np.hypot(cc - rr, 2 * rc) / (rr + cc + 1e-6)


def colours_at(target: Floats, centres: Floats, sigma: float) -> Floats:
    """Return the colours (N, C) of the target (C, H, W) about centres (N, 2), pixels."""
    return blurred_at(target, centres, sigma / 2, "symmetric").T


def blurred_at(images: Floats, points: Floats, sigma: float, beyond: Literal["edge", "symmetric"]) -> Floats:
    """Return what images (C, H, W) are about points (N, 2), blurred by a Gaussian of `sigma`, all in pixels: (C, N).

    It is `gaussian_filter` at these pixels alone, of which there are far fewer. beyond: how `np.pad` goes on outside.
    """
    radius = int(_TRUNCATED * sigma + 0.5)
    taps = np.exp(-0.5 * (np.arange(-radius, radius + 1) / max(sigma, 1e-9)) ** 2)
    taps /= taps.sum()
    padded = np.pad(images, ((0, 0), (radius, radius), (radius, radius)), beyond)
    around = sliding_window_view(padded, (len(taps), len(taps)), axis=(1, 2))
    row, column = at_pixels(points, images.shape[2], images.shape[1])
    parts = np.array_split(np.arange(len(points)), 1 + len(points) * len(images) * len(taps) ** 2 // _MOST_AT_ONCE)
    return np.concatenate([around[:, row[part], column[part]] @ taps @ taps for part in parts], axis=1)


def sizes_at(difference: Floats, centres: Floats, largest: float) -> Floats:
    """Return the half-widths (N,) that strokes at centres (N, 2) need to mend a difference (C, H, W), all in pixels.

    It is the standard deviation of the blur, up to the largest, that leaves most of the difference; a wider blur
    counts more, by its square root, since a stroke as wide mends more. On a disc it is about a third of its radius.
    """
    sizes = [share * largest for share in _SHARES_OF_LARGEST]
    left = [np.square(blurred_at(difference, centres, size, "symmetric")).sum(axis=0) * size**0.5 for size in sizes]
    found: Floats = np.array(sizes)[np.argmax(left, axis=0)]
    return found


def at_pixels(points: Floats, width: int, height: int) -> tuple[Ints, Ints]:
    """Return row and column of the pixels that points (..., 2) lie in; of those outside, the nearest."""
    row, column = (np.clip(points[..., i].astype(int), 0, size - 1) for i, size in ((1, height), (0, width)))
    return row, column


def start_strokes(
    places: Places,
    style: Style,
    brush: Brush,
    pixels_per_metre: float,
    generator: Generator,
    like: torch.Tensor | None = None,
) -> StrokeParameters:
    """Return strokes of the style at the places, of the length that the style allows for the room there.

    like: standardised paths (N, n, 2), metres, each of which one stroke is like, as far as the style has any like it.
    """
    room = _tensor(_LENGTH_IN_SPACINGS * places.spacing / pixels_per_metre)
    codes, knots = style.sample_for(room, generator, None if like is None else style.nearest(like))
    return strokes_at(places, codes, knots, brush, pixels_per_metre)


def strokes_at(
    places: Places, codes: torch.Tensor, knots: torch.Tensor, brush: Brush, pixels_per_metre: float
) -> StrokeParameters:
    """Return the strokes of these codes (N, K) at the places; their pressure (N, 4) is moved to suit the room there.

    Their brush counts as the first of all.
    """
    spacing = places.spacing / pixels_per_metre
    if brush.pressure_matters:
        pressure = brush.pressure_for(HALF_WIDTH_IN_SPACINGS * spacing)
        knots = (knots - knots.mean(dim=1, keepdim=True) + _tensor(pressure)[:, None]).clamp(brush.lightest, 1)
    else:
        knots = torch.full_like(knots, brush.lightest)
    return StrokeParameters(
        codes,
        _tensor(places.centres / pixels_per_metre),
        _tensor(places.angles),
        knots,
        _tensor(places.colours),
        torch.zeros(len(places.angles), dtype=torch.long),
    )


def _tensor(array: Floats) -> torch.Tensor:
    return torch.from_numpy(np.ascontiguousarray(array, dtype=np.float32))


def _stipple(density: Floats, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return centres (count, 2) spread by the density (H, W), and their mean distance to neighbours, (count,)."""
    height, width = density.shape
    shares = density.ravel() + 1e-9  # an empty density counts as an even one
    samples = rng.choice(density.size, size=_SAMPLES_PER_STROKE * count, p=shares / shares.sum())
    cloud = np.stack([samples % width, samples // width], axis=1) + rng.random((len(samples), 2))
    centres = cloud[rng.choice(len(cloud), size=count, replace=False)]
    for _ in range(_ROUNDS):
        owner = cKDTree(centres).query(cloud, workers=THREADS)[1]
        share = np.bincount(owner, minlength=count)
        sums = np.stack([np.bincount(owner, weights=column, minlength=count) for column in cloud.T], axis=1)
        centres = np.where(share[:, None] > 0, sums / np.maximum(share, 1)[:, None], centres)
    if count == 1:
        return centres, np.array([float(min(height, width)) / 2])
    neighbours = np.asarray(cKDTree(centres).query(centres, k=min(5, count))[0])
    return centres, neighbours[:, 1:].mean(axis=1)
