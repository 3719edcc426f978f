"""The paper's table of stroke models, and its picture, with the extended model beside: one JSON object per line.

    .venv/bin/python experiments/stroke_models.py                              # all media, 60 s per training
    .venv/bin/python experiments/stroke_models.py --models brushes             # without networks
    .venv/bin/python experiments/stroke_models.py --dataset sharpie --seconds 10
    .venv/bin/python experiments/stroke_models.py --plot measured/stroke_models.png

experiments/splits.py says what is trained and tested. Brushes take all five splits; networks the first alone, with
which all five models are compared under the name `stroke_models`:

l1: mean absolute error of darkness over all pixels of all tested strokes, as executed: where and as dark as a machine
    that follows the path puts them.  l1_registered: the same after a translation and an ink factor for each stroke
    (registration.py), which no machine knows.
l1_out_of_distribution, l1_out_of_distribution_registered: the same of strokes of another kind.
spread: standard deviations of these four over the seeds; null for a single one.
parameters: trained numbers, the mean of all trainings. For the brushes they are the paper's seven and those of what was
    added; the darkness of the ink, which the paper takes as known, is not one.
seconds: of one training, the mean.  seeds: how many; the fit of a brush is not random, so once.
window_m2: what one image shows. The paper's errors are means over a canvas, ours over this window.

The networks keep 15 % of what they are trained with to decide when to stop.

Under the name `extended_over_seven`, per metric of these four: the error of the extended model over that of the paper's
seven numbers, both fitted alike, over five splits.  extended, seven: their errors.  interval: 95 %, bootstrap over
strokes in pairs.  splits: least and largest of a single split.  kept: the additions in each split.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
from baselines import train_cnn, train_coordconv, train_traj2stroke_unet
from media import RADIUS
from paired import paired_ratio
from registration import registered_l1
from splits import SPLITS, Data, Training, splits_of
from torch import Tensor

from maulstick.brush_fit.fit import ADDITIONS, fit_brush
from maulstick.errors import MaulstickError
from maulstick.painting.brush import Brush
from maulstick.plots.sheet import INK, Plot
from maulstick.rendering.kernels.cpu import darkness
from maulstick.rendering.traj2stroke import Traj2Stroke
from maulstick.storage.files import atomic_write

DATASETS = ("sharpie", *RADIUS)
NETWORKS = {"cnn": train_cnn, "coordconv": train_coordconv, "traj2stroke_unet": train_traj2stroke_unet}
BRUSHES: dict[str, tuple[str, ...]] = {"traj2stroke": (), "extended": ADDITIONS}
MODELS = ("cnn", "coordconv", "traj2stroke", "traj2stroke_unet", "extended")
KINDS: dict[str, tuple[str, ...]] = {"all": MODELS, "brushes": tuple(BRUSHES), "networks": tuple(NETWORKS)}
METRICS = ("l1", "l1_registered", "l1_out_of_distribution", "l1_out_of_distribution_registered")

VALIDATION = 0.15
SHOWN = {"sharpie": slice(3), "brush": slice(2), "acrylic": slice(2, 3)}
"""Which strokes of a dataset the plot shows, of those out of distribution, the most strongly bent first."""


@dataclass(frozen=True)
class Trained:
    """A model of any kind. draw: from paths (N, 32, 3) in pixels to darkness (N, H, W)."""

    draw: Callable[[Tensor], Tensor]
    parameters: int
    seconds: float
    kept: tuple[str, ...] = ()


@dataclass
class Errors:
    """Errors (n,) of the strokes that each split tests, by METRICS, and what was trained for it, in order."""

    trained: list[Trained] = field(default_factory=list)
    each: dict[str, list[Tensor]] = field(default_factory=lambda: {name: [] for name in METRICS})

    def means(self, splits: int) -> list[float]:
        """Means over the strokes of the first `splits` splits, in the order of METRICS."""
        return [float(torch.cat(self.each[name][:splits]).mean()) for name in METRICS]


def train(model: str, data: Data, *, seed: int, seconds: float) -> Trained:
    """A model that knows these strokes; networks may take `seconds`."""
    if model in BRUSHES:
        start = time.perf_counter()
        fit = fit_brush(
            data.trials(),
            data.pixels_per_metre,
            model,
            source="experiments/stroke_models.py",
            additions=BRUSHES[model],
            seed=seed,
        )
        draw = partial(draw_with, fit.brush, data)
        return Trained(draw, 7 + _added(fit.brush), time.perf_counter() - start, fit.kept)
    rows = torch.randperm(len(data.examples), generator=torch.Generator().manual_seed(seed))
    valid, rest = rows.tensor_split([round(VALIDATION * len(rows))])
    network = NETWORKS[model](data.examples.pick(rest), data.examples.pick(valid), seed=seed, seconds=seconds)
    return Trained(network, network.parameters, network.seconds)


def draw_with(brush: Brush, like: Data, paths: Tensor) -> Tensor:
    """Darkness (N, H, W), on images of the size and scale of `like`, of paths (N, 32, 3) in pixels."""
    scale = like.pixels_per_metre
    marks = Traj2Stroke.of([brush] * len(paths)).marks(paths / torch.tensor([scale, scale, 1]), scale)
    height, width = like.examples.darkness.shape[1:]
    return darkness(
        marks.points, marks.thickness, marks.falloff, marks.plateau, marks.opacity, height=height, width=width
    )


def _added(brush: Brush) -> int:
    """How many numbers beyond the paper's seven and the ink differ from their neutral values."""
    neutral = Brush(name=brush.name, source=brush.source, alpha=brush.alpha, beta=brush.beta)
    known = {"name", "source", "depth", "lightest", "m_x", "m_y", "b_x", "b_y", "alpha", "beta", "falloff", "opacity"}
    pairs = [(getattr(brush, name), getattr(neutral, name)) for name in set(Brush.model_fields) - known]
    return sum(np.size(came) for came, plain in pairs if not np.allclose(came, plain, rtol=1e-6, atol=1e-12))


