"""How good a plan is after so many steps, here and before: one JSON object per line.

    .venv/bin/python benchmarks/steps.py [--steps N ...] [--seeds N] [--beside CHECKOUT=N ...]

400 strokes in 12 paints, tones alone, 256 pixels high: six photographs in the free style, `loops` and `hatching`.
psnr, ssim: at the truth.  seconds: of the processor, planning; with as many plans at a time as there are cores.
--beside: other checkouts, each with its own .venv, and the steps that they plan; their rows have their folder's name
    as `source`. Without it, rows of such that were kept are printed again. The planner's rates were chosen on three
    other photographs.
"""

import argparse
import json
import os
import subprocess
import sys
from argparse import ArgumentTypeError
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path

from kept import ROOT, checkout_named, python_of, rows_of_others
from photographs import IMAGES

STYLES = ("free", "loops", "hatching")
PLANNED = """
import json, sys, time
from inspect import signature
sys.path.insert(0, sys.argv[1])
from photographs import BRUSH, laid_out
from maulstick.planning.from_picture import as_painting, metrics_of, problem_of, provenance_of
from maulstick.planning.losses import LossOptions
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.style import load_style

row = json.loads(sys.argv[2])
layout = laid_out(row["image"], 256)
style = load_style(row["style"], layout.canvas)
options = PlannerSettings(strokes=400, steps=row["steps"], seed=row["seed"])
# A checkout from before there were several brushes takes one.
brush = (BRUSH,) if "brushes" in signature(problem_of).parameters else BRUSH
problem = problem_of(layout, brush, style, options, LossOptions())
started = time.process_time()
planned = plan(problem, options)
spent = time.process_time() - started
metrics = metrics_of(as_painting(planned, layout, brush, style, provenance_of(options)), layout)
print(json.dumps(row | {"psnr": round(metrics.psnr, 3), "ssim": round(metrics.ssim, 4), "seconds": round(spent, 1)}))
"""


def planned(checkout: Path, row: dict[str, str | int]) -> str:
    """The row with what its plan came to, planned in a checkout by a process of its own."""
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    command = [python_of(checkout), "-c", PLANNED, str(ROOT / "benchmarks"), json.dumps(row)]
    ran = subprocess.run(command, capture_output=True, text=True, env=environment)
    if ran.returncode:
        sys.exit(ran.stderr)
    return ran.stdout


def checkout_and_steps(text: str) -> tuple[Path, int]:
    """A checkout and the steps that it plans, for argparse."""
    path, _, steps = text.rpartition("=")
    if not path or not steps.isdecimal():
        raise ArgumentTypeError(f"{text!r} is no CHECKOUT=N; write a folder and a number of steps, as in ../before=500")
    return checkout_named(path), int(steps)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, nargs="+", default=[300, 500])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--beside", type=checkout_and_steps, nargs="+", default=[], metavar="CHECKOUT=N")
    asked = parser.parse_args()
    sources = [(ROOT, "here", steps) for steps in asked.steps]
    sources += [(checkout, checkout.name, steps) for checkout, steps in asked.beside]
    cases = product(range(asked.seeds), sources, STYLES, IMAGES)
    rows = [
        (checkout, {"source": source, "style": style, "image": image, "seed": seed, "steps": steps})
        for seed, (checkout, source, steps), style, image in cases
    ]
    for row in [] if asked.beside else rows_of_others("steps"):
        print(json.dumps(row))
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for line in pool.map(planned, *zip(*rows, strict=True)):
            print(line, end="", flush=True)


if __name__ == "__main__":
    main()
