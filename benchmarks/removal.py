"""How well the planner estimates what removing a stroke costs: one JSON object per seed, then all together.

    .venv/bin/python benchmarks/removal.py [--seeds N]

A plan of the astronaut (400 strokes, 256 pixels, 500 steps, tones alone) asks for the cost of each stroke eight times:
before each of seven relocations, and at its end. Every stroke is then really left out and the rest drawn again; the
canvas is linear in a stroke's opacity, so the difference is the noise of eight random probes alone.

median_error: median over strokes of |estimate - cost| / |cost|.  quartiles: of the same.
rank_correlation: Spearman's, of estimates and costs.
moved_right: of the tenth of the strokes with the least estimates, which is moved, the share in the true least tenth.
"""

import argparse
import json
from dataclasses import dataclass
from unittest.mock import patch

import numpy as np
import torch
from photographs import BRUSH, laid_out
from scipy.stats import spearmanr
from torch import Generator, Tensor

from maulstick.planning import planner
from maulstick.planning.from_picture import problem_of
from maulstick.planning.layout import HEIGHT_PX
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.stroke_effects import TargetView, removal_costs
from maulstick.rendering.kernels.render import composite
from maulstick.rendering.traj2stroke import Marks
from maulstick.storage.arrays import Floats
from maulstick.style import load_style

MOVED = 0.1  # share of the strokes that one relocation moves


@dataclass(frozen=True)
class Call:
    """One estimate of the planner: the costs (N,) that it got, and those of really leaving each stroke out."""

    estimated: Floats
    true: Floats

    @property
    def errors(self) -> Floats:
        """Relative errors (N,) of the strokes that cost anything."""
        costly = self.true != 0
        return np.asarray(np.abs(self.estimated - self.true)[costly] / np.abs(self.true)[costly])

    @property
    def rank_correlation(self) -> float:
        """Spearman's rank correlation of estimates and costs."""
        return float(spearmanr(self.estimated, self.true).statistic)

    @property
    def moved_right(self) -> float:
        """Share of the tenth that is moved that is in the true least tenth."""
        count = max(1, int(MOVED * len(self.true)))
        return len(set(np.argsort(self.estimated)[:count]) & set(np.argsort(self.true)[:count])) / count


@torch.no_grad()
def costs_by_leaving_out(view: TargetView, paper: Tensor, marks: Marks, colours: Tensor) -> Floats:
    """Return how much the error really grows, (N,), without each stroke."""

    def error(kept: Tensor) -> float:
        some = {name: tensor[kept] for name, tensor in vars(marks).items()}
        return float(view.difference(composite(paper, colours=colours[kept], **some)).double().square().sum())

    every = torch.ones(len(colours), dtype=torch.bool)
    whole = error(every)
    return np.array([error(every.index_fill(0, torch.tensor(i), False)) - whole for i in range(len(colours))])


def calls_of(seed: int) -> list[Call]:
    """Plan, and return all estimates that the planner asked for."""
    layout, settings, calls = laid_out("astronaut", HEIGHT_PX), PlannerSettings(seed=seed), []

    def watched(view: TargetView, paper: Tensor, marks: Marks, colours: Tensor, generator: Generator) -> Tensor:
        estimated = removal_costs(view, paper, marks, colours, generator)
        calls.append(Call(estimated.double().numpy(), costs_by_leaving_out(view, paper, marks, colours)))
        return estimated

    with patch.object(planner, "removal_costs", watched):
        planner.plan(problem_of(layout, (BRUSH,), load_style("free", layout.canvas), settings), settings)
    return calls


def summary(calls: list[Call]) -> dict[str, object]:
    """Return the measures of some calls."""
    errors = np.concatenate([call.errors for call in calls])
    low, median, high = np.percentile(errors, (25, 50, 75)).round(3).tolist()
    return {
        "calls": len(calls),
        "strokes": len(errors),
        "median_error": median,
        "quartiles": [low, high],
        "rank_correlation": round(float(np.mean([call.rank_correlation for call in calls])), 3),
        "moved_right": round(float(np.mean([call.moved_right for call in calls])), 3),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    seeds = parser.parse_args().seeds
    together = []
    for seed in range(seeds):
        calls = calls_of(seed)
        together += calls
        print(json.dumps({"seed": seed, **summary(calls)}), flush=True)
    print(json.dumps({"seeds": seeds, **summary(together)}), flush=True)


if __name__ == "__main__":
    main()
