import numpy as np
import pytest
import torch

from maulstick.storage.arrays import Floats
from maulstick.style.arrangement.laid import Laid, describe
from maulstick.style.arrangement.neighbourhoods import Neighbourhoods
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


def closer(paths: Floats, times: float) -> Floats:
    """Strokes as long, so many times as near each other."""
    centres = paths.mean(axis=1, keepdims=True)
    return paths + (1 / times - 1) * centres


def test_density_counts_strokes_where_there_are_any() -> None:
    one = laid(PATCHES)
    assert laid(0.5 * PATCHES).density() == pytest.approx(one.density())
    assert laid(np.concatenate([PATCHES, PATCHES + 10.0])).density() == pytest.approx(one.density())
    assert laid(closer(PATCHES, 3.0)).density() > 1.5 * one.density()


def test_a_hand_that_must_draw_more_densely_is_asked_for_nearer_strokes_and_one_with_room_is_not() -> None:
    hand = Neighbourhoods.of(laid(PATCHES))
    crowded = hand.crowded(4 * hand.density)
    nearer = hand.numbers - crowded.numbers
    assert nearer[:, :4].numpy() == pytest.approx(np.log(2))
    assert nearer[:, -3:-1].numpy() == pytest.approx(np.log(4))
    assert not nearer[:, 4:-3].any()
    assert not nearer[:, -1].any()
    assert torch.equal(hand.crowded(0.5 * hand.density).numbers, hand.numbers)


def test_gaps_are_those_to_the_lines_of_others() -> None:
    along = np.linspace((0.0, 0.0), (1.0, 0.0), 32)
    lines = np.stack([along + np.array([0.03 * i, 0.1 * i**2]) for i in range(6)])
    numbers = describe(laid(lines), unit=1.0)
    mean, least, spread = numbers[:, -3:].T.numpy()
    nearest = [0.1, 0.1, 0.3, 0.5, 0.7, 0.9]
    assert np.exp(least) == pytest.approx(np.hypot(nearest, 0.005))
    assert np.exp(mean) == pytest.approx(nearest, rel=0.02)
    assert (spread < 0.05).all()


def test_a_strokes_own_line_is_not_the_nearest_however_it_doubles_back() -> None:
    back = np.concatenate([np.linspace((0.0, 0.0), (1.0, 0.0), 16), np.linspace((1.0, 1e-3), (0.0, 1e-3), 16)])
    numbers = describe(laid(np.stack([back + np.array([0.0, 0.5 * i]) for i in range(6)])), unit=1.0)
    assert np.exp(numbers[:, -2].numpy()) == pytest.approx(0.5, abs=2e-3)


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
