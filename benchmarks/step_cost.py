"""What a step costs beside its kernels, for `plan.py --step-cost`: this source, and others in turns with it.

A plan of the astronaut, 400 strokes at 256 pixels, by each style and paints of `CASES`, in a process of its own. The
kernels' share is clocked within the same steps, forward and backward, so it is of the same marks and threads.
step_ms: the middle one of a plan's steps.  mean_ms: of all its steps but the first ten, and of what is done between
them; coarse pixels, relocations and the choice of paints are in it, but not the loading of k-means (`startup.py`).
"""

import json
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from kept import ROOT, python_of

STROKES, PX = 400, 256
CASES = {"free": ("free", False), "loops": ("loops", False), "loops in ink": ("loops", True)}
"""A style, and whether it draws in one ink, by name."""
TURNS = 5
CLOCKED = """
import json, sys, time
sys.path.insert(0, sys.argv[1])
import sklearn.cluster
import torch
from photographs import BRUSH, laid_out
from maulstick.painting.brush import load_brush
from maulstick.planning.from_picture import problem_of
from maulstick.planning.losses import LossOptions
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.rendering.kernels import _cpu
from maulstick.style import load_style

style, ink, strokes, px = json.loads(sys.argv[2])
layout = laid_out("astronaut", px)
style = load_style(style, layout.canvas)
brush = load_brush("fineliner") if ink else BRUSH
options = PlannerSettings(strokes=strokes, steps=300, paints=None if ink else 12)
steps, kernels, spent = [], [], 0.0

def clocked(function):
    def call(*arguments):
        global spent
        started = time.perf_counter()
        result = function(*arguments)
        spent += time.perf_counter() - started
        return result
    return call

for name in ("composite_traced", "composite_backward"):
    setattr(_cpu, name, clocked(getattr(_cpu, name)))

def watch(progress):
    global spent
    steps.append(time.perf_counter())
    kernels.append(spent)
    spent = 0.0
    return True

plan(problem_of(layout, (brush,), style, options, LossOptions()), options, watch)
middle = lambda times: 1e3 * sorted(times)[len(times) // 2]
mean = 1e3 * (steps[-1] - steps[10]) / (len(steps) - 11)
print(json.dumps([middle([b - a for a, b in zip(steps[40:], steps[41:])]), mean, middle(kernels[41:])]))
"""


def step_costs(others: Sequence[Path]) -> Iterator[dict[str, Any]]:
    """Yield a row for each source and case: the least of five plans that take turns, since noise only adds."""
    sources = {"here": ROOT} | {checkout.name: checkout for checkout in others}
    times: dict[tuple[str, str], list[list[float]]] = defaultdict(list)
    for _ in range(TURNS):
        for case, (style, ink) in CASES.items():
            for source, checkout in sources.items():
                asked = json.dumps([style, ink, STROKES, PX])
                command = [python_of(checkout), "-c", CLOCKED, str(ROOT / "benchmarks"), asked]
                ran = subprocess.run(command, capture_output=True, text=True)
                if ran.returncode:
                    sys.exit(ran.stderr)
                times[source, case].append(json.loads(ran.stdout))
    for (source, case), each in times.items():
        step, mean, kernel = map(min, zip(*each, strict=True))
        row = {"source": source, "style": case, "strokes": STROKES, "px": PX}
        row |= {"step_ms": round(step, 1), "mean_ms": round(mean, 1), "kernel_ms": round(kernel, 1)}
        yield row | {"ratio": round(step / kernel, 2)}
