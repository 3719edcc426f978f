"""How near a fitted brush comes to real strokes, and how long the fit takes, as one JSON object a line.

    .venv/bin/python benchmarks/brush.py           # both tables
    .venv/bin/python benchmarks/brush.py models    # one of models, fit

models: name `stroke_models`. The table of experiments/stroke_models.py, which says what its keys mean, with 60 s a
    training and one seed: it takes half an hour, nearly all of it to train the rivals.

fit: name `fit`. `fit_brush` for the first 100 strokes of a dataset, with all additions.
    trials: how many were given.  strokes: how many could be used.  seconds: of the whole fit.
    kept: the additions that earned their place.  l1, l1_paper: the fit's own held-out error, of this brush and of the
    paper's seven numbers: means over a window just around a stroke, not to be compared with those of the models.
"""

import json
import sys
import time
from pathlib import Path

import torch

sys.path.append(str(Path(__file__).resolve().parents[1] / "experiments"))  # scripts there are not installed

from media import GENERIC, mypaint_trials, sharpie_trials
from stroke_models import DATASETS, table

from maulstick.brush.fit import fit_brush

TRIALS = 100
SECONDS, SEEDS = 60.0, 1


def models() -> None:
    for record, _, _ in table(DATASETS, seconds=SECONDS, seeds=SEEDS):
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


TABLES = {"fit": fit, "models": models}


def main() -> None:
    torch.set_num_threads(1)
    unknown = [word for word in sys.argv[1:] if word not in TABLES]
    if unknown:
        sys.exit(f"there is no table {unknown[0]}; there are: {', '.join(TABLES)}")
    for word in sys.argv[1:] or TABLES:
        TABLES[word]()


if __name__ == "__main__":
    main()
