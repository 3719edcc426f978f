"""Which session a sheet of 20 strokes is taken for: the one to whose known half it has the least energy distance.

The sheets are of a session's other half, by people, by styles that were fitted on that half, or out of plans in these
styles. A *case* is one session in one split into halves; intervals are over cases.
"""

import multiprocessing
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from few_shot import paths_of, split
from intervals import interval, mean
from numpy.typing import NDArray
from photographs import BRUSH, laid_out
from recordings import mocap_hands

from maulstick.planning.from_picture import as_painting, metrics_of, problem_of, provenance_of
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.strokes.strokes import Strokes
from maulstick.style.compare import describe, energy_distance
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from maulstick.style.store import load_hands

Floats = NDArray[np.float64]
Show = Callable[..., None]

SHEET, SHEETS, SPLITS = 20, 100, 10
PHOTOGRAPHS = ("astronaut", "camera", "chelsea", "coffee", "rocket")
BOUNDS = (1.0, float("inf"))
PX = 256
PROCESSES = 2


@dataclass(frozen=True)
class Case:
    """One session, one split. named: share of sheets taken for each session, in the order of all sessions."""

    session: str
    split: int
    named: list[float]


@dataclass(frozen=True)
class Halves:
    """Sessions of which one half is known, and of the other sheets are to be recognised."""

    known: list[Floats]
    other: dict[str, Strokes]
    mean: Floats
    spread: Floats
    seed: int

    @classmethod
    def of(cls, sessions: dict[str, Strokes], seed: int) -> "Halves":
        """Halves at random."""
        halves = {name: split(strokes, seed, len(strokes) // 2) for name, strokes in sessions.items()}
        known = [describe(paths_of(half)) for half, _ in halves.values()]
        together = np.concatenate(known)
        mean, spread = together.mean(axis=0), together.std(axis=0)
        known = [(half - mean) / spread for half in known]
        return cls(known, {name: other for name, (_, other) in halves.items()}, mean, spread, seed)

    def recognised(self, session: str, paths: Floats) -> Case:
        """Sheets of these strokes (N, 32, 2), which are the session's."""
        described = (describe(paths) - self.mean) / self.spread
        rng = np.random.default_rng(self.seed)
        named = np.zeros(len(self.known))
        for _ in range(SHEETS):
            sheet = described[rng.choice(len(described), SHEET, replace=len(described) < SHEET)]
            named[np.argmin([energy_distance(sheet, half) for half in self.known])] += 1 / SHEETS
        return Case(session, self.seed, named.round(3).tolist())


def recognition(drawn_by: Callable[[str, Strokes, int], Floats], show: Show) -> None:
    """Sheets by people, and of samples of styles that `drawn_by` fits by the name of their kind."""
    sessions = mocap_hands()
    for model in ("human", "exemplar", "trajvae"):
        cases = []
        for seed in range(SPLITS):
            halves = Halves.of(sessions, seed)
            for name, half in halves.other.items():
                paths = paths_of(half) if model == "human" else drawn_by(model, half, seed)
                cases.append(halves.recognised(name, paths))
        _show_all(show, "recognition", cases, model=model)


def plans(show: Show) -> None:
    """Sheets of 25 plans for each bound on their mean cost, of each session and each photograph; then all of a bound.

    A session and a photograph have the same split for all bounds. The first bound is the usual one.
    """
    names = list(mocap_hands())
    wanted = [
        (name, seed, image, bound) for bound in BOUNDS for seed, image in enumerate(PHOTOGRAPHS) for name in names
    ]
    found: dict[float, list[tuple[Case, float]]] = {bound: [] for bound in BOUNDS}
    with multiprocessing.get_context("spawn").Pool(PROCESSES) as pool:
        for (_, _, image, bound), (case, psnr) in zip(wanted, pool.imap(_planned, wanted), strict=True):
            named = {"session": case.session, "photograph": image, "named": case.named}
            show("plan", max_mean_cost=str(bound), **named, psnr=psnr)
            found[bound].append((case, psnr))
    _show_all(show, "plans", [case for case, _ in found[BOUNDS[0]]], model="exemplar")
    for bound, each in found.items():
        right = np.array([case.named[names.index(case.session)] for case, _ in each])
        psnr = np.array([db for _, db in each])
        less = psnr - [db for _, db in found[BOUNDS[-1]]]
        show(
            "price",
            max_mean_cost=str(bound),
            accuracy=mean(right),
            accuracy_interval=interval(right[:, None], mean),
            psnr=mean(psnr),
            psnr_interval=interval(psnr[:, None], mean),
            less=mean(less),
            less_interval=interval(less[:, None], mean),
        )


def _planned(wanted: tuple[str, int, str, float]) -> tuple[Case, float]:
    torch.set_num_threads(1)
    name, seed, image, bound = wanted
    halves = Halves.of(mocap_hands(), seed)
    style = replace(Exemplar.fit("half", Hand.of(halves.other[name]), load_hands()), max_mean_cost=bound)
    layout, options = laid_out(image, PX), PlannerSettings(seed=seed)
    planned = plan(problem_of(layout, (BRUSH,), style, options), options)
    painting = as_painting(planned, layout, (BRUSH,), style, provenance_of(options))
    metrics = metrics_of(painting, layout)
    assert metrics is not None
    return halves.recognised(name, painting.trajectories()[..., :2]), metrics.psnr


def _show_all(show: Show, table: str, cases: Sequence[Case], model: str) -> None:
    names = list(dict.fromkeys(case.session for case in cases))
    right = np.array([case.named[names.index(case.session)] for case in cases])
    for row, name in enumerate(names):
        of = [case.named for case in cases if case.session == name]
        named = np.mean(of, axis=0).round(3).tolist()
        each = np.array(of)[:, row]
        bounds = interval(each[:, None], mean)
        show(table, model=model, session=name, accuracy=mean(each), interval=bounds, named=named, cases=len(of))
    show(
        table,
        model=model,
        session="all",
        accuracy=mean(right),
        interval=interval(right[:, None], mean),
        cases=len(cases),
    )
