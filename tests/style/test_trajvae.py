from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from torch import Tensor

from maulstick.errors import InputError
from maulstick.strokes.strokes import path_lengths, resample
from maulstick.style.compare import describe, energy_distance
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from maulstick.style.pooled import PooledHands
from maulstick.style.train import pretrained
from maulstick.style.trajvae import LATENT, TrajVAE, activity, shapes
from tests.support.style.synthetic_hands import arc, circle, drawn, strokes_of, zigzag

NETWORK = pretrained()

codes = st.integers(0, 5).flatmap(lambda n: arrays(np.float32, (n, LATENT), elements=st.floats(-3, 3, width=32)))


def arcs(turning: float, mm: float, count: int, seed: int, timed: bool = False) -> Hand:
    """Arcs of about this turning and length, each with a slight tremor."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 1, 300)
    paths = []
    for _ in range(count):
        heading = turning * rng.uniform(0.7, 1.3) * t + 0.1 * np.sin(2 * np.pi * rng.uniform(1, 4) * t)
        steps = mm / 1e3 * rng.uniform(0.7, 1.4) / len(t)
        paths.append(resample(np.cumsum(np.stack([np.cos(heading), np.sin(heading)], axis=1) * steps, axis=0)))
    return Hand.of(strokes_of(np.stack(paths), *((np.linspace(0.2, 0.8, 32), 1.0) if timed else ())))


ROUND, FLAT = arcs(5.5, 25, 20, 0, timed=True), arcs(0.5, 60, 20, 1)
STYLE = TrajVAE("round", ROUND, NETWORK)


def rms(style: TrajVAE, paths: np.ndarray) -> np.ndarray:
    """Of each stroke's points, metres."""
    codes = style.encode(torch.from_numpy(paths))
    off: np.ndarray = (style.decode(codes) - torch.from_numpy(paths)).square().sum(-1).mean(1).sqrt().numpy()
    return off


@pytest.mark.parametrize("hand", [ROUND, FLAT, arcs(9.0, 8, 20, 2)])
def test_strokes_that_the_network_never_saw_come_back_to_a_tenth_of_a_millimetre(hand: Hand) -> None:
    off = rms(STYLE, hand.paths)
    assert np.median(off) < 0.03e-3
    assert off.max() < 0.1e-3


@given(codes)
def test_every_code_decodes_to_a_path_from_the_origin(code: np.ndarray) -> None:
    paths = STYLE.decode(torch.from_numpy(code))
    assert paths.shape == (len(code), 32, 2)
    assert paths.isfinite().all()
    assert torch.equal(paths[:, 0], torch.zeros(len(code), 2))


def test_decode_and_cost_have_the_gradients_of_finite_differences_in_the_coarse_latents() -> None:
    code = STYLE.encode(torch.from_numpy(ROUND.paths[:2]))
    code = code + 0.1 * torch.randn(code.shape, generator=torch.Generator().manual_seed(0))
    coarse, fine = code[:, :16].clone().requires_grad_(), code[:, 16:]
    pressure_knots = torch.rand(2, 4, generator=torch.Generator().manual_seed(1), dtype=torch.float64).requires_grad_()
    assert torch.autograd.gradcheck(lambda x: STYLE.decode(torch.cat([x, fine], dim=1)), coarse)
    assert torch.autograd.gradcheck(
        lambda x, pressure: STYLE.cost(torch.cat([x, fine], dim=1), pressure), (coarse, pressure_knots), rtol=1e-4
    )


def test_no_gradient_flows_into_the_fine_latents_though_they_are_drawn() -> None:
    code = STYLE.encode(torch.from_numpy(ROUND.paths[:2])).requires_grad_()
    (gradient,) = torch.autograd.grad(STYLE.decode(code).square().sum(), code)
    assert (gradient[:, :16] != 0).all()
    assert (gradient[:, 16:] == 0).all()
    changed = torch.cat([code[:, :16], code[:, 16:] + 1], dim=1)
    assert not torch.allclose(STYLE.decode(changed), STYLE.decode(code), rtol=0, atol=1e-5)


