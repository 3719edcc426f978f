"""Choose the constants of styles on Wacom documents and human drawings alone, one after another, as JSON lines.

    .venv/bin/python benchmarks/style_choices.py                 # of exemplars
    .venv/bin/python benchmarks/style_choices.py trajvae         # of networks, on human drawings alone
    .venv/bin/python benchmarks/style_choices.py cost            # of the cost

The choice is that of least *loss*: the mean, over three kinds of hands, of normalised energy, twice what the
nearest-neighbour accuracy has above 0.5, and the share of curls drawn awry (`kinds.py`). Each is 0 where samples cannot
be told from the hand's strokes, and about 1 where they are another's. Novelty must be 0.3.
The third kind of hands are the human drawings, which came without tremor, with one added (`trembling`): a pen or a
tracker records it. (Networks were pretrained on the Wacom drawings.) For the cost, the loss is how often an unseen
stroke of the hand costs more than a stranger's.
"""

import argparse
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import ModuleType

import numpy as np
import torch
from few_shot import DRAWN, Few, Session, large, paths_of, pool_without, sessions_of
from kinds import curls_awry, seven_curls
from recordings import human_drawings, wacom_drawings

from maulstick.strokes.strokes import POINTS, Strokes, resample, standardise
from maulstick.style import Style, density, exemplar, neighbours, shape, trajvae
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from maulstick.style.pooled import PooledHands
from maulstick.style.store import load_hands
from maulstick.style.train import fine_tune, pretrained
from maulstick.style.trait_costs import gist_and_roughness

LEAST_NOVELTY = 0.3
TREMOR = 0.006
STRANGERS = 60  # strokes of each other session that costs are compared with
Constant = tuple[ModuleType, str, tuple[float, ...]]

EXEMPLAR: tuple[Constant, ...] = (
    (neighbours, "_NEIGHBOURS", (3, 5, 8)),
    (neighbours, "_FARTHEST", (1.0, 1.5, 2.0)),
    (exemplar, "_BANDWIDTH", (0.3, 0.4, 0.5)),
    (exemplar, "_BANDWIDTH_LENGTH", (0.4, 0.7, 0.9)),
    (exemplar, "_BANDWIDTH_ROUGHNESS", (0.1, 0.2, 0.4)),
)
TRAJVAE: tuple[Constant, ...] = (
    (trajvae, "_BANDWIDTH_COARSE", (0.2, 0.4, 0.6, 0.8)),
    (trajvae, "_BANDWIDTH_FINE", (0.1, 0.2, 0.4)),
)
COST: tuple[Constant, ...] = (
    (exemplar, "_OF_COST", (0.2, 0.4, 0.8)),
    (exemplar, "_OF_COST_ROUGHNESS", (0.1, 0.2, 0.4)),
    (exemplar, "_LEAST_BEND", (0.02, 0.05, 0.2)),
    (exemplar, "_MOST_BEND", (1.0, 1.5, 3.0)),
    (density, "_POOLED", (0.2, 0.4, 0.8)),
)


@dataclass(frozen=True)
class Hands:
    """Hands of a kind, of at least 40 strokes each.

    fit: a style of strokes of a session.  few: twenty strokes of each.  curls: seven and thirteen others, of each that
    has them.
    """

    fit: Callable[[Session, Strokes], Style]
    few: list[Few]
    curls: list[tuple[Session, Strokes]]

    @classmethod
    def of(cls, hands: dict[str, Strokes], fit: Callable[[Session, Strokes], Style]) -> "Hands":
        """Those that have so many strokes."""
        sessions = sessions_of(large(hands))
        curls = [(session, found) for session in sessions if (found := seven_curls(session, 0)) is not None]
        return cls(fit, [session.few(0) for session in sessions], curls)

    def of_samples(self) -> dict[str, float]:
        """Loss of samples, and what it is made of."""
        each = [one.compare(_drawn(self.fit(one.session, one.strokes))) for one in self.few]
        energy, floor, other_people = (
            np.mean([one.energy for one in of])
            for of in (each, [one.floor for one in self.few], [one.other_people for one in self.few])
        )
        normalised, one_nn = (energy - floor) / (other_people - floor), np.mean([one.one_nn for one in each])
        awry = [curls_awry(of, twenty, _drawn(self.fit(of, twenty))) for of, twenty in self.curls]
        curls = np.mean(awry) if awry else 0.0
        novelty = np.mean([one.novelty for one in each])
        loss = normalised + 2 * one_nn - 1 + curls if novelty >= LEAST_NOVELTY else np.inf
        values = {"loss": loss, "normalised": normalised, "one_nn": one_nn, "curls": curls, "novelty": novelty}
        return {name: float(value) for name, value in values.items()}

    def of_costs(self) -> dict[str, float]:
        """Share of pairs in which an unseen stroke of the hand costs more than a stranger's."""
        shares = []
        for one in self.few:
            density = self.fit(one.session, one.strokes)._priced
            strangers = np.concatenate([other[:STRANGERS] for other in one.session.others])
            own, strange = (
                density.cost(gist_and_roughness(*shape.parts(shape.encode(torch.from_numpy(paths)))))[0]
                for paths in (paths_of(one.rest), strangers)
            )
            shares.append(float((own[:, None] > strange).double().mean()))
        return {"loss": float(np.mean(shares))}


