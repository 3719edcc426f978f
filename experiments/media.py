"""Strokes that were really drawn, each alone: by a robot with a Sharpie, and by libmypaint with four media."""

from pathlib import Path

import numpy as np
import torch

from maulstick.brush_fit.trials import Trial
from maulstick.painting.raster import Canvas
from maulstick.robot.simulated.mypaint import MyPaintPaper
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import POINTS
from maulstick.style.cards import STYLES
from maulstick.style.pressure import pressure_along
from maulstick.style.store import read_style

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
RADIUS = {"marker": 1.8e-3, "marker_fat": 5e-3, "brush": 0.3e-3, "acrylic": 1.2e-3}
"""Metres: with these, strokes of medium pressure are 2 to 5 mm wide."""
GENERIC, SPECIAL = ("contour",), ("loops", "cursive", "hatching", "scribble")
"""Styles of the paper's dataset A, which models are trained with, and B, which they have never seen."""

SIDE = 0.0512
SIDE_PX = 128
_FINER = 4
_LARGEST, _MEDIAN = 0.8, 0.5  # of the side


def sharpie_trials() -> tuple[list[Trial], float]:
    """The robot's 330 strokes, and pixels per metre."""
    with np.load(DATA / "robot_sharpie.npz", allow_pickle=False) as file:
        metres_per_px = float(file["metres_per_px"])
        start = (file["start_px"] + 0.5) * metres_per_px
        paths = np.concatenate([file["points_m"] + start, file["height"][..., None]], axis=2).astype(np.float64)
        darkness = file["darkness"].astype(np.float32) / 255
    trials = [_darkness_trial(i, path, image) for i, (path, image) in enumerate(zip(paths, darkness, strict=True))]
    return trials, 1 / metres_per_px


def mypaint_trials(
    medium: str,
    styles: tuple[str, ...],
    count: int,
    seed: int,
    *,
    radius: float | None = None,
    side: float = SIDE,
    speed: float = 0.05,
) -> tuple[list[Trial], float]:
    """`count` strokes of these styles, drawn by libmypaint in the middle of small sheets, and pixels per metre.

    radius: metres, of the medium, or that of the experiment.  side: metres, of a sheet.  speed: metres per second.
    """
    finer = Canvas(side, side, SIDE_PX * _FINER / side)
    trials = []
    for i, path in enumerate(_paths(styles, count, seed)):
        scaled = path * (side / SIDE, side / SIDE, 1)
        paper = MyPaintPaper(finer)
        paper.draw(scaled, medium, radius=radius or RADIUS[medium], speed=speed)
        fine = 1 - paper.photograph()[..., 0]
        darkness = fine.reshape(SIDE_PX, _FINER, SIDE_PX, _FINER).mean(axis=(1, 3))
        trials.append(_darkness_trial(i, scaled, darkness))
    return trials, SIDE_PX / side


def _darkness_trial(index: int, path: Floats, darkness: np.ndarray) -> Trial:
    after = darkness[..., None]
    return Trial(f"stroke {index + 1}", path, np.zeros_like(after), after)


def _paths(styles: tuple[str, ...], count: int, seed: int) -> Floats:
    """(count, n, 3) strokes of the styles in turn, enlarged to a size that fits, their pressures spread evenly."""
    generator = torch.Generator().manual_seed(seed)
    each = [_of_style(style, -(-count // len(styles)), generator) for style in styles]
    return np.stack(each, axis=1).reshape(-1, POINTS, 3)[:count]


def _of_style(style: str, count: int, generator: torch.Generator) -> Floats:
    hand = read_style(STYLES.paths()[style])
    codes, knots = hand.sample(3 * count, generator)
    paths = hand.decode(codes).detach().double().numpy()
    pressure = pressure_along(knots).double().numpy()
    extent = np.ptp(paths, axis=1).max(axis=1)
    scale = _MEDIAN * SIDE / np.median(extent)
    fitting = np.flatnonzero((extent * scale < _LARGEST * SIDE) & (extent * scale > 0.1 * SIDE))[:count]
    # A stylus's pressure keeps to a few values: by rank, all from the lightest to the deepest come alike.
    ranks = np.searchsorted(np.sort(pressure.ravel()), pressure, side="right") / pressure.size
    middle = (paths.min(axis=1) + paths.max(axis=1)) / 2
    placed = (paths - middle[:, None]) * scale + SIDE / 2
    return np.concatenate([placed, 0.1 + 0.9 * ranks[..., None]], axis=2)[fitting]