def test_decoding_repeats_to_the_bit_and_changes_nothing() -> None:
    code = torch.randn(20, LATENT, generator=torch.Generator().manual_seed(0))
    before, torch_rng = code.clone(), torch.random.get_rng_state()
    paths = STYLE.decode(code)
    assert torch.equal(STYLE.decode(code), paths)
    assert torch.equal(code, before)
    assert torch.equal(torch.random.get_rng_state(), torch_rng)


def test_samples_repeat_with_their_generator() -> None:
    first, again = (STYLE.sample(30, torch.Generator().manual_seed(3)) for _ in range(2))
    other = STYLE.sample(30, torch.Generator().manual_seed(4))
    assert all(torch.equal(a, b) for a, b in zip(first, again, strict=True))
    assert not torch.equal(first[0], other[0])
    assert first[0].dtype == torch.float32


@pytest.mark.parametrize(("hand", "stranger"), [(ROUND, FLAT), (FLAT, ROUND)])
def test_samples_are_like_the_hand_and_not_like_a_stranger_and_no_copies(hand: Hand, stranger: Hand) -> None:
    style = TrajVAE("", hand, NETWORK)
    drawn = describe(style.decode(style.sample(200, torch.Generator().manual_seed(0))[0]).double().numpy())
    seen, others = describe(hand.paths), describe(stranger.paths)
    unit = np.concatenate([seen, others]).std(axis=0)
    assert energy_distance(drawn / unit, seen / unit) < 0.15 * energy_distance(drawn / unit, others / unit)
    nearest = np.linalg.norm((drawn[:, None] - seen) / unit, axis=-1).min(axis=1)
    assert (nearest > 0.05).all()


def test_samples_are_pressed_as_the_hand_presses() -> None:
    _, pressure_knots = STYLE.sample(10, torch.Generator().manual_seed(0))
    assert torch.allclose(pressure_knots, torch.linspace(0.2, 0.8, 4).expand(10, 4), atol=1e-6)


def test_the_longest_stroke_goes_where_there_is_most_room() -> None:
    rooms = torch.tensor([0.03, 0.01, 0.05, 0.02])
    sampled, pressure_knots = STYLE.sample_for(rooms, torch.Generator().manual_seed(0))
    drawn = path_lengths(STYLE.decode(sampled).double().numpy())
    assert drawn.argsort().tolist() == rooms.argsort().tolist()
    assert pressure_knots.shape == (4, 4)


def test_strokes_are_drawn_around_those_of_the_hand_that_are_asked_for() -> None:
    rows = torch.arange(12) % 3
    sampled, _ = STYLE.sample_for(torch.linspace(0.01, 0.05, 12), torch.Generator().manual_seed(0), rows)
    around, _ = STYLE.sample_around(rows, torch.Generator().manual_seed(0))
    assert torch.equal(sampled.sort(dim=0).values, around.sort(dim=0).values)


def test_a_stroke_of_the_hand_is_nearest_to_itself() -> None:
    assert STYLE.nearest(torch.from_numpy(ROUND.paths)).tolist() == list(range(len(ROUND)))


def test_a_stroke_costs_what_it_costs_in_an_exemplar_of_the_same_hand() -> None:
    code, pressure_knots = STYLE.sample(12, torch.Generator().manual_seed(0))
    hands = PooledHands(*(NETWORK[f"hands.{name}"].double().numpy() for name in ("covariance", "residual")))
    exemplar = Exemplar("", ROUND, hands, 0)
    expected = exemplar.cost(exemplar.encode(STYLE.decode(code)), pressure_knots)
    assert torch.allclose(STYLE.cost(code, pressure_knots), expected)
    assert STYLE.max_mean_cost == exemplar.max_mean_cost


