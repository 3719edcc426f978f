"""How like a hand its style draws, as one JSON object per line.

    .venv/bin/python benchmarks/style.py                  # all tables but the last, which plans for an hour
    .venv/bin/python benchmarks/style.py few_shot         # one of reconstruction, few_shot, kinds, recognition
    .venv/bin/python benchmarks/style.py plans            # recognition of 50 plans, on two processes

Reconstruction: RMS distance of corresponding points on held-out strokes, with how many numbers a stroke's code takes;
of networks for each of five seeds, which are other strokes that they learn from and another training.

Few-shot likeness: see `few_shot.py`. `floor` is the 20 strokes themselves and `other_people` every other session.
`normalised` is (energy - floor) / (other_people - floor). Intervals are by bootstrap over sessions, and seeds in them.

Kinds: see `kinds.py`. Recognition and plans: see `recognition.py`.
"""

import argparse
import json
from collections.abc import Callable
from functools import partial
from itertools import product

import numpy as np
import torch
from few_shot import DRAWN, FEW, Few, Likeness, Session, large, paths_of, pool_without, sessions_of, split
from intervals import Floats, interval, mean
from kinds import curls_awry, curls_by_hand, seven_curls, worst_kind
from published import CHOSEN, published_vae
from recognition import plans, recognition
from recordings import mocap_hands, mouse_hands, wacom_drawings

from maulstick.strokes.strokes import Strokes
from maulstick.style import shape
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from maulstick.style.pooled import PooledHands
from maulstick.style.store import load_hands
from maulstick.style.train import fine_tune, pretrained

SEEDS = 5
Draw = Callable[[Session, Strokes, int], Floats]
"""From a session, strokes of it and a seed to strokes that were drawn after them."""


def show(name: str, **fields: object) -> None:
    print(
        json.dumps({"name": name} | {k: round(x, 3) if isinstance(x, float) else x for k, x in fields.items()}),
        flush=True,
    )


# Reconstruction


def reconstruction() -> None:
    sessions = mocap_hands()
    for name, strokes in (sessions | wacom_drawings() | mouse_hands()).items():
        _show_errors("gist", name, paths_of(strokes), _by_gist(paths_of(strokes)), shape.GIST)
    for (name, strokes), seed in product(sessions.items(), range(SEEDS)):
        few, rest = split(strokes, seed, FEW)
        held_out = paths_of(rest)
        style = fine_tune(pretrained(), Hand.of(few), seed=seed)
        with torch.no_grad():
            codes = style.encode(torch.from_numpy(held_out).float())
            again = style.decode(codes).double().numpy()
        _show_errors("trajvae", name, held_out, again, codes.shape[1], seed)
        others = [paths_of(other) for key, other in sessions.items() if key != name]
        published = published_vae(others, paths_of(few), CHOSEN[name], seed)
        _show_errors("paper", name, held_out, published.reconstruct(held_out), 64, seed)


def _by_gist(paths: Floats) -> Floats:
    numbers = shape.encode(torch.from_numpy(paths))
    numbers[:, shape.GIST :] = 0
    return shape.decode(numbers).numpy()


def _show_errors(model: str, session: str, paths: Floats, again: Floats, numbers: int, seed: int = 0) -> None:
    errors = np.sqrt(np.square(again - paths).sum(axis=-1).mean(axis=1)) * 1e3
    median, worst = np.percentile(errors, (50, 95))
    show(
        "reconstruction",
        model=model,
        session=session,
        seed=seed,
        median_mm=float(median),
        p95_mm=float(worst),
        numbers=numbers,
        strokes=len(paths),
    )


# Few-shot likeness and kinds


def few_shot() -> None:
    for kind, sessions, models in _hands():
        measured: dict[str, list[Floats]] = {}
        for session in sessions:
            few = [session.few(seed) for seed in range(SEEDS)]
            floors, others = [one.floor for one in few], [one.other_people for one in few]
            each = {"floor": floors, "other_people": others} | {
                model: [one.compare(draw(session, one.strokes, one.seed)) for one in few]
                for model, draw in models.items()
            }
            for model, likeness in each.items():
                rows = np.array([_row(*three) for three in zip(likeness, floors, others, strict=True)])
                measured.setdefault(model, []).append(rows)
                _show_likeness(model, kind, session.name, rows)
        for model, groups in measured.items():
            bounds = {
                "normalised_interval": interval(groups, _normalised),
                "one_nn_interval": interval(groups, lambda rows: mean(rows[:, 1])),
                "normalised_by_seed": [round(_normalised(rows), 3) for rows in np.stack(groups, axis=1)],
            }
            _show_likeness(model, kind, "all", np.concatenate(groups), **bounds)


def _row(drawn: Likeness, floor: Likeness, other_people: Likeness) -> tuple[float, ...]:
    return drawn.energy, drawn.one_nn, drawn.novelty, floor.energy, other_people.energy


