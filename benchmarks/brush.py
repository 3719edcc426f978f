"""How near a fitted brush comes to real strokes, and how long the fit takes, as one JSON object per line.

    .venv/bin/python benchmarks/brush.py           # all tables
    .venv/bin/python benchmarks/brush.py models    # one of models, fit, photographs

models: names `stroke_models` and `extended_over_seven`. The tables of experiments/stroke_models.py, which says what
    their keys mean, with 60 s a training of a network and one seed: an hour.

fit: name `fit`. `fit_brush` for the first 100 strokes of a dataset, with all additions.
    trials: how many were given.  strokes: how many could be used.  seconds: of the whole fit.
    kept: the additions that earned their place.  l1, l1_paper: the error as executed that the fit tells, of this brush
    and of the paper's seven numbers, of twenty strokes that neither taught nor chose anything: means over a window just
    around a stroke, not to be compared with those of the models.

photographs: name `photographs`. `fit_brush` for folders of 100 and 500 trials photographed in colour at 2000 x 1600
    pixels, simulated; 20 different ones, listed several times.  seconds: reading included.  peak_mib: of the whole
    process, torch included.
"""

import argparse
import json
import multiprocessing
import resource
import sys
import time
from multiprocessing.queues import Queue
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import torch

sys.path.append(str(Path(__file__).resolve().parents[1] / "experiments"))  # scripts there are not installed

from media import GENERIC, mypaint_trials, sharpie_trials
from stroke_models import DATASETS, MODELS, table

from maulstick.brush_fit.fit import fit_brush
from maulstick.brush_fit.trials import Trials
from maulstick.painting.brush import Brush
from maulstick.rendering.traj2stroke import Traj2Stroke, paint

TRIALS = 100
SIZE, SHEET, DIFFERENT = (1600, 2000), 0.3, 20  # pixels high and wide; metres wide
PEN = Brush(name="pen", source="benchmarks/brush.py", alpha=1.5e-3, beta=0.8e-3, falloff=0.9, plateau=0.5)
PAPER, INK = 0.95, (0.1, 0.12, 0.3)
SECONDS, SEEDS = 60.0, 1


def models() -> None:
    for record, _, _ in table(DATASETS, MODELS, seconds=SECONDS, seeds=SEEDS):
        print(json.dumps(record), flush=True)


def fit() -> None:
    for dataset in DATASETS:
        trials, scale = sharpie_trials() if dataset == "sharpie" else mypaint_trials(dataset, GENERIC, TRIALS, seed=0)
        start = time.perf_counter()
        found = fit_brush(trials[:TRIALS], scale, dataset, source="benchmarks/brush.py")
        record = {
            "name": "fit",
            "dataset": dataset,
            "trials": TRIALS,
            "strokes": found.strokes,
            "seconds": round(time.perf_counter() - start, 2),
            "kept": found.kept,
            "l1": round(found.l1, 6),
            "l1_paper": round(found.l1_paper, 6),
        }
        print(json.dumps(record), flush=True)


def photographs() -> None:
    context = multiprocessing.get_context("spawn")  # a fresh process, so that its memory is its own
    with TemporaryDirectory() as folder:
        trials = Path(folder) / "trials"
        draw(trials)
        made = json.loads((trials / "trials.json").read_text())
        for count in (100, 500):
            strokes = [made["strokes"][i % DIFFERENT] for i in range(count)]
            (trials / "trials.json").write_text(json.dumps(made | {"strokes": strokes}))
            queue = context.Queue()
            process = context.Process(target=measure, args=(trials, queue))
            process.start()
            print(json.dumps(queue.get()), flush=True)
            process.join()


def draw(folder: Path) -> None:
    """Write trials of strokes on one sheet, a little beside their places, photographed with noise."""
    rng = np.random.default_rng(0)
    scale = SIZE[1] / SHEET
    canvas = torch.full((3, *SIZE), PAPER)

    def photograph() -> np.ndarray:
        return np.clip(canvas.permute(1, 2, 0).numpy() + rng.normal(0, 0.01, (*SIZE, 3)), 0, 1)

    trials = Trials.make(folder, medium="simulated", pixels_per_metre=scale)
    trials.begin(photograph())
    t = np.linspace(0, 1, 32)
    for _ in range(DIFFERENT):
        angle, length = rng.uniform(0, 2 * np.pi), rng.uniform(0.015, 0.05)
        along, across = t * length, 0.01 * rng.normal() * np.sin(np.pi * t)
        x = rng.uniform(0.06, 0.24) + along * np.cos(angle) - across * np.sin(angle)
        y = rng.uniform(0.06, 0.18) + along * np.sin(angle) + across * np.cos(angle)
        path = np.stack([x, y, np.clip(rng.uniform(0.1, 0.9) + 0.1 * np.sin(3 * t), 0, 1)], axis=1)
        drawn = torch.from_numpy(path + np.append(rng.normal(0, 3e-4, 2), 0)).float()[None]
        with torch.no_grad():
            canvas = paint(canvas, drawn, torch.tensor([INK]), Traj2Stroke.of([PEN]), scale)
        trials.append(path, photograph())


def measure(folder: Path, queue: "Queue[dict[str, object]]") -> None:
    start = time.perf_counter()
    trials = Trials.open(folder)
    found = fit_brush(trials, trials.pixels_per_metre, "pen", source="benchmarks/brush.py")
    record = {
        "name": "photographs",
        "trials": len(trials),
        "strokes": found.strokes,
        "seconds": round(time.perf_counter() - start, 2),
        "peak_mib": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024),
        "kept": found.kept,
    }
    queue.put(record)


TABLES = {"fit": fit, "models": models, "photographs": photographs}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"of {', '.join(TABLES)}; all by default")
    words = parser.parse_args().tables
    torch.set_num_threads(1)
    if unknown := [word for word in words if word not in TABLES]:
        parser.error(f"there is no table {unknown[0]}; there are: {', '.join(TABLES)}")
    for word in words or TABLES:
        TABLES[word]()


if __name__ == "__main__":
    main()
