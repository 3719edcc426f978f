import numpy as np
import pytest
import torch

from maulstick.planning.spread import spread
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import path_lengths
from maulstick.style.arrangement import Arrangement
from maulstick.style.arrangement.laid import Laid
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from tests.support.drawn import as_strokes, hatching, rotation
from tests.support.style.synthetic_hands import all_hands

HAND = Exemplar("hatcher", Hand.of(as_strokes(hatching(8, seed=0))), all_hands(), 0.0)
SHEET = (0.36, 0.18)


def arrangement() -> Arrangement:
    assert HAND.arrangement is not None
    return HAND.arrangement


def far(paths: Floats) -> float:
    laid = Laid.of(torch.from_numpy(paths), torch.from_numpy(paths.mean(axis=1)), torch.zeros(len(paths)))
    return float(arrangement().neighbourhoods.price(laid, torch.Generator().manual_seed(1)))


def test_strokes_lie_as_the_hands_do_and_shuffled_or_turned_they_do_not() -> None:
    found = spread(HAND, arrangement(), *SHEET)
    assert len(found) == len(arrangement().paths)
    assert path_lengths(found).mean() == pytest.approx(path_lengths(arrangement().paths).mean(), rel=0.15)
    rng, middles = np.random.default_rng(0), found.mean(axis=1, keepdims=True)
    shuffled = found - middles + rng.permutation(middles)
    turned = middles + np.array([path @ rotation(rng.uniform(0, 6)) for path in found - middles])
    assert far(found) < 0.3 * min(far(shuffled), far(turned))


def test_strokes_are_on_the_sheet_and_all_over_it() -> None:
    middles = spread(HAND, arrangement(), *SHEET).mean(axis=1)
    assert (middles > -0.01).all()
    assert (middles < np.array(SHEET) + 0.01).all()
    quarters, counts = np.unique((middles / SHEET > 0.5) @ [1, 2], return_counts=True)
    assert len(quarters) == 4
    assert counts.min() >= 4


def test_a_seed_repeats_the_strokes_and_another_does_not() -> None:
    one, same, other = (spread(HAND, arrangement(), *SHEET, seed=seed) for seed in (0, 0, 1))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)
