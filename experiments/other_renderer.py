"""Another differentiable renderer of splines beside ours, on the same scenes, one JSON object per line.

    .venv/bin/python experiments/other_renderer.py [--python build/splender/bin/python]

The other is splender, which Maulstick does not need: it is looked for in an environment of its own. Each scene is of
strokes along cubic splines through six knots, all of one width and one colour. Both draw it and lead a gradient back to
knots and widths, on one thread, warmed up.

ms: processor time forward and backward, median of the runs; of ours, and of splender's once it is compiled (compile_s).
worst, mean: how far a pixel is from the mean of the same renderer's picture on four times finer pixels, over pixels
    with ink. (Their brushes are not the same, so each has a truth of its own.)
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from torch import Tensor

from maulstick.rendering.kernels.cpu import composite

SCENES = ((1, 28), (10, 128), (10, 256), (100, 128))  # strokes, pixels on a side; the first is splender's own size
KNOTS, POINTS = 6, 32
LENGTH, HALF_WIDTH = 0.19, 0.02  # of the side
FINER, RUNS = 4, 9
INK = 0.05

Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Drawn:
    """ms: of each run.  picture, truth: darkness (px, px)."""

    ms: list[float]
    picture: Floats
    truth: Floats

    def figures(self, name: str) -> dict[str, float]:
        """What is printed of it."""
        off = np.abs(self.picture - self.truth)[self.truth > INK]
        ms = statistics.median(self.ms)
        return {f"ms_{name}": round(ms, 3), f"worst_{name}": round(float(off.max()), 4)} | {
            f"mean_{name}": round(float(off.mean()), 4)
        }


def knots_of(strokes: int) -> Floats:
    """Knots (N, 6, 2) of arcs at random, as parts of the side, all within it."""
    generator = torch.Generator().manual_seed(0)
    first = 2 * torch.pi * torch.rand(strokes, 1, generator=generator)
    heading = first + torch.randn(strokes, 1, generator=generator) * torch.linspace(-0.5, 0.5, KNOTS)
    path = torch.stack([heading.cos(), heading.sin()], dim=-1).cumsum(1) * LENGTH / (KNOTS - 1)
    margin = LENGTH / 2 + HALF_WIDTH
    places = margin + (1 - 2 * margin) * torch.rand(strokes, 1, 2, generator=generator)
    return (path - path.mean(1, keepdim=True) + places).numpy()


def ours(knots: Floats, weights: Floats, px: int) -> Drawn:
    """Black strokes on a white sheet."""
    spline = CubicSpline(np.linspace(0, 1, KNOTS), np.eye(KNOTS))(np.linspace(0, 1, POINTS))  # linear in its knots
    basis, back = torch.from_numpy(spline).float(), torch.from_numpy(weights)
    strokes = len(knots)
    leaves = [torch.from_numpy(knots), torch.full((strokes, 1), HALF_WIDTH), torch.zeros(strokes, 3)]
    falloff, plateau, opacity = torch.tensor([[1.5], [0.2], [0.9]]).unbind()

    def picture(knots: Tensor, half_widths: Tensor, colours: Tensor, px: int) -> Tensor:
        points, thickness = px * (basis @ knots), px * half_widths.expand(-1, POINTS)
        sheet = torch.ones(3, px, px)
        return 1 - composite(sheet, points, thickness, colours, falloff, plateau, opacity, threads=1)

    def both_ways() -> float:
        start = time.process_time()
        trained = [leaf.clone().requires_grad_() for leaf in leaves]
        torch.autograd.grad((back * picture(*trained, px)).sum(), trained)
        return 1e3 * (time.process_time() - start)

    until = time.perf_counter() + 1
    while time.perf_counter() < until:
        both_ways()
    ms = [both_ways() for _ in range(RUNS)]
    with torch.no_grad():
        truth = picture(*leaves, FINER * px)[0].reshape(px, FINER, px, FINER).mean(dim=(1, 3))
        return Drawn(ms, picture(*leaves, px)[0].numpy(), truth.numpy())


def by_splender(python: Path, knots: Floats, weights: Floats, px: int) -> tuple[Drawn, float]:
    """The same strokes, and the seconds that it took to compile."""
    with tempfile.TemporaryDirectory() as folder:
        scene, out = Path(folder) / "scene.npz", Path(folder) / "out.npz"
        numbers = {"px": px, "half_width": HALF_WIDTH, "length": LENGTH, "finer": FINER, "runs": RUNS}
        np.savez(scene, knots=knots, weights=weights, **numbers)
        subprocess.run([python, Path(__file__).with_name("drawn_by_splender.py"), scene, out], check=True)
        with np.load(out) as file:
            return Drawn(file["ms"].tolist(), file["picture"], file["truth"]), file["compile_s"].item()


def main() -> None:
    """Print a row for each scene."""
    torch.set_num_threads(1)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", type=Path, default="build/splender/bin/python", help="one that has splender")
    python = parser.parse_args().python
    if not python.exists() or subprocess.run([python, "-c", "import splender"], capture_output=True).returncode:
        environment = python.parent.parent
        sys.exit(f"splender is missing: python3 -m venv {environment} && {environment}/bin/pip install splender==0.1.0")
    for strokes, px in SCENES:
        knots = knots_of(strokes)
        weights = torch.randn(px, px, generator=torch.Generator().manual_seed(1)).numpy()
        mine = ours(knots, weights, px)
        other, compile_s = by_splender(python, knots, weights, px)
        row = {"strokes": strokes, "px": px, "half_width_px": round(HALF_WIDTH * px, 3)}
        times = {"compile_s": round(compile_s, 1)}
        print(json.dumps(row | mine.figures("ours") | other.figures("splender") | times), flush=True)


if __name__ == "__main__":
    main()