def measure(model: str, splits: list[list[Training]], *, seed: int, seconds: float) -> Errors:
    """Train and test a model with each split."""
    errors = Errors()
    for number, training in ((i, training) for i, split in enumerate(splits) for training in split):
        trained = train(model, training.train, seed=seed + number, seconds=seconds)
        errors.trained.append(trained)
        for data, plain, registered in ((training.inside, *METRICS[:2]), (training.outside, *METRICS[2:])):
            if data is not None:
                drawn, truth, weights = trained.draw(data.examples.paths), data.examples.darkness, data.examples.weights
                errors.each[plain].append((weights * (drawn - truth).abs()).mean(dim=(1, 2)))
                errors.each[registered].append(registered_l1(drawn, truth, weights, data.pixels_per_metre))
    return errors


def table(
    datasets: Sequence[str], models: Sequence[str], *, seconds: float, seeds: int
) -> Iterator[tuple[dict[str, Any], dict[str, Trained], Data]]:
    """The records of each dataset, with what was trained in its first split, and the strokes of another kind."""
    for dataset in datasets:
        splits = splits_of(dataset)
        outside, window = splits[0][-1].outside, splits[0][-1].train.window
        tested = {}
        for model in models:
            runs, taken = (range(1), splits) if model in BRUSHES else (range(seeds), splits[:1])
            errors = [measure(model, taken, seed=seed, seconds=seconds) for seed in runs]
            tested[model] = errors[0]
            yield _record(dataset, model, errors, window), {model: errors[0].trained[len(splits[0]) - 1]}, outside
        for metric in METRICS if set(BRUSHES) <= set(tested) else ():
            yield _ratio_record(dataset, metric, tested["extended"], tested["traj2stroke"]), {}, outside


def _record(dataset: str, model: str, errors: list[Errors], window: float) -> dict[str, Any]:
    means = np.array([each.means(1) for each in errors])
    trained = [one for each in errors for one in each.trained]
    return {
        "name": "stroke_models",
        "dataset": dataset,
        "model": model,
        **dict(zip(METRICS, means.mean(axis=0).round(6).tolist(), strict=True)),
        "spread": means.std(axis=0, ddof=1).round(6).tolist() if len(errors) > 1 else None,
        "parameters": round(float(np.mean([one.parameters for one in trained]))),
        "seconds": round(float(np.mean([one.seconds for one in trained])), 1),
        "seeds": len(errors),
        "window_m2": round(window, 8),
    }


