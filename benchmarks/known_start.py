"""What a plan gains at most by a start that something else has predicted: one JSON object per line.

    .venv/bin/python benchmarks/known_start.py [--steps N] [--known N] [--seeds N]

400 strokes in 12 paints, free, tones alone, 256 pixels high: six photographs. The start is known from a finished plan
of many steps with another seed, better than any network could guess it.

start: `usual`; `known`, of whose strokes place, direction, length, width and colour are those of the finished plan;
    `finished`, its strokes as they are.  psnr, ssim: at the truth.
"""

import argparse
import json
import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import product

import torch
from photographs import BRUSH, IMAGES, laid_out

from maulstick.planning.from_picture import as_painting, metrics_of, problem_of, provenance_of
from maulstick.planning.losses import LossOptions
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.placement import HALF_WIDTH_IN_SPACINGS, Places, strokes_at
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.style import Style, load_style
from maulstick.style.traits import path_length

OTHER_SEED = 100  # more than that of the plan that begins with what is known


def known(finished: StrokeParameters, style: Style, pixels_per_metre: float, seed: int) -> StrokeParameters:
    """New strokes of the style at the places of others, as long, as wide, in their directions and colours."""
    generator = torch.Generator().manual_seed(seed)
    codes, knots = style.sample_for(path_length(style.decode(finished.codes)), generator)
    half_widths = BRUSH.half_width(finished.pressure_knots.mean(dim=1).double().numpy())
    places = Places(
        (pixels_per_metre * finished.centres).double().numpy(),
        finished.angles.double().numpy(),
        pixels_per_metre * half_widths / HALF_WIDTH_IN_SPACINGS,
        finished.colours.double().numpy(),
    )
    return strokes_at(places, codes, knots, BRUSH, pixels_per_metre)


def rows(image: str, seed: int, steps: int, steps_known: int) -> list[dict[str, object]]:
    """Rows of a photograph and a seed."""
    torch.set_num_threads(1)
    layout = laid_out(image, 256)
    style, options = load_style("free", layout.canvas), PlannerSettings(strokes=400, steps=steps, seed=seed)
    problem = problem_of(layout, (BRUSH,), style, options, LossOptions())
    teacher = PlannerSettings(strokes=400, steps=steps_known, seed=seed + OTHER_SEED, exact=True)
    finished = plan(problem, teacher).strokes
    starts = {
        "usual": None,
        "known": known(finished, style, layout.canvas.pixels_per_metre, seed),
        "finished": finished,
    }
    found: list[dict[str, object]] = []
    for name, start in starts.items():
        painting = as_painting(plan(problem, options, start=start), layout, (BRUSH,), style, provenance_of(options))
        metrics = metrics_of(painting, layout)
        row = {"start": name, "image": image, "seed": seed, "steps": steps, "steps_known": steps_known}
        found.append(row | {"psnr": round(metrics.psnr, 3), "ssim": round(metrics.ssim, 4)})
    return found


def all_rows(asked: argparse.Namespace) -> Iterator[dict[str, object]]:
    """All rows, with as many photographs at a time as there are cores."""
    cases = list(product(range(asked.seeds), IMAGES))
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        tasks = [pool.submit(rows, image, seed, asked.steps, asked.known) for seed, image in cases]
        for task in tasks:
            yield from task.result()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=300)
    parser.add_argument("--known", type=int, default=1500)
    parser.add_argument("--seeds", type=int, default=2)
    for row in all_rows(parser.parse_args()):
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