def _normalised(rows: Floats) -> float:
    energy, floor, other_people = rows.mean(axis=0)[[0, 3, 4]]
    return float((energy - floor) / (other_people - floor))


def _show_likeness(model: str, kind: str, session: str, rows: Floats, **bounds: object) -> None:
    energy, one_nn, novelty, *_ = rows.mean(axis=0).tolist()
    show(
        "few_shot",
        model=model,
        kind=kind,
        session=session,
        energy=energy,
        normalised=_normalised(rows),
        one_nn=one_nn,
        novelty=novelty,
        spread=rows.std(axis=0)[:3].round(3).tolist(),
        **bounds,
    )


def kinds() -> None:
    for kind, sessions, every_model in _hands():
        models = {model: draw for model, draw in every_model.items() if model != "paper"}
        people: dict[str, Draw] = {"by people": lambda session, strokes, seed: _rest(session.few(seed))}
        for model, draw in (people | models).items():
            groups = []
            for session in sessions:
                few = [session.few(seed) for seed in range(SEEDS)]
                shares = [worst_kind(one, draw(session, one.strokes, one.seed)) for one in few]
                found = np.array([share for share in shares if share is not None])
                if len(found):
                    groups.append(found)
                    show("worst_kind", model=model, kind=kind, session=session.name, awry=mean(found))
            bounds = interval(groups, mean)
            show(
                "worst_kind", model=model, kind=kind, session="all", awry=mean(np.concatenate(groups)), interval=bounds
            )
        _seven_curls(kind, sessions, models)


def _rest(few: Few) -> Floats:
    return paths_of(few.rest)


def _seven_curls(kind: str, sessions: list[Session], models: dict[str, Draw]) -> None:
    hands = [[(session, seven_curls(session, seed)) for seed in range(SEEDS)] for session in sessions]
    found = [[(session, strokes) for session, strokes in each if strokes is not None] for each in hands]
    found = [each for each in found if each]
    for model, draw in {"by people": None, **models}.items():
        groups = [
            np.array(
                [
                    curls_by_hand(twenty) if draw is None else curls_awry(session, twenty, draw(session, twenty, seed))
                    for seed, (session, twenty) in enumerate(each)
                ]
            )
            for each in found
        ]
        for each, shares in zip(found, groups, strict=True):
            show("seven_curls", model=model, kind=kind, session=each[0][0].name, awry=mean(shares))
        if groups:
            every, bounds = mean(np.concatenate(groups)), interval(groups, mean)
            show("seven_curls", model=model, kind=kind, session="all", awry=every, interval=bounds)


def _hands() -> list[tuple[str, list[Session], dict[str, Draw]]]:
    """Kinds of hands, their sessions, and what draws after them."""
    mocap, wacom, mouse = mocap_hands(), wacom_drawings(), mouse_hands()
    shipped = load_hands()
    pools = {name: pool_without(name, wacom) for name in wacom}
    by_examples: Draw = lambda session, strokes, seed: _drawn_by("exemplar", strokes, seed, shipped)  # noqa: E731
    by_others: Draw = lambda session, strokes, seed: _drawn_by("exemplar", strokes, seed, pools[session.name])  # noqa: E731
    by_network: Draw = lambda session, strokes, seed: _drawn_by("trajvae", strokes, seed, shipped)  # noqa: E731
    return [
        ("mocap", sessions_of(mocap), {"paper": _by_paper, "exemplar": by_examples, "trajvae": by_network}),
        ("wacom", sessions_of(large(wacom)), {"exemplar": by_others}),
        ("mouse", sessions_of(large(mouse)), {"exemplar": by_examples, "trajvae": by_network}),
    ]


def _by_paper(session: Session, strokes: Strokes, seed: int) -> Floats:
    published = published_vae(session.others, paths_of(strokes), CHOSEN[session.name], seed)
    return published.sample(DRAWN, torch.Generator().manual_seed(seed))


def _drawn_by(model: str, strokes: Strokes, seed: int, hands: PooledHands) -> Floats:
    hand = Hand.of(strokes)
    style = Exemplar.fit("hand", hand, hands) if model == "exemplar" else fine_tune(pretrained(), hand, seed=seed)
    with torch.no_grad():
        codes, _ = style.sample(DRAWN, torch.Generator().manual_seed(seed))
        return style.decode(codes).double().numpy()


TABLES: dict[str, Callable[[], None]] = {
    "reconstruction": reconstruction,
    "few_shot": few_shot,
    "kinds": kinds,
    "recognition": lambda: recognition(lambda *drawn: _drawn_by(*drawn, load_hands()), show),
    "plans": partial(plans, show),
}
LONG = ("plans",)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"of {', '.join(TABLES)}")
    words = parser.parse_args().tables
    torch.set_num_threads(1)
    if unknown := [word for word in words if word not in TABLES]:
        parser.error(f"there is no table {unknown[0]}; there are: {', '.join(TABLES)}")
    for word in words or [word for word in TABLES if word not in LONG]:
        TABLES[word]()


if __name__ == "__main__":
    main()