def _ratio_record(dataset: str, metric: str, extended: Errors, seven: Errors) -> dict[str, Any]:
    outside = "out_of_distribution" in metric
    found = paired_ratio(extended.each[metric], seven.each[metric], again=outside)
    trainings = len(extended.trained) // SPLITS
    return {
        "name": "extended_over_seven",
        "dataset": dataset,
        "metric": metric,
        "extended": round(float(torch.cat(extended.each[metric]).mean()), 6),
        "seven": round(float(torch.cat(seven.each[metric]).mean()), 6),
        "ratio": round(found.ratio, 3),
        "interval": [round(end, 3) for end in found.interval],
        "splits": [round(end, 3) for end in found.splits],
        "kept": [one.kept for one in extended.trained[trainings - 1 if outside else 0 :: trainings]],
    }


def plot(drawn: dict[tuple[str, str], Tensor]) -> bytes:
    """A PNG: a row for each unseen stroke, a column for the truth and each model, of darkness by dataset and column."""
    datasets, columns = (list(dict.fromkeys(keys)) for keys in zip(*drawn, strict=True))
    rows = [(dataset, i) for dataset in datasets for i in range(len(drawn[dataset, "truth"]))]
    cell, left, head, gap, line = (300, 150), 90, 40, 8, 22
    height = head + len(rows) * (cell[1] + gap)
    plot = Plot(left + len(columns) * (cell[0] + gap), height, lines=height / line)
    for column, title in enumerate(columns):
        plot.text(left + column * (cell[0] + gap), head - gap, title.replace("_", " + "), INK)
    for row, (dataset, i) in enumerate(rows):
        top = head + row * (cell[1] + gap)
        plot.text(gap, top + cell[1] / 2, dataset, INK)
        for column, model in enumerate(columns):
            image = 1 - drawn[dataset, model][i].numpy()
            scale = min(cell[0] / image.shape[1], cell[1] / image.shape[0])
            axes = plot.axes(left + column * (cell[0] + gap), top, *cell, scale)
            across = np.add((-0.5, 0.5), cell[0] / image.shape[1] / scale / 2) * image.shape[1]
            axes.imshow(image, cmap="gray", vmin=0, vmax=1, extent=(*across, image.shape[0], 0))
            axes.set(xlim=(0, cell[0] / scale), ylim=(cell[1] / scale, 0), aspect="auto")
    return plot.png()


def main() -> None:
    """Print the table, and write the plot if it is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dataset", choices=DATASETS, help="only this one")
    parser.add_argument("--seconds", type=float, default=60, help="for one training of a network")
    parser.add_argument("--seeds", type=int, default=1, help="trainings of each network")
    parser.add_argument("--models", choices=KINDS, default="all", help="only these")
    parser.add_argument("--plot", type=Path, help="where to draw six unseen strokes; not to be committed")
    asked = parser.parse_args()
    torch.set_num_threads(1)
    drawn = {}
    datasets = (asked.dataset,) if asked.dataset else DATASETS
    for record, trained, other in table(datasets, KINDS[asked.models], seconds=asked.seconds, seeds=asked.seeds):
        print(json.dumps(record), flush=True)
        dataset = record["dataset"]
        if asked.plot and dataset in SHOWN:
            most_bent = other.bends().argsort(descending=True)[SHOWN[dataset]]
            unseen = other.examples.pick(most_bent)
            drawn[dataset, "truth"] = unseen.darkness * unseen.weights
            drawn |= {(dataset, model): one.draw(unseen.paths) for model, one in trained.items()}
    if asked.plot:
        asked.plot.parent.mkdir(parents=True, exist_ok=True)
        atomic_write(asked.plot, plot(drawn))


if __name__ == "__main__":
    try:
        main()
    except MaulstickError as error:
        sys.exit(str(error))
