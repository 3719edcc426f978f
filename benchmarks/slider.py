"""How soon a plan in the studio follows a slider: one JSON object per line.

    .venv/bin/python benchmarks/slider.py [--seeds N]

The studio's own process of a plan, which has loaded its modules, as it has while a page is open. 400 strokes in 12
colours (free, and in loops) of the astronaut of scikit-image. When 60 % of the plan is over, the weight of `edges` goes
from 0 to 1.

first: seconds from the request to the first picture.  answered: from the slider to the first picture with the new
    weight.  good: from the slider until the loss has gone nine tenths of its way, from that picture to the end of the
    plan, and stays there.  rest: from the slider to the last step.
"""

import argparse
import json
import tempfile
import time
from collections.abc import Iterator
from importlib import import_module
from itertools import product
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

from skimage.data import astronaut
from skimage.io import imsave

from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.request import PlanRequest
from maulstick.studio.workers.planner import TAKEN, Planned, Step, Weigh, plan
from maulstick.studio.workers.process import Line

STYLES = ("free", "loops")
MOVED, TOLERANCE = 0.6, 0.1
WEIGHTS = {"edges": 1.0}


def follows(style: str, seed: int, folder: Path) -> dict[str, object]:
    """Plan, move the slider, and measure."""
    imsave(picture := folder / "astronaut.png", astronaut(), check_contrast=False)
    request = PlanRequest(picture, PlanOptions(seed=seed, style=style, strokes=400, paints=12))
    ours, theirs = get_context("spawn").Pipe()
    worker = get_context("spawn").Process(target=waits, args=(theirs, request, folder), daemon=True)
    worker.start()
    ours.recv()
    ours.send("begin")
    began = time.monotonic()
    first = moved = 0.0
    after: list[tuple[float, float]] = []  # seconds since the slider, and the loss
    while not isinstance(word := ours.recv(), Planned):
        if not isinstance(word, Step):
            continue
        now = time.monotonic()
        first = first or now - began
        if not moved and word.done >= MOVED:
            ours.send(Weigh(WEIGHTS))
            moved = now
        elif "edges" in word.parts:
            after.append((now - moved, sum(word.parts.values())))
    worker.join()
    goal = after[-1][1] + TOLERANCE * (after[0][1] - after[-1][1])
    late = [seconds for seconds, loss in after if loss > goal]
    good = next(seconds for seconds, _ in after if not late or seconds > late[-1])
    seconds = {"first": first, "answered": after[0][0], "good": good, "rest": after[-1][0]}
    return {"style": style, "seed": seed} | {name: round(value, 2) for name, value in seconds.items()}


def waits(connection: Connection, request: PlanRequest, folder: Path) -> None:
    """Load what planning takes, and plan once it is asked for."""
    for module in TAKEN:
        import_module(module)
    connection.send("ready")
    connection.recv()
    plan(Line(connection), request, folder)


def rows(seeds: int) -> Iterator[dict[str, object]]:
    """A row for each style and seed."""
    for style, seed in product(STYLES, range(seeds)):
        with tempfile.TemporaryDirectory() as folder:
            yield follows(style, seed, Path(folder))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    for row in rows(parser.parse_args().seeds):
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
