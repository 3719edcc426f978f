"""How like a hand its style draws, as one JSON object per line.

    .venv/bin/python benchmarks/style.py                  # all tables
    .venv/bin/python benchmarks/style.py recognition      # one of reconstruction, few_shot, recognition
    .venv/bin/python benchmarks/style.py price            # likeness to the hand against likeness to the picture

Reconstruction: RMS distance of corresponding points on held-out strokes, with how many numbers a stroke's code takes.

Few-shot likeness: fitted on 20 strokes of a session, 300 are drawn and compared with the session's other strokes, in
descriptions (`style.compare.describe`) standardised over all sessions of a kind. `floor` is the 20 strokes themselves
and `other_people` every other session. `energy` is unbiased; `normalised` is (energy - floor) / (other_people - floor).
`novelty` is the mean distance to the nearest of the 20, in units of other people's.

Recognition: a classifier that knows one half of each mocap session names the session of a sheet of 20 strokes: the one
whose known strokes are at the least energy distance. The sheets are of the other half, drawn by styles fitted on that
other half, or out of finished plans in these styles.
"""

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import torch
from numpy.typing import NDArray
from photographs import BRUSH, laid_out
from published import published_vae
from recordings import mocap_hands, mouse_hands, wacom_drawings

from maulstick.planning.from_picture import as_painting, metrics_of, problem_of, provenance_of
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.strokes.strokes import Strokes
from maulstick.style import shape
from maulstick.style.compare import describe, distance_to_nearest, energy_distance, nearest_neighbour_accuracy
from maulstick.style.exemplar import Exemplar, PooledHands, pool
from maulstick.style.hand import Hand
from maulstick.style.store import load_hands
from maulstick.style.train import fine_tune, pretrained

Floats = NDArray[np.float64]
Sampler = Callable[[int, int], Floats]

FEW, DRAWN, SEEDS = 20, 300, 5
SHEET, SHEETS, SPLITS = 20, 100, 10
HELD = (1.0, 1.5, 4.0, float("inf"))
ENOUGH = 40


def paths_of(strokes: Strokes) -> Floats:
    return strokes.trajectories[..., :2]


def show(name: str, **fields: object) -> None:
    print(
        json.dumps({"name": name} | {k: round(x, 3) if isinstance(x, float) else x for k, x in fields.items()}),
        flush=True,
    )


def split(strokes: Strokes, seed: int, count: int) -> tuple[Strokes, Strokes]:
    rows = np.random.default_rng(seed).permutation(len(strokes))
    return strokes[rows[:count]], strokes[rows[count:]]


# Reconstruction


def reconstruction() -> None:
    sessions = mocap_hands()
    for name, strokes in (sessions | wacom_drawings() | mouse_hands()).items():
        _show_errors("gist", name, paths_of(strokes), _by_gist(paths_of(strokes)), shape.GIST)
    for name, strokes in sessions.items():
        few, rest = split(strokes, 0, FEW)
        held_out = paths_of(rest)
        style = fine_tune(pretrained(), Hand.of(few), seed=0)
        with torch.no_grad():
            codes = style.encode(torch.from_numpy(held_out).float())
            again = style.decode(codes).double().numpy()
        _show_errors("trajvae", name, held_out, again, codes.shape[1])
        others = [paths_of(other) for key, other in sessions.items() if key != name]
        published = published_vae(others, paths_of(few), 0)
        _show_errors("paper", name, held_out, published.reconstruct(held_out), 64)


def _by_gist(paths: Floats) -> Floats:
    numbers = shape.encode(torch.from_numpy(paths))
    numbers[:, shape.GIST :] = 0
    return shape.decode(numbers).numpy()


def _show_errors(model: str, session: str, paths: Floats, again: Floats, numbers: int) -> None:
    errors = np.sqrt(np.square(again - paths).sum(axis=-1).mean(axis=1)) * 1e3
    median, worst = np.percentile(errors, (50, 95))
    show(
        "reconstruction",
        model=model,
        session=session,
        median_mm=float(median),
        p95_mm=float(worst),
        numbers=numbers,
        strokes=len(paths),
    )


