"""Trials of a simulated table: strokes of a known brush, drawn one after another and photographed by a plain camera.

Strokes cross a sheet from any side, with a bend and a pressure that changes along the way; after some, a new sheet is
laid out. Every photograph has its own noise, exposure and slope of the light, and its specks lie where they like.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from maulstick.brush_fit.trials import Trial
from maulstick.painting.brush import Brush
from maulstick.rendering.kernels.render import composite
from maulstick.rendering.traj2stroke import Traj2Stroke
from maulstick.storage.arrays import Floats

Picture = NDArray[np.float32]

SCALE = 3000.0  # pixels a metre
SHAPE = (84, 112)
INK = (0.1, 0.12, 0.3)
PAPER = (0.93, 0.92, 0.88)
_MARGIN = 5e-3  # metres, that commanded paths keep from the edges
_POINTS = 24


@dataclass(frozen=True)
class Faults:
    """What differs from one stroke or photograph to the next.

    place: metres, and ink: share; standard deviations of a stroke's place and darkness.  noise: of a pixel.
    light: of the logarithm of exposure, and of its slopes over half a photograph.  specks: on each photograph.
    """

    place: float = 0.4e-3
    ink: float = 0.1
    noise: float = 0.01
    light: float = 0.04
    specks: int = 0


CLEAN = Faults(place=0, ink=0, noise=0, light=0)


def draw_trials(
    brush: Brush,
    count: int,
    seed: int,
    faults: Faults = CLEAN,
    *,
    sheet_of: int = 4,
    pressure: Callable[[Floats], Floats] = lambda pressure: pressure,
    shape: tuple[int, int] = SHAPE,
) -> list[Trial]:
    """The photographs before and after each stroke, `sheet_of` strokes a sheet.

    pressure: what becomes of pressures in [0, 1] before they are drawn.  shape: height and width of the photographs.
    """
    rng = np.random.default_rng(seed)
    trials = []
    sheet = before = np.empty(0, dtype=np.float32)
    for i in range(count):
        if i % sheet_of == 0:
            sheet = np.broadcast_to(np.float32(PAPER), (*shape, 3))
            before = _photograph(sheet, rng, faults)
        path = _path(rng, pressure, shape)
        sheet = _drawn(sheet, path, brush, INK, rng, faults)
        after = _photograph(sheet, rng, faults)
        trials.append(Trial(f"stroke {i + 1}", path, before, after))
        before = after
    return trials


def draw_darkness(brush: Brush, count: int, seed: int, faults: Faults = CLEAN) -> list[Trial]:
    """The same strokes, each alone and known by its darkness."""
    rng = np.random.default_rng(seed)
    empty = np.zeros((*SHAPE, 1), dtype=np.float32)
    trials = []
    for i in range(count):
        path = _path(rng, lambda pressure: pressure, SHAPE)
        after = _drawn(empty, path, brush, (1.0,), rng, faults)
        noisy = after + rng.normal(0, faults.noise, after.shape) if faults.noise else after
        trials.append(Trial(f"stroke {i + 1}", path, empty, noisy.clip(0, 1).astype(np.float32)))
    return trials


def _path(rng: np.random.Generator, pressure: Callable[[Floats], Floats], shape: tuple[int, int]) -> Floats:
    low, high = np.full(2, _MARGIN), np.array(shape[::-1]) / SCALE - _MARGIN
    while np.hypot(*(ends := rng.uniform(low, high, (2, 2)))[0] - ends[1]) < (high - low).min() / 2:
        continue
    along = np.linspace(0, 1, _POINTS)[:, None]
    bend = rng.normal(0, 3e-3, 2) * np.sin(np.pi * along)
    pressed = pressure((rng.uniform(0, 1) + rng.normal(0, 0.3) * along).clip(0, 1))
    return np.hstack([(ends[0] + (ends[1] - ends[0]) * along + bend).clip(low, high), pressed])


def _drawn(
    sheet: Picture, path: Floats, brush: Brush, ink: tuple[float, ...], rng: np.random.Generator, faults: Faults
) -> Picture:
    beside = np.append(faults.place * rng.normal(size=2), 0)
    opacity = float(np.clip(brush.opacity * (1 + faults.ink * rng.normal()), 0.05, 1))
    stroke = Traj2Stroke.of([brush.model_copy(update={"opacity": opacity})])
    marks = stroke.marks(torch.tensor((path + beside)[None], dtype=torch.float32), SCALE)
    canvas = torch.tensor(np.ascontiguousarray(sheet.transpose(2, 0, 1)))
    painted = composite(
        canvas, marks.points, marks.thickness, torch.tensor([ink]), marks.falloff, marks.plateau, marks.opacity
    )
    return np.ascontiguousarray(painted.numpy().transpose(1, 2, 0))


def _photograph(sheet: Picture, rng: np.random.Generator, faults: Faults) -> Picture:
    y, x = np.mgrid[-1 : 1 : sheet.shape[0] * 1j, -1 : 1 : sheet.shape[1] * 1j]
    exposure, right, down = faults.light * rng.normal(size=3)
    # Brighter than white is lost, so the light only ever falls from full.
    light = np.exp(exposure + right * x + down * y)
    light /= max(1.0, float(light.max()))
    seen = sheet * light[..., None]
    for row, column in zip(*(rng.integers(2, side - 2, faults.specks) for side in sheet.shape[:2]), strict=True):
        seen[row - 1 : row + 2, column - 1 : column + 2] *= 0.4
    noisy = seen + rng.normal(0, faults.noise, seen.shape) if faults.noise else seen
    return noisy.clip(0, 1).astype(np.float32)
