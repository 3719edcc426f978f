"""Bézier curves against a learned hand, with the same photographs, marker, strokes and paints, as JSON lines.

    .venv/bin/python experiments/frida_baseline.py [--quick] [--seeds N] [--picture FILE.png]

A row is a plan, of each photograph and seed:
    frida     Bézier curves, planned as FRIDA does, from a random start down the squared error, in 2,000 steps as there.
    bezier    Bézier curves, planned by Maulstick in its usual 500 steps: what the planner alone brings.
    loops, scribble    a learned hand, planned by Maulstick: what its look costs in likeness to the picture.
seconds: of the processor.  metres: drawn in all. Hands keep their own lengths, so that 400 strokes are more ink in one
    than in another.
psnr, ssim: of the painting as its file orders it against the photograph, at the truth (docs/planning.md).
energy, told_apart: for each hand, of the plan's strokes against the hand's own: energy distance between descriptions
    (`style.compare.describe`, standardised over all strokes of the built-in hands), 0 where they are alike; and how
    often a nearest neighbour tells them apart; 0.5 is guessing. Learned styles have seen these strokes, Bézier curves
    have not. The rows named `hand` compare one half of a hand with the other: what is best to be hoped for.
"""

import argparse
import json
import time
from dataclasses import replace
from itertools import product

import numpy as np
import torch
from frida import Bezier, anywhere, evenly_pressed, plan_plainly
from grid import PICTURES, load, side_by_side
from numpy.typing import NDArray

from maulstick.painting.brush import load_brush
from maulstick.painting.painting import Painting, Sheet
from maulstick.painting.raster import Canvas
from maulstick.planning.from_picture import as_painting, metrics_of, problem_of, provenance_of
from maulstick.planning.layout import Layout, lay_out_for
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.rendering.preview import preview
from maulstick.style.cards import style_path
from maulstick.style.compare import describe, energy_distance, nearest_neighbour_accuracy
from maulstick.style.store import read_style

Floats = NDArray[np.float64]

BUILT_IN = ("contour", "cursive", "hatching", "loops", "marks", "scribble")
HANDS = ("loops", "scribble")
WAYS = ("frida", "bezier", *HANDS)
BRUSH = "marker"
SPLITS = 50
HEIGHT, PX, SHOWN_PX = 0.16, 256, 512
FULL = PlannerSettings(strokes=400, exact=True)
QUICK = PlannerSettings(strokes=200, exact=True, steps=150)
FRIDA_STEPS = 4  # times as many as ours: 2,000 in all, as the paper has


class PooledHands:
    """The strokes of the hands, described, and how other strokes compare with them."""

    def __init__(self) -> None:
        described = {name: describe(read_style(style_path(name)).hand.paths) for name in BUILT_IN}
        together = np.concatenate(list(described.values()))
        self._mean, self._spread = together.mean(axis=0), together.std(axis=0)
        self._hands = {name: (described[name] - self._mean) / self._spread for name in HANDS}

    def compare(self, paths: Floats, rng: np.random.Generator) -> dict[str, dict[str, float]]:
        """Paths (N, n, 2), metres, with each hand."""
        drawn = (describe(paths) - self._mean) / self._spread
        return _by_metric({name: _apart(drawn, hand, rng) for name, hand in self._hands.items()})

    def halves(self, rng: np.random.Generator) -> dict[str, dict[str, float]]:
        """One half of each hand with the other, on average."""
        apart = {}
        for name, hand in self._hands.items():
            mixed = [hand[rng.permutation(len(hand))] for _ in range(SPLITS)]
            apart[name] = np.mean([_apart(each[::2], each[1::2], rng) for each in mixed], axis=0)
        return _by_metric(apart)


def _apart(drawn: Floats, hand: Floats, rng: np.random.Generator) -> tuple[float, float]:
    return energy_distance(drawn, hand), nearest_neighbour_accuracy(drawn, hand, rng)


def _by_metric(apart: dict[str, tuple[float, float]]) -> dict[str, dict[str, float]]:
    metrics = zip(("energy", "told_apart"), zip(*apart.values(), strict=True), strict=True)
    return {metric: dict(zip(apart, np.round(each, 3).tolist(), strict=True)) for metric, each in metrics}


def paint(way: str, layout: Layout, options: PlannerSettings) -> Painting:
    """Plan a picture that is laid out."""
    brush = load_brush(BRUSH)
    style = read_style(style_path(way)) if way in HANDS else Bezier()
    problem = problem_of(layout, (brush,), style, options)
    if way == "frida":
        start = anywhere(problem, options.strokes, torch.Generator().manual_seed(options.seed))
        planned = plan_plainly(
            problem,
            start,
            lambda canvas: (canvas - problem.target).square().mean(),
            steps=FRIDA_STEPS * options.steps,
            paints=options.paints,
            seed=options.seed,
        )
    else:
        planned = plan(problem, options)
    if way == "bezier":
        planned = replace(planned, strokes=evenly_pressed(planned.strokes))
    return as_painting(planned, layout, (brush,), style, provenance_of(options))


def main() -> None:
    """Plan all and print a row each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="one photograph, fewer strokes, few steps")
    parser.add_argument("--seeds", type=int, default=3, help="plans of each row, from seed 0")
    parser.add_argument("--picture", metavar="FILE.png", help="write all paintings of seed 0 side by side")
    asked = parser.parse_args()
    options, images = (QUICK, PICTURES[:1]) if asked.quick else (FULL, PICTURES)
    hands, rng = PooledHands(), np.random.default_rng(0)
    print(json.dumps({"name": "hand", **hands.halves(rng)}), flush=True)
    rows = {image: [load(image)] for image in images}
    for seed, image in product(range(asked.seeds), images):
        picture = rows[image][0]
        size = (HEIGHT * picture.shape[1] / picture.shape[0], HEIGHT)
        layout = lay_out_for(picture, Sheet(width=size[0], height=size[1]), load_brush(BRUSH), "contain", PX)
        for way in WAYS:
            started = time.process_time()
            painting = paint(way, layout, replace(options, seed=seed))
            row = {
                "name": way,
                "image": image,
                "seed": seed,
                "strokes": len(painting.strokes),
                "metres": round(float(painting.lengths().sum()), 1),
                "paints": len(painting.paints),
                "paint_changes": painting.paint_changes(),
                "seconds": round(time.process_time() - started, 1),
            }
            likeness = metrics_of(painting, layout)
            row |= {"psnr": round(likeness.psnr, 2), "ssim": round(likeness.ssim, 3)}
            print(json.dumps(row | hands.compare(painting.trajectories()[..., :2], rng)), flush=True)
            if seed == 0:
                rows[image].append(preview(painting, Canvas.of_height(size, SHOWN_PX)))
    if asked.picture:
        side_by_side(["photograph", *WAYS], list(rows.values()), SHOWN_PX).save(asked.picture)


if __name__ == "__main__":
    main()