# Few-shot likeness


def few_shot() -> None:
    mocap, wacom, mouse = mocap_hands(), wacom_drawings(), mouse_hands()
    _few_shot("mocap", mocap, lambda name: load_hands(), ("paper", "exemplar", "trajvae"))
    hands = {name: Hand.of(strokes) for name, strokes in wacom.items()}

    def of_others(name: str) -> PooledHands:
        return pool([hand for key, hand in hands.items() if key != name])

    _few_shot("wacom", _large(wacom), of_others, ("exemplar",))
    _few_shot("mouse", _large(mouse), lambda name: load_hands(), ("exemplar",))


def _large(sessions: dict[str, Strokes]) -> dict[str, Strokes]:
    return {name: strokes for name, strokes in sessions.items() if len(strokes) >= ENOUGH}


def _few_shot(
    kind: str, sessions: dict[str, Strokes], hands_for: Callable[[str], PooledHands], models: tuple[str, ...]
) -> None:
    described = {name: describe(paths_of(strokes)) for name, strokes in sessions.items()}
    together = np.concatenate(list(described.values()))
    mean, spread = together.mean(axis=0), together.std(axis=0)
    described = {name: (each - mean) / spread for name, each in described.items()}
    metrics: dict[str, list[tuple[float, float, float]]] = {}
    for name, strokes in sessions.items():
        here: dict[str, list[tuple[float, float, float]]] = {}
        for seed in range(SEEDS):
            few, rest = split(strokes, seed, FEW)
            seen, unseen = ((describe(paths_of(part)) - mean) / spread for part in (few, rest))
            others = [each for key, each in described.items() if key != name]
            far = float(np.mean([distance_to_nearest(other, seen) for other in others]))
            compare = partial(_metrics, seen=seen, unseen=unseen, far=far, seed=seed)
            here.setdefault("floor", []).append(compare(seen, novel=unseen))
            here.setdefault("other_people", []).append(
                tuple(np.mean([compare(other) for other in others], axis=0).tolist())
            )
            other_paths = [paths_of(other) for key, other in sessions.items() if key != name]
            for model in models:
                drawn = (describe(_draw(model, few, hands_for(name), other_paths, seed)) - mean) / spread
                here.setdefault(model, []).append(compare(drawn))
        for model, each in here.items():
            energy, one_nn, novelty = np.mean(each, axis=0).tolist()
            show("few_shot", model=model, session=name, energy=energy, one_nn=one_nn, novelty=novelty)
            metrics.setdefault(model, []).extend(each)
    floor, far = (np.mean(metrics[model], axis=0)[0] for model in ("floor", "other_people"))
    for model, each in metrics.items():
        (energy, one_nn, novelty), spreads = np.mean(each, axis=0).tolist(), np.std(each, axis=0).tolist()
        show(
            "few_shot",
            model=model,
            session=f"all {kind}",
            energy=energy,
            one_nn=one_nn,
            novelty=novelty,
            normalised=float((energy - floor) / (far - floor)),
            spread=[round(x, 3) for x in spreads],
        )


def _metrics(
    drawn: Floats, seen: Floats, unseen: Floats, far: float, seed: int, novel: Floats | None = None
) -> tuple[float, float, float]:
    rng = np.random.default_rng(seed)
    novelty = distance_to_nearest(drawn if novel is None else novel, seen) / far
    return energy_distance(drawn, unseen), nearest_neighbour_accuracy(drawn, unseen, rng), novelty


def _draw(model: str, few: Strokes, hands: PooledHands, others: list[Floats], seed: int) -> Floats:
    if model == "paper":
        return published_vae(others, paths_of(few), seed).sample(DRAWN, torch.Generator().manual_seed(seed))
    return _drawn_by(model, Hand.of(few), hands, seed)