def trembling(hands: dict[str, Strokes]) -> dict[str, Strokes]:
    """The same strokes with a tremor of a share of their length, which goes on for some three points."""
    rng, shaken = np.random.default_rng(0), {}
    for name, strokes in hands.items():
        white = rng.normal(size=(len(strokes), POINTS + 2, 2))
        tremor = TREMOR * strokes.lengths[:, None, None] * (white[:, :-2] + white[:, 1:-1] + white[:, 2:]) / 3
        paths, _ = standardise(np.stack([resample(path) for path in paths_of(strokes) + tremor]))
        trajectories = np.concatenate([paths, strokes.trajectories[..., 2:]], axis=-1)
        shaken[name] = Strokes(trajectories, strokes.times, strokes.poses)
    return shaken


def _drawn(style: Style) -> exemplar.Floats:
    with torch.no_grad():
        codes, _ = style.sample(DRAWN, torch.Generator().manual_seed(0))
        return style.decode(codes).double().numpy()


@contextmanager
def _set(module: ModuleType, name: str, value: float) -> Iterator[None]:
    before = getattr(module, name)
    setattr(module, name, value)
    try:
        yield
    finally:
        setattr(module, name, before)


def choose(constants: tuple[Constant, ...], losses: Callable[[], list[dict[str, float]]]) -> None:
    """Print the losses of each value of each constant, and keep the best for those after it."""
    for module, name, values in constants:
        found = {}
        for value in values:
            with _set(module, name, value):
                each = losses()
            found[value] = float(np.mean([one["loss"] for one in each]))
            rounded = [{key: round(number, 3) for key, number in one.items()} for one in each]
            print(
                json.dumps({"constant": name, "value": value, "loss": round(found[value], 4), "of": rounded}),
                flush=True,
            )
        best = min(found, key=lambda value: found[value])
        print(json.dumps({"constant": name, "chosen": best}), flush=True)
        setattr(module, name, best)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("of", nargs="?", choices=["exemplar", "trajvae", "cost"], default="exemplar")
    word = parser.parse_args().of
    torch.set_num_threads(1)
    wacom, drawings = wacom_drawings(), human_drawings()
    pools: dict[str, PooledHands] = {name: pool_without(name, wacom) for name in wacom}
    shipped, network = load_hands(), pretrained()

    def by_examples(session: Session, strokes: Strokes) -> Style:
        return Exemplar.fit("hand", Hand.of(strokes), pools.get(session.name, shipped))

    if word == "trajvae":
        tuned = {}

        def by_network(session: Session, strokes: Strokes) -> Style:
            key = (session.name, strokes.trajectories.tobytes())
            if key not in tuned:
                tuned[key] = fine_tune(network, Hand.of(strokes), seed=0)
            return trajvae.TrajVAE("hand", tuned[key].hand, tuned[key].weights)

        of_drawings = Hands.of(drawings, by_network)
        choose(TRAJVAE, lambda: [of_drawings.of_samples()])
        return
    both = [Hands.of(hands, by_examples) for hands in (wacom, drawings, trembling(drawings))]
    if word == "cost":
        choose(COST, lambda: [hands.of_costs() for hands in both])
    else:
        choose(EXEMPLAR, lambda: [hands.of_samples() for hands in both])


if __name__ == "__main__":
    main()
