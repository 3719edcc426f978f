"""How well and how fast pictures are planned: one JSON object per line.

    .venv/bin/python benchmarks/plan.py [IMAGE ...] [--seeds N] [--device cuda]
        [--large | --scaling | --step-cost [--beside CHECKOUT ...] | --objective network [--plot PNG]]

name: `plan` is Maulstick's way with tones alone, `likeness` with what a network sees beside them. `paper` is the
    published one in three times as many steps: strokes begin anywhere, one scale, no order, useless strokes stay,
    colours free until the last tenth; its paints are changed at nearly every stroke.
image: a photograph in the scikit-image package, laid out 160 mm high; `horse` is a black shape on white paper.
px: its height in pixels while planned.
seconds, processor_seconds: of planning alone, in a process that has planned a little before.  peak_mib: resident, of
    the whole process, until the plan is done.
mse, psnr, ssim, tone_mse_sigma4: of the painting as its file orders it, against the photograph, at the truth: its marks
    drawn on 4 times finer pixels and averaged as sRGB values.  psnr_planned: the same in the planner's own pixels.
stray: strokes more than half of whose path lies where the picture is bare paper.
--device: what renders and compares in these rows.
--seeds: how many plans of each row, from seed 0. After them stands their mean, with `_range`, the least and the most,
    and `_interval`, that of the mean (95 %, Student's t). After several images stand the means of each name, with
    intervals by bootstrap over images and seeds, and `gain`: how much higher its psnr is than that of `paper`, paired.
--large: 4,000 strokes of the astronaut at 768 pixels, and 10,000 at 1536.
--scaling: what a step costs on the canvas' own pixels.
    covered_mpx: how many pixels the marks cover, each mark by itself, in millions.
    step_ms: of the whole step, the middle one of several.  ns_a_pixel: that for each pixel covered and of the canvas.
--step-cost: what a step costs beside its kernels; see `step_cost.py`.
    kernel_ms: of the renderer alone, forward and backward.  ratio: of both.
--beside: other checkouts, each with its own .venv, in turns; their rows have their folder's name as `source`. Without
    it, rows of such that were kept are printed again.
--objective network: how few calls of a network do; see `few_calls.py`.
"""

import argparse
import json
import multiprocessing
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, fields, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import torch
from intervals import interval, mean, of_few
from kept import checkout_named, rows_of_others
from matplotlib.figure import Figure
from photographs import BRUSH, IMAGES, laid_out
from step_cost import step_costs

from maulstick.painting.painting import Painting
from maulstick.planning.from_picture import as_painting, metrics_of, problem_of, provenance_of
from maulstick.planning.layout import Layout
from maulstick.planning.losses import LossOptions
from maulstick.planning.objectives import Objective
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, Weighted
from maulstick.planning.result import PlanProgress
from maulstick.planning.schedule import Schedule
from maulstick.rendering.traj2stroke import Traj2Stroke
from maulstick.style import load_style

sys.path.append(str(Path(__file__).resolve().parents[1] / "experiments"))  # scripts there are not installed
from few_calls import few_calls
from frida import anywhere

PUBLISHED = Schedule(coarse=(0.0, 0.0), fine=1.0, sorts=(), relocations=(), quantise=0.9, grouped=False)
TONES, LIKENESS = LossOptions(), LossOptions(weights={"likeness": 1.0})
SEEN = 2 / 255
SUMMED_UP = ("seconds", "processor_seconds", "psnr", "psnr_planned", "ssim")
SIZES = ((400, 256), (400, 512), (400, 1024), (1600, 512), (1600, 1024), (6400, 1024), (10_000, 1536))
LARGE = ((4000, 768), (10_000, 1536))
NAMES = ("plan", "likeness", "paper")
Row = dict[str, Any]


class OneScale(Objective):
    """Squared difference from the target (C, H, W), pixel by pixel."""

    name = "tone"

    def __init__(self, target: torch.Tensor) -> None:
        self._target = target

    def loss(self, canvas: torch.Tensor, progress: float) -> torch.Tensor:
        """As a term of the planner's loss."""
        return (canvas - self._target).square().mean()


