"""The paper's table of stroke models, and its picture, with the extended model beside: one JSON object per line.

    .venv/bin/python experiments/stroke_models.py                              # all media, 60 s per training
    .venv/bin/python experiments/stroke_models.py --dataset sharpie --seconds 10
    .venv/bin/python experiments/stroke_models.py --plot measured/stroke_models.png

Sharpie: the robot's 330 strokes, each predicted by a model of the other four of five random folds; dots stay in. Out of
distribution: trained with the half that bends least, tested with the third that bends most, where bend is the largest
distance of a path from its chord, in metres, so that dots are flat. Specks of neighbouring strokes (connected darkness
above 0.15 that lies wholly further than 2.5 mm from the path, and 2 pixels around) count nowhere; no model sees them.

The media of libmypaint: 300 strokes of a generic style, of which 60 are tested with, and out of distribution 150 of
styles that no model has seen (dataset B, with which alone the paper's table is made).

l1: mean absolute error of darkness over all pixels of all tested strokes.  l1_registered: the same after a translation
    and an ink factor for each stroke (registration.py).
l1_out_of_distribution, l1_out_of_distribution_registered: the same of strokes of another kind.
spread: standard deviations of these four over the seeds; null for a single one.
parameters: trained numbers, the mean of all trainings. For the brushes they are the paper's seven and those of what was
    added; the darkness of the ink, which the paper takes as known, is not one.
seconds: of one training, the mean.  seeds: how many; the fit of a brush is not random, so once.
window_m2: what one image shows. The paper's errors are means over a canvas, ours over this window.

The networks keep 15 % of what they are trained with to decide when to stop.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
from baselines import train_cnn, train_coordconv, train_traj2stroke_unet
from media import GENERIC, RADIUS, SPECIAL, mypaint_trials, sharpie_trials
from registration import registered_l1
from scipy.ndimage import binary_dilation, label
from torch import Tensor
from training import Examples

from maulstick.brush_fit.fit import ADDITIONS, fit_brush
from maulstick.brush_fit.trials import Trial
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
METRICS = ("l1", "l1_registered", "l1_out_of_distribution", "l1_out_of_distribution_registered")

FOLDS, VALIDATION = 5, 0.15
TRAINED, HELD_OUT, UNSEEN = 240, 60, 150
SPECK, SPECK_APART, SPECK_EDGE = 0.15, 2.5e-3, 2  # darkness, metres, pixels
SHOWN = {"sharpie": slice(3), "brush": slice(2), "acrylic": slice(2, 3)}
"""Which strokes of a dataset the plot shows, of those out of distribution, the most strongly bent first."""


@dataclass(frozen=True)
class Data:
    """Strokes alone on images of one size and scale."""

    examples: Examples
    pixels_per_metre: float

    def pick(self, which: Tensor) -> "Data":
        """Those of these indices (M,)."""
        return Data(self.examples.pick(which), self.pixels_per_metre)

    @property
    def window(self) -> float:
        """What an image shows, square metres."""
        return self.examples.darkness[0].numel() / self.pixels_per_metre**2

    def trials(self) -> list[Trial]:
        """What a brush is fitted to; blank paper where pixels do not count."""
        paths = self.examples.paths.double().numpy() / (self.pixels_per_metre, self.pixels_per_metre, 1)
        images = (self.examples.weights * self.examples.darkness)[..., None].numpy()
        rows = enumerate(zip(paths, images, strict=True), start=1)
        return [Trial(f"stroke {i}", path, np.zeros_like(image), image) for i, (path, image) in rows]


@dataclass(frozen=True)
class Split:
    """What a model is trained with, and what it is tested with: strokes of the same kind, and of another."""

    train: Data
    inside: Data | None = None
    outside: Data | None = None


@dataclass(frozen=True)
class Trained:
    """A model of any kind. draw: from paths (N, 32, 3) in pixels to darkness (N, H, W)."""

    draw: Callable[[Tensor], Tensor]
    parameters: int
    seconds: float


@dataclass
class Errors:
    """Of all strokes tested so far: means over their images, in the order of METRICS."""

    trained: list[Trained] = field(default_factory=list)
    each: dict[str, list[Tensor]] = field(default_factory=lambda: {name: [] for name in METRICS})

    def means(self) -> list[float]:
        """In the order of METRICS."""
        return [float(torch.cat(self.each[name]).mean()) for name in METRICS]


def splits_of(dataset: str) -> list[Split]:
    """What is trained and tested, the split with strokes of another kind last."""
    if dataset == "sharpie":
        return _of_sharpie(data_of(*sharpie_trials()))
    generic = data_of(*mypaint_trials(dataset, GENERIC, TRAINED + HELD_OUT, seed=0))
    other = data_of(*mypaint_trials(dataset, SPECIAL, UNSEEN, seed=1))
    rows = torch.randperm(TRAINED + HELD_OUT, generator=torch.Generator().manual_seed(0))
    return [Split(generic.pick(rows[HELD_OUT:]), generic.pick(rows[:HELD_OUT]), other)]


def _of_sharpie(data: Data) -> list[Split]:
    count = len(data.examples)
    folds = torch.randperm(count, generator=torch.Generator().manual_seed(0)).tensor_split(FOLDS)
    splits = []
    for i, fold in enumerate(folds):
        others = torch.cat([other for j, other in enumerate(folds) if j != i])
        splits.append(Split(data.pick(others), inside=data.pick(fold)))
    flattest = bend(data.examples.paths).argsort()
    flat, bent = flattest[: count // 2], flattest[-(count // 3) :]
    return [*splits, Split(data.pick(flat), outside=data.pick(bent))]


def bend(paths: Tensor) -> Tensor:
    """The largest distance (N,) of each path (N, n, 2 or more) from the line through its ends."""
    places = paths[..., :2] - paths[:, :1, :2]
    along = places[:, -1:] / places[:, -1:].norm(dim=-1, keepdim=True).clamp(min=1e-6)
    return (places[..., 0] * along[..., 1] - places[..., 1] * along[..., 0]).abs().amax(dim=1)


def data_of(trials: list[Trial], pixels_per_metre: float) -> Data:
    """Darkness images, as networks want them, and where a speck is."""
    paths = np.stack([trial.path for trial in trials]) * (pixels_per_metre, pixels_per_metre, 1)
    images = np.stack([trial.after[..., 0] for trial in trials])
    examples = Examples(torch.from_numpy(paths).float(), torch.from_numpy(images).float(), torch.ones(images.shape))
    apart = torch.full(examples.paths.shape[:2], SPECK_APART * pixels_per_metre)
    neutral = torch.ones(1), torch.zeros(1), torch.ones(1)
    near = darkness(examples.paths[..., :2], apart, *neutral, height=images.shape[1], width=images.shape[2]) > 0
    for weights, image, around in zip(examples.weights, images, near.numpy(), strict=True):
        parts, _ = label(image > SPECK, structure=np.ones((3, 3)))
        specks = (parts > 0) & ~np.isin(parts, parts[around])
        weights[torch.from_numpy(binary_dilation(specks, iterations=SPECK_EDGE))] = 0
    return Data(examples, pixels_per_metre)


def train(model: str, data: Data, *, seed: int, seconds: float) -> Trained:
    """A model that knows these strokes; networks may take `seconds`."""
    if model in BRUSHES:
        start = time.perf_counter()
        brush = fit_brush(
            data.trials(), data.pixels_per_metre, model, source="experiments/stroke_models.py", additions=BRUSHES[model]
        ).brush
        draw = partial(draw_with, brush, data)
        return Trained(draw, 7 + _added(brush), time.perf_counter() - start)
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
    known = {"name", "source", "depth", "m_x", "m_y", "b_x", "b_y", "alpha", "beta", "falloff", "opacity"}
    pairs = [(getattr(brush, name), getattr(neutral, name)) for name in set(Brush.model_fields) - known]
    return sum(np.size(came) for came, plain in pairs if not np.allclose(came, plain, rtol=1e-6, atol=1e-12))


def measure(model: str, splits: list[Split], *, seed: int, seconds: float) -> Errors:
    """Train and test a model once for each split."""
    errors = Errors()
    for split in splits:
        trained = train(model, split.train, seed=seed, seconds=seconds)
        errors.trained.append(trained)
        for data, plain, registered in ((split.inside, *METRICS[:2]), (split.outside, *METRICS[2:])):
            if data is not None:
                drawn, truth, weights = trained.draw(data.examples.paths), data.examples.darkness, data.examples.weights
                errors.each[plain].append((weights * (drawn - truth).abs()).mean(dim=(1, 2)))
                errors.each[registered].append(registered_l1(drawn, truth, weights, data.pixels_per_metre))
    return errors


def table(datasets: tuple[str, ...], *, seconds: float, seeds: int) -> Iterator[tuple[dict[str, Any], Trained, Data]]:
    """The records, each with the first model that was tested with strokes of another kind, and these strokes."""
    for dataset in datasets:
        splits = splits_of(dataset)
        for model in MODELS:
            runs = range(1 if model in BRUSHES else seeds)
            errors = [measure(model, splits, seed=seed, seconds=seconds) for seed in runs]
            means = np.array([each.means() for each in errors])
            trained = [one for each in errors for one in each.trained]
            record = {
                "name": "stroke_models",
                "dataset": dataset,
                "model": model,
                **dict(zip(METRICS, means.mean(axis=0).round(6).tolist(), strict=True)),
                "spread": means.std(axis=0, ddof=1).round(6).tolist() if len(runs) > 1 else None,
                "parameters": round(float(np.mean([one.parameters for one in trained]))),
                "seconds": round(float(np.mean([one.seconds for one in trained])), 1),
                "seeds": len(runs),
                "window_m2": round(splits[-1].train.window, 8),
            }
            yield record, errors[0].trained[-1], splits[-1].outside


def plot(drawn: dict[tuple[str, str], Tensor]) -> bytes:
    """A PNG: a row for each unseen stroke, a column for the truth and each model, of darkness by dataset and column."""
    columns, datasets = ("truth", *MODELS), list(dict.fromkeys(dataset for dataset, _ in drawn))
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
    parser = argparse.ArgumentParser(description="The paper's table of stroke models.")
    parser.add_argument("--dataset", choices=DATASETS, help="only this one")
    parser.add_argument("--seconds", type=float, default=60, help="for one training of a network")
    parser.add_argument("--seeds", type=int, default=1, help="trainings of each network")
    parser.add_argument("--plot", type=Path, help="where to draw six unseen strokes; not to be committed")
    asked = parser.parse_args()
    torch.set_num_threads(1)
    drawn = {}
    datasets = (asked.dataset,) if asked.dataset else DATASETS
    for record, model, other in table(datasets, seconds=asked.seconds, seeds=asked.seeds):
        print(json.dumps(record), flush=True)
        dataset = record["dataset"]
        if asked.plot and dataset in SHOWN:
            most_bent = bend(other.examples.paths).argsort(descending=True)[SHOWN[dataset]]
            unseen = other.examples.pick(most_bent)
            drawn[dataset, "truth"] = unseen.darkness * unseen.weights
            drawn[dataset, record["model"]] = model.draw(unseen.paths)
    if asked.plot:
        asked.plot.parent.mkdir(parents=True, exist_ok=True)
        atomic_write(asked.plot, plot(drawn))


if __name__ == "__main__":
    try:
        main()
    except MaulstickError as error:
        sys.exit(str(error))
