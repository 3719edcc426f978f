import numpy as np
import pytest
import torch

from maulstick.storage.arrays import Floats
from maulstick.style.arrangement.neighbourhoods import Laid, Neighbourhoods
from tests.support.drawn import hatching, rotation, scattered

PATCHES = hatching(8, seed=0)


def laid(paths: Floats) -> Laid:
    tensor = torch.from_numpy(paths)
    return Laid.of(tensor, tensor.mean(dim=1), torch.zeros(len(paths)))


def price(paths: Floats, of: Floats = PATCHES) -> float:
    return float(Neighbourhoods.of(laid(of)).price(laid(paths), torch.Generator().manual_seed(0)))


def test_a_hand_is_as_itself_wherever_and_however_it_is_turned() -> None:
    own = price(PATCHES)
    assert own < 0.01 * price(scattered(64, seed=1))
    assert price(PATCHES @ rotation(1.0) + 0.3) == pytest.approx(own, rel=1e-6)


def test_more_of_the_same_hand_is_nearer_than_its_strokes_at_other_places_or_angles() -> None:
    rng = np.random.default_rng(0)
    centres = PATCHES.mean(axis=1, keepdims=True)
    elsewhere = PATCHES - centres + rng.permutation(centres)
    turned = np.array(
        [(path - path.mean(axis=0)) @ rotation(rng.uniform(0, 6)) + path.mean(axis=0) for path in PATCHES]
    )
    more = price(hatching(20, seed=1))
    assert more < 0.2 * price(turned)
    assert more < 0.2 * price(elsewhere)
    assert more < 0.2 * price(scattered(64, seed=1))


def test_how_dense_strokes_are_costs_nothing() -> None:
    denser = 0.5 * PATCHES.mean(axis=1, keepdims=True)
    assert price(PATCHES - PATCHES.mean(axis=1, keepdims=True) + denser) < 0.05 * price(scattered(64, seed=1))


def test_halves_of_a_hand_are_usually_nearer_than_another_hand() -> None:
    neighbourhoods = Neighbourhoods.of(laid(PATCHES))
    assert 0 < neighbourhoods.usual < 0.5 * price(scattered(64, seed=1))


def test_descent_on_the_price_arranges_strewn_strokes_as_the_hand_does() -> None:
    neighbourhoods, torch_rng = Neighbourhoods.of(laid(PATCHES)), torch.Generator().manual_seed(0)
    strewn = torch.from_numpy(scattered(64, seed=1))
    centres, angles = strewn.mean(dim=1).clone().requires_grad_(), torch.zeros(64).double().requires_grad_()
    adam = torch.optim.Adam([{"params": [centres], "lr": 5e-4}, {"params": [angles], "lr": 0.05}])
    prices = []
    for _ in range(150):
        adam.zero_grad()
        now = neighbourhoods.price(Laid.of(strewn, centres, angles), torch_rng)
        now.backward()
        adam.step()
        prices.append(now.item())
    assert np.mean(prices[-10:]) < 0.4 * np.mean(prices[:10])


def test_strokes_on_top_of_each_other_have_a_price_and_a_slope() -> None:
    heap = torch.from_numpy(np.repeat(PATCHES[:1], 12, axis=0))
    centres = heap.mean(dim=1).clone().requires_grad_()
    neighbourhoods = Neighbourhoods.of(laid(PATCHES))
    neighbourhoods.price(Laid.of(heap, centres, torch.zeros(12)), torch.Generator().manual_seed(0)).backward()
    assert centres.grad is not None
    assert centres.grad.isfinite().all()