def _drawn_by(model: str, hand: Hand, hands: PooledHands, seed: int) -> Floats:
    style = Exemplar.fit("hand", hand, hands) if model == "exemplar" else fine_tune(pretrained(), hand, seed=seed)
    with torch.no_grad():
        codes, _ = style.sample(DRAWN, torch.Generator().manual_seed(seed))
        return style.decode(codes).double().numpy()


# Recognition


def recognition() -> None:
    sessions = mocap_hands()
    for source, model, confusion in (
        ("human", "human", _over_splits(sessions, lambda half, seed: paths_of(half))),
        ("samples", "exemplar", _over_splits(sessions, partial(_samples, "exemplar"))),
        ("samples", "trajvae", _over_splits(sessions, partial(_samples, "trajvae"))),
        ("plans", "exemplar", _over_splits(sessions, _planned, splits=1)),
    ):
        shares = confusion.round(3).tolist()
        for row, session in enumerate(sessions):
            show(
                "recognition", model=model, session=session, accuracy=shares[row][row], source=source, named=shares[row]
            )
        accuracy = float(np.mean(np.diag(confusion)))
        show("recognition", model=model, session="all mocap", accuracy=accuracy, source=source)


def price() -> None:
    sessions = mocap_hands()
    for max_mean_cost in HELD:
        likeness: list[float] = []
        confusion = _over_splits(sessions, partial(_planned, max_mean_cost=max_mean_cost, likeness=likeness), splits=1)
        accuracy = float(np.mean(np.diag(confusion)))
        show(
            "price",
            model="exemplar",
            max_mean_cost=str(max_mean_cost),
            accuracy=accuracy,
            source="plans",
            psnr=float(np.mean(likeness)),
        )


def _over_splits(
    sessions: dict[str, Strokes], strokes_of: Callable[[Strokes, int], Floats], splits: int = SPLITS
) -> Floats:
    """Rows: whose strokes; columns: whom they are taken for; shares of sheets."""
    confusion = np.zeros((len(sessions), len(sessions)))
    for seed in range(splits):
        rng = np.random.default_rng(seed)
        halves = [split(strokes, seed, len(strokes) // 2) for strokes in sessions.values()]
        known = [describe(paths_of(half)) for half, _ in halves]
        together = np.concatenate(known)
        mean, spread = together.mean(axis=0), together.std(axis=0)
        known = [(half - mean) / spread for half in known]
        for row, (_, other) in enumerate(halves):
            described = (describe(strokes_of(other, seed)) - mean) / spread
            for _ in range(SHEETS):
                sheet = described[rng.choice(len(described), SHEET, replace=len(described) < SHEET)]
                named = int(np.argmin([energy_distance(sheet, half) for half in known]))
                confusion[row, named] += 1 / SHEETS / splits
    return confusion


def _samples(model: str, half: Strokes, seed: int) -> Floats:
    return _drawn_by(model, Hand.of(half), load_hands(), seed)


def _planned(
    half: Strokes, seed: int, max_mean_cost: float | None = None, likeness: list[float] | None = None
) -> Floats:
    style = Exemplar.fit("half", Hand.of(half), load_hands())
    if max_mean_cost is not None:
        style = replace(style, max_mean_cost=max_mean_cost)
    layout, options = laid_out("astronaut", 256), PlannerSettings(seed=seed)
    planned = plan(problem_of(layout, BRUSH, style, options), options)
    painting = as_painting(planned, layout, BRUSH, style, provenance_of(options))
    if likeness is not None:
        metrics = metrics_of(painting, layout)
        assert metrics is not None
        likeness.append(metrics.psnr)
    return painting.trajectories()[..., :2]


TABLES = {"reconstruction": reconstruction, "few_shot": few_shot, "recognition": recognition, "price": price}


def main() -> None:
    torch.set_num_threads(1)
    unknown = [word for word in sys.argv[1:] if word not in TABLES]
    if unknown:
        sys.exit(f"there is no table {unknown[0]}; there are: {', '.join(TABLES)}")
    for word in sys.argv[1:] or TABLES:
        TABLES[word]()


if __name__ == "__main__":
    main()