def paint(name: str, layout: Layout, options: PlannerSettings, device: str) -> Painting:
    """As the rows are called."""
    style, terms = load_style("free", layout.canvas), LIKENESS if name == "likeness" else TONES
    problem = problem_of(layout, (BRUSH,), style, options, terms, device=torch.device(device))
    if name == "paper":
        assert problem.target is not None
        even = torch.ones_like(problem.weights)
        tone = Weighted(OneScale(problem.target), 1.0)
        problem = replace(problem, weights=even, objectives=(tone,))
        options = replace(options, steps=3 * options.steps)
        start = anywhere(problem, options.strokes, torch.Generator().manual_seed(options.seed))
        planned = plan(problem, options, schedule=PUBLISHED, start=start)
    else:
        planned = plan(problem, options)
    return as_painting(planned, layout, (BRUSH,), style, provenance_of(options))


def stray(painting: Painting, layout: Layout) -> int:
    """How many strokes are mostly where the picture is bare paper."""
    assert layout.target is not None
    bare = np.abs(layout.target - layout.under).max(axis=2) < SEEN
    points = (painting.trajectories()[..., :2] * layout.canvas.pixels_per_metre).astype(int)
    rows, columns = (points[..., i].clip(0, bare.shape[1 - i] - 1) for i in (1, 0))
    return int((bare[rows, columns].mean(axis=1) > 0.5).sum())


def measure(name: str, image: str, options: PlannerSettings, px: int, device: str) -> Row:
    """A row of likeness, speed and memory."""
    layout = laid_out(image, px)
    paint(name, layout, PlannerSettings(strokes=20, paints=4, steps=20), device)
    started, of_processor = time.perf_counter(), time.process_time()
    painting = paint(name, layout, options, device)
    seconds, of_processor = time.perf_counter() - started, time.process_time() - of_processor
    peak_mib = round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
    metrics = metrics_of(painting, layout)
    assert metrics is not None
    return {
        "name": name,
        "image": image,
        "seed": options.seed,
        "strokes": len(painting.strokes),
        "stray": stray(painting, layout),
        "paints": len(painting.paints),
        "paint_changes": painting.paint_changes(),
        "px": layout.canvas.height_px,
        "device": device,
        "seconds": round(seconds, 1),
        "processor_seconds": round(of_processor, 1),
        "peak_mib": peak_mib,
        **{key: round(value, 6) for key, value in asdict(metrics).items()},
    }


def scaling(strokes: int, px: int) -> Row:
    """A row of what a step costs: the middle one of those from the 6th to the 16th."""
    layout, options = laid_out("astronaut", px), PlannerSettings(strokes=strokes, steps=1500)
    style = load_style("free", layout.canvas)
    problem = problem_of(layout, (BRUSH,), style, options, TONES)
    times: list[float] = []

    def watch(progress: PlanProgress) -> bool:
        times.append(time.perf_counter())
        if len(times) > 16:
            raise StopIteration(progress)
        return True

    try:
        plan(problem, options, watch, schedule=Schedule(coarse=(0.0, 0.0), sorts=(0.0,), relocations=()))
    except StopIteration as stopped:
        state = stopped.value.state()
    step = float(np.median(np.diff(times[5:])))
    tensors = {each.name: torch.from_numpy(state[each.name]) for each in fields(StrokeParameters)}
    trajectories = StrokeParameters(**tensors).trajectories(style)
    marks = Traj2Stroke.of([BRUSH] * strokes).marks(trajectories, layout.canvas.pixels_per_metre)
    lengths = marks.points.diff(dim=1).norm(dim=-1).sum(dim=1)
    covered = float((lengths * 2 * marks.thickness.mean(dim=1)).sum())
    return {
        "name": "scaling",
        "strokes": strokes,
        "px": px,
        "covered_mpx": round(covered / 1e6, 2),
        "step_ms": round(1e3 * step, 1),
        "ns_a_pixel": round(1e9 * step / (covered + layout.canvas.width_px * layout.canvas.height_px), 1),
    }


