"""What a plan takes beside its steps, from the command to its files: one JSON object per line.

    OMP_NUM_THREADS=1 .venv/bin/python benchmarks/startup.py [--runs N] [--beside CHECKOUT ...]

The command `maulstick plan` with 400 strokes and one step: the astronaut of scikit-image in the free style (free), and
in black ink in the style loops (loops). Each run is a process of its own; files were read before.

stage: `loading` Python and all modules; `preparing` the picture, its faces, brush, style, and the losses; `beginning`
    the first strokes, and the first step; `finishing` paints, useless strokes, and metrics; `files` those that are
    written; `leaving` the summary, and the end of the process; `first step` all up to it; `all` of it.
seconds: of the processor, user and system, the least of all runs.
torch: the same, in seconds that `import torch` alone takes, the least of as many runs between the others.
--beside: other checkouts, each with its own .venv, in turns; their rows have their folder's name as `source`.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from kept import ROOT, checkout_named, python_of

CASES = {"free": ["--demo"], "loops": ["--demo", "--style", "loops", "--ink", "black"]}
MARKS = ("loading", "preparing", "beginning", "finishing", "files")
STAGES = (*MARKS, "leaving", "first step", "all")
TIMED = '''
import sys, time
from importlib.machinery import PathFinder

class Timed:
    """Prints the processor's seconds when the stages of maulstick.cli.plan.run are over."""

    def find_spec(self, name, path=None, target=None):
        if name != "maulstick.cli.plan.run":
            return None
        spec = PathFinder.find_spec(name, path)
        run = spec.loader.exec_module
        def exec_module(module):
            run(module)
            module.prepare = timed(module.prepare, "loading", "preparing")
            module.write_results = timed(module.write_results, None, "files")
            plan_with = timed(module.plan_with, None, "finishing")
            def watched(prepared, out, request, watch):
                return plan_with(prepared, out, request, timed(watch, "beginning", None))
            module.plan_with = watched
        spec.loader.exec_module = exec_module
        return spec

def timed(function, before, after):
    def call(*arguments):
        mark(before)
        result = function(*arguments)
        mark(after)
        return result
    return call

def mark(stage):
    if stage:
        print(stage, time.process_time(), file=sys.stderr)

sys.meta_path.insert(0, Timed())
from maulstick.cli import main
main()
'''


def run(python: str, *words: str) -> tuple[float, str]:
    """Run Python with these words; return the processor's seconds, and what it wrote on the standard error."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    ran = subprocess.run([python, *words], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if ran.returncode:
        sys.exit(ran.stderr)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, ran.stderr


def stages(checkout: Path, words: Sequence[str]) -> dict[str, float]:
    """The processor's seconds in each stage of a plan."""
    with tempfile.TemporaryDirectory() as folder:
        asked = ["plan", *words, "--strokes", "400", "--steps", "1", "--out", str(Path(folder) / "out")]
        whole, said = run(python_of(checkout), "-c", TIMED, *asked)
    marks = dict(line.split() for line in said.splitlines() if line.partition(" ")[0] in MARKS)
    times = [0.0, *(float(marks[stage]) for stage in MARKS), whole]
    spent = [after - before for before, after in pairwise(times)]
    return dict(zip(STAGES, [*spent, float(marks["beginning"]), whole], strict=True))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--beside", type=checkout_named, nargs="+", default=[], metavar="CHECKOUT")
    asked = parser.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    sources = {"here": ROOT} | {checkout.name: checkout for checkout in asked.beside}
    torch: list[float] = []
    spent: dict[tuple[str, str], list[dict[str, float]]] = defaultdict(list)
    for _ in range(asked.runs + 1):
        torch.append(run(sys.executable, "-c", "import torch")[0])
        for source, checkout in sources.items():
            for case, words in CASES.items():
                spent[source, case].append(stages(checkout, words))
    for (source, case), runs in spent.items():
        for stage in STAGES:
            seconds = min(each[stage] for each in runs[1:])  # the first one read the files
            row = {"source": source, "case": case, "stage": stage, "seconds": round(seconds, 2)}
            print(json.dumps(row | {"torch": round(seconds / min(torch[1:]), 2)}), flush=True)


if __name__ == "__main__":
    main()