def test_own_strokes_cost_little_samples_more_and_a_stranger_s_most() -> None:
    pressed = torch.from_numpy(ROUND.pressure)
    own = STYLE.cost(STYLE.encode(torch.from_numpy(ROUND.paths)), pressed).median()
    sampled = STYLE.cost(*STYLE.sample(200, torch.Generator().manual_seed(0))).median()
    strange = STYLE.cost(STYLE.encode(torch.from_numpy(FLAT.paths)), pressed).median()
    assert own < sampled < strange / 3


def test_speeds_are_those_of_the_nearest_stroke_where_times_were_recorded() -> None:
    code = STYLE.encode(torch.from_numpy(ROUND.paths))
    speeds = STYLE.speeds(code)
    assert speeds is not None
    assert np.allclose(speeds.numpy(), ROUND.speeds)
    assert TrajVAE("", FLAT, NETWORK).speeds(code) is None


def test_the_hash_changes_with_the_network_alone() -> None:
    changed = NETWORK | {"decoder.0.bias": NETWORK["decoder.0.bias"] + 1e-6}
    assert replace(STYLE, weights=changed).hash != STYLE.hash
    assert TrajVAE("other", FLAT, NETWORK).hash == STYLE.hash


def test_a_style_is_the_same_after_a_trip_through_its_arrays() -> None:
    stored = {name: array.astype(np.float64) for name, array in STYLE.arrays().items()} | {"paths": ROUND.paths}
    again = TrajVAE.from_arrays("round", ROUND, stored)
    assert again.hash == STYLE.hash
    assert again.name == STYLE.name == "round"
    code = torch.randn(3, LATENT, generator=torch.Generator().manual_seed(0))
    assert torch.equal(again.decode(code), STYLE.decode(code))


@pytest.mark.parametrize("name", shapes())
@pytest.mark.parametrize("fault", ["missing", "shape", "nan"])
def test_a_network_that_is_not_whole_is_refused(name: str, fault: str) -> None:
    stored = STYLE.arrays()
    array = stored.pop(f"net.{name}")
    if fault != "missing":
        stored[f"net.{name}"] = array[..., :-1] if fault == "shape" else np.full_like(array, np.nan)
    with pytest.raises(InputError, match=rf"^the network's {name} is .*; it must be finite numbers of shape \("):
        TrajVAE.from_arrays("x", ROUND, stored)


def with_latents(spread: Tensor) -> dict[str, Tensor]:
    """A network whose latents are the standardised numbers of a stroke, times `spread` (64,)."""
    zero = {name: torch.zeros_like(tensor) for name, tensor in NETWORK.items() if name.startswith("encoder")}
    return NETWORK | zero | {"encoder.straight": torch.eye(LATENT, 63) * spread[:, None]}


def test_activity_counts_the_latents_that_vary() -> None:
    none = activity(with_latents(torch.zeros(LATENT)), ROUND.paths)
    assert none.active == 0
    one = activity(with_latents(torch.eye(LATENT)[0] * 5), ROUND.paths)
    assert one.active == 1
    assert one.effective_rank == pytest.approx(1)


def test_the_effective_rank_is_the_exponential_of_the_entropy_of_the_eigenvalues() -> None:
    centred = STYLE.encode(torch.from_numpy(ROUND.paths)).numpy()
    shares = np.linalg.svd(centred - centred.mean(axis=0), compute_uv=False) ** 2
    shares = shares[:-1] / shares.sum()  # the mean took one direction
    assert activity(NETWORK, ROUND.paths).effective_rank == pytest.approx(np.prod(shares**-shares), rel=1e-4)


def test_the_shipped_network_has_not_collapsed() -> None:
    used = activity(NETWORK, np.concatenate([drawn(one, 30) for one in (circle, zigzag, arc)]))
    assert used.active > 50
    assert used.effective_rank > 3
