"""How well and how fast photographs are planned: one JSON object a line.

    python benchmarks/plan.py [--large]

name: `plan` is Maulstick's way. `paper` is the published one at the same budget of steps: strokes begin anywhere, one
    scale, no order and no respending, colours free until the last tenth; its paints are changed at nearly every stroke.
image: a photograph in the scikit-image package, laid out 160 mm high.  px: its height in pixels while planned.
seconds: of planning alone, in a process that has planned a little before.  peak_mib: resident, of the whole process.
mse, psnr, ssim, tone_mse_sigma4: of the painting as its file orders it, against the photograph.
--large: 4,000 strokes of the astronaut at 768 pixels, and nothing else.
"""

import argparse
import json
import multiprocessing
import resource
import time
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import torch
from skimage import data

from maulstick.medium import Brush, load_brush
from maulstick.painting import Painting
from maulstick.plan.commission import PlanOptions, Weighted
from maulstick.plan.objectives import Tone
from maulstick.plan.parameters import StrokeParameters
from maulstick.plan.photograph import Layout, as_painting, commission_of, figures_of, lay_out_for, making
from maulstick.plan.planner import Schedule, plan
from maulstick.style import Style, load_style

IMAGES = ("astronaut", "camera", "chelsea", "coffee", "rocket", "hubble_deep_field")
HEIGHT = 0.16
BRUSH = Path(__file__).with_name("round.json")
PUBLISHED = Schedule(sorts=(), respends=(), snap=0.9, grouped=False)


def load(image: str) -> np.ndarray:
    picture = getattr(data, image)()
    if picture.ndim == 2:
        picture = np.repeat(picture[..., None], 3, axis=2)
    return (picture / 255).astype(np.float32)


def anywhere(layout: Layout, style: Style, options: PlanOptions) -> StrokeParameters:
    """Strokes of the style at random: places, directions, press and colours."""
    chance = torch.Generator().manual_seed(options.seed)
    codes, _ = style.sample(options.strokes, chance)
    size = torch.tensor([layout.canvas.width, layout.canvas.height])
    return StrokeParameters(
        codes=codes,
        centres=torch.rand(options.strokes, 2, generator=chance) * size,
        angles=torch.rand(options.strokes, generator=chance) * 2 * torch.pi,
        press_knots=torch.rand(options.strokes, 4, generator=chance),
        colours=torch.rand(options.strokes, 3, generator=chance),
    )


def paint(name: str, layout: Layout, brush: Brush, options: PlanOptions) -> Painting:
    style = load_style("free", layout.canvas)
    commission = commission_of(layout, brush, style, options)
    if name == "plan":
        planned = plan(commission, options)
    else:
        even = torch.ones_like(commission.weights)
        tone = Weighted(Tone(commission.target, even, levels=1), 1.0)
        commission = replace(commission, weights=even, objectives=(tone,))
        planned = plan(commission, options, schedule=PUBLISHED, start=anywhere(layout, style, options))
    return as_painting(planned, layout, brush, style, making(options))


def measure(name: str, image: str, options: PlanOptions, px: int, queue: multiprocessing.Queue) -> None:
    picture, brush = load(image), load_brush(str(BRUSH))
    size = (HEIGHT * picture.shape[1] / picture.shape[0], HEIGHT)
    layout = lay_out_for(picture, size, brush, "contain", px)
    paint(name, layout, brush, PlanOptions(strokes=20, paints=4, steps=20))
    started = time.perf_counter()
    painting = paint(name, layout, brush, options)
    seconds = time.perf_counter() - started
    peak_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    row = {
        "name": name,
        "image": image,
        "strokes": len(painting.strokes),
        "paints": len(painting.paints),
        "paint_changes": painting.paint_changes(),
        "px": layout.canvas.height_px,
        "seconds": round(seconds, 1),
        "peak_mib": round(peak_mib),
    }
    queue.put(row | {key: round(value, 6) for key, value in asdict(figures_of(painting, layout)).items()})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--large", action="store_true", help="plan 4,000 strokes at 768 pixels instead")
    if parser.parse_args().large:
        jobs = [("plan", "astronaut", PlanOptions(strokes=4000), 768)]
    else:
        jobs = [(name, image, PlanOptions(), 256) for image in IMAGES for name in ("plan", "paper")]
    context = multiprocessing.get_context("spawn")  # each in a fresh process, so that its memory is its own
    for job in jobs:
        queue = context.Queue()
        process = context.Process(target=measure, args=(*job, queue))
        process.start()
        print(json.dumps(queue.get()), flush=True)
        process.join()


if __name__ == "__main__":
    main()