def in_its_own_process(measured: Callable[..., Row], *arguments: object) -> Row:
    """Print and return the row, measured in a fresh process, so that its memory is its own."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        row = pool.apply(measured, arguments)
    print(json.dumps(row), flush=True)
    return row


def over_seeds(name: str, image: str, options: PlannerSettings, px: int, seeds: int, device: str) -> list[Row]:
    """Print and return a row for each seed; then print their mean, range and interval where there are several."""
    each = [replace(options, seed=seed) for seed in range(seeds)]
    rows = [in_its_own_process(measure, name, image, options, px, device) for options in each]
    if seeds > 1:
        summary: Row = {"name": name, "image": image, "px": px, "seeds": seeds}
        for key in SUMMED_UP:
            values = np.array([row[key] for row in rows], dtype=np.float64)
            ends = [round(float(bound), 3) for bound in (values.min(), values.max())]
            summary |= {key: round(mean(values), 3), f"{key}_range": ends, f"{key}_interval": of_few(values)}
        print(json.dumps(summary), flush=True)
    return rows


def over_images(plans: dict[str, list[list[Row]]]) -> None:
    """Print the means of each name over its images' rows, and how much nearer it came than the published way."""
    for name, images in plans.items():
        summary: Row = {"name": name, "images": len(images), "seeds": len(images[0])}
        for key in SUMMED_UP:
            groups = [np.array([row[key] for row in rows], dtype=np.float64) for rows in images]
            summary |= {key: round(mean(np.concatenate(groups)), 3), f"{key}_interval": interval(groups, mean)}
        if name != "paper":
            paired = zip(images, plans["paper"], strict=True)
            gains = [np.array([a["psnr"] - b["psnr"] for a, b in zip(*pair, strict=True)]) for pair in paired]
            summary |= {"gain": round(mean(np.concatenate(gains)), 3), "gain_interval": interval(gains, mean)}
        print(json.dumps(summary), flush=True)


def network_rows(images: list[str], seeds: int, plot: Path | None) -> None:
    """Print rows about calls of a network, and draw the loss of seed 0 after so many calls, one panel per image."""
    curves = {}
    for image, seed in product(images, range(seeds)):
        row, curve = few_calls(image, seed)
        curves.setdefault(image, curve)
        print(json.dumps(row), flush=True)
    if plot is not None:
        figure = Figure(figsize=(5 * len(images), 4), layout="constrained")
        for image, axes in zip(images, np.ravel(figure.subplots(1, len(images))), strict=True):
            for name, curve in curves[image].items():
                calls, losses = zip(*curve, strict=True)
                axes.semilogy(np.maximum(calls, 1), losses, label=name)
            axes.set(title=image, xlabel="calls of the network", ylabel="its loss, through views never used for steps")
            axes.set_xscale("log")
            axes.legend()
        figure.savefig(plot, dpi=150)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("images", nargs="*", default=IMAGES)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--device", choices=["cpu", "cuda"], default="cpu")
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--scaling", action="store_true")
    parser.add_argument("--step-cost", action="store_true")
    parser.add_argument("--beside", type=checkout_named, nargs="+", default=[], metavar="CHECKOUT")
    parser.add_argument("--plot", type=Path, help="with --objective network: draw the curves, too")
    parser.add_argument("--objective", choices=["tone", "network"], default="tone")
    asked = parser.parse_args()
    if asked.device == "cuda" and not torch.cuda.is_available():
        parser.error("--device cuda: PyTorch finds no GPU here; leave it out to measure on the CPU")
    if asked.large:
        for strokes, px in LARGE:
            over_seeds("plan", "astronaut", PlannerSettings(strokes=strokes), px, asked.seeds, asked.device)
    elif asked.scaling:
        for strokes, px in SIZES:
            in_its_own_process(scaling, strokes, px)
    elif asked.step_cost:
        kept = [] if asked.beside else rows_of_others("step_cost")
        for row in (*step_costs(asked.beside), *kept):
            print(json.dumps(row), flush=True)
    elif asked.objective == "network":
        network_rows(asked.images, asked.seeds, asked.plot)
    else:
        plans: dict[str, list[list[Row]]] = {name: [] for name in NAMES}
        for image in asked.images:
            for name in NAMES:
                plans[name].append(over_seeds(name, image, PlannerSettings(), 256, asked.seeds, asked.device))
        if len(asked.images) > 1:
            over_images(plans)


if __name__ == "__main__":
    main()
