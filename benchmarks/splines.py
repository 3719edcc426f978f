"""Which curve through 32 points of a stroke comes nearest to what the hand drew: one JSON object per line.

    .venv/bin/python benchmarks/splines.py

Strokes of at least 40 recorded points of the mocap sessions and of Wacom's drawings; 5 to 60 of a drawing. Each is
resampled to 32 points, a curve is laid through them, and compared with all recorded points. The unit is a step, the
stroke's length over 31.

curve: straight; Catmull-Rom with a parameter that grows by a power of the distance (uniform 0, centripetal 1/2, which
`maulstick.strokes.refine` takes, chordal 1); natural, the cubic spline of least bending over the chords' lengths.
worst, mean: distance of a recorded point from the curve, steps; mean over strokes.
sideways: the furthest that the curve departs from one of its straight steps, in that step's length; of all strokes.
"""

import argparse
import json
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray
from recordings import DATA, MOCAP
from scipy.interpolate import CubicHermiteSpline, CubicSpline, PPoly
from scipy.spatial import cKDTree

from maulstick.strokes.strokes import POINTS, path_lengths, resample

Floats = NDArray[np.float64]
FEWEST = 40  # recorded points of a stroke
LEAST, MOST = 5, 60  # strokes of a drawing
FINE = 64  # places on a curve per step: a distance from the nearest is right to a hundredth of a step


def straight(points: Floats) -> PPoly:
    """Straight from point to point."""
    return CubicHermiteSpline(np.arange(len(points)), points, np.zeros_like(points))


def catmull_rom(power: float) -> Callable[[Floats], PPoly]:
    """Catmull-Rom's spline for a power of the distance."""

    def through(points: Floats) -> PPoly:
        spans = np.hypot(*np.diff(points, axis=0).T)[:, None] ** power
        speeds = np.diff(points, axis=0) / spans
        inner = (spans[1:] * speeds[:-1] + spans[:-1] * speeds[1:]) / (spans[1:] + spans[:-1])
        slopes = np.concatenate([[(3 * speeds[0] - inner[0]) / 2], inner, [(3 * speeds[-1] - inner[-1]) / 2]])
        return CubicHermiteSpline(np.concatenate([[0], np.cumsum(spans)]), points, slopes)

    return through


def natural(points: Floats) -> PPoly:
    """The natural cubic spline."""
    lengths = np.hypot(*np.diff(points, axis=0).T)
    return CubicSpline(np.concatenate([[0], np.cumsum(lengths)]), points, bc_type="natural")


CURVES: dict[str, Callable[[Floats], PPoly]] = {
    "straight": straight,
    "uniform": catmull_rom(0),
    "centripetal": catmull_rom(0.5),
    "chordal": catmull_rom(1),
    "natural": natural,
}


def drawings() -> Iterator[tuple[str, list[Floats]]]:
    """Names of drawings, and the recorded paths (m, 2) of each."""
    for name in MOCAP:
        with np.load(DATA / f"mocap_{name}.npz", allow_pickle=False) as file:
            yield f"mocap {name}", np.split(file["points_m"].astype(np.float64), np.cumsum(file["lengths"])[:-1])
    with np.load(DATA / "uil_strokes.npz", allow_pickle=False) as file:
        paths, sources = np.split(file["data"][:, :2], np.cumsum(file["lens"])[:-1]), file["source"].astype(str)
    for source in np.unique(sources):
        if source.startswith("will/"):
            yield source, [path for path, of in zip(paths, sources, strict=True) if of == source]


def measured(path: Floats, points: Floats, curve: PPoly) -> tuple[float, float, float]:
    """Worst and mean distance of a path (m, 2) from a curve, in steps, and the furthest that it departs sideways."""
    on = curve(np.linspace(curve.x[:-1], curve.x[1:], FINE + 1))
    away = cKDTree(on.reshape(-1, 2)).query(path)[0] * (POINTS - 1) / path_lengths(path)
    steps, beside = np.diff(points, axis=0), on - points[:-1]
    across = np.abs(beside[..., 0] * steps[:, 1] - beside[..., 1] * steps[:, 0]) / (steps**2).sum(axis=1)
    return float(away.max()), float(away.mean()), float(across.max())


def main() -> None:
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    for name, recorded in drawings():
        long = [path for path in recorded if len(path) >= FEWEST and path_lengths(path) > 0]
        if len(long) < LEAST:
            continue
        chosen = np.random.default_rng(0).permutation(len(long))[:MOST]
        strokes = [(long[i], resample(long[i], POINTS)) for i in chosen]
        for curve, through in CURVES.items():
            figures = np.array([measured(path, points, through(points)) for path, points in strokes])
            worst, mean, _ = figures.mean(axis=0)
            row = {"drawing": name, "curve": curve, "strokes": len(strokes)}
            row |= {"worst": round(worst, 4), "mean": round(mean, 4), "sideways": round(figures[:, 2].max(), 4)}
            print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
