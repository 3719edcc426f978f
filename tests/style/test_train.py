from pathlib import Path

import numpy as np
import pytest
import torch

from maulstick.strokes.strokes import resample, standardise
from maulstick.style import train
from maulstick.style.train import fine_tune, pretrain, pretrained
from maulstick.style.trajvae import TrajVAE, activity
from tests.style.test_trajvae import FLAT, ROUND, arcs, rms
from tests.support.style.synthetic_hands import circle, drawn, hand_of, zigzag

DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
SESSIONS = ("cat", "circular", "lia", "long", "strokes")
NETWORK = pretrained()


def session(name: str) -> np.ndarray:
    """Strokes (N, 32, 2) of a motion-capture session, metres, in no order."""
    path = DATA / f"mocap_{name}.npz"
    if not path.exists():
        pytest.skip("shared data absent: motion-capture sessions")
    file = np.load(path, allow_pickle=False)
    strokes = np.split(file["points_m"].astype(np.float64), np.cumsum(file["lengths"])[:-1])
    paths = np.stack([resample(stroke) for stroke in strokes if np.ptp(stroke, axis=0).max() > 1e-3])
    return np.random.default_rng(0).permutation(standardise(paths)[0])


@pytest.mark.parametrize("name", SESSIONS)
def test_unseen_strokes_of_a_session_come_back_to_a_tenth_of_a_millimetre(name: str) -> None:
    paths = session(name)
    few, unseen = paths[:20], paths[20:]
    for style in (TrajVAE("", hand_of(few), NETWORK), fine_tune(NETWORK, hand_of(few), seed=0, steps=20)):
        assert np.median(rms(style, unseen)) < 0.1e-3
        assert activity(style.weights, paths).active > 40


def test_fine_tuning_brings_the_hand_s_own_strokes_nearer_and_does_not_forget_others() -> None:
    hand, others = hand_of(drawn(zigzag, 12)), drawn(circle, 30)
    before, after = TrajVAE("", hand, NETWORK), fine_tune(NETWORK, hand, seed=0, steps=100)
    assert np.median(rms(after, hand.paths)) < 0.8 * np.median(rms(before, hand.paths))
    assert np.median(rms(after, others)) < 0.03e-3


def test_fine_tuning_repeats_by_its_seed_and_leaves_the_network_as_it_was() -> None:
    before = {name: tensor.clone() for name, tensor in NETWORK.items()}
    torch_rng = torch.random.get_rng_state()
    first, again, other = (fine_tune(NETWORK, ROUND, seed, name="round", steps=3) for seed in (0, 0, 1))
    assert first.hash == again.hash != other.hash
    assert first.name == "round"
    assert first.hand is ROUND
    assert all(torch.equal(NETWORK[name], tensor) for name, tensor in before.items())
    assert torch.equal(torch.random.get_rng_state(), torch_rng)
    assert not any(tensor.requires_grad for tensor in first.weights.values())


@pytest.mark.parametrize(
    "paths",
    [
        np.repeat(ROUND.paths[:1], 5, axis=0),
        np.stack([np.linspace(0, mm / 1e3, 32)[:, None] * [1, 0] for mm in (2, 5, 10, 20, 200)]),
        np.repeat(np.linspace(0, 0.02, 32)[None, :, None] * [1, 0], 5, axis=0),
    ],
    ids=["all the same", "all straight", "all the same straight line"],
)
def test_a_hand_of_five_strokes_with_little_in_them_still_makes_a_style(paths: np.ndarray) -> None:
    style = fine_tune(NETWORK, hand_of(paths), seed=0, steps=5)
    code, pressure_knots = style.sample(20, torch.Generator().manual_seed(0))
    assert style.decode(code).isfinite().all()
    assert style.cost(code, pressure_knots).isfinite().all()
    assert np.median(rms(style, paths)) < 0.1e-3


def test_pretraining_repeats_by_its_seed_and_takes_no_other_chance() -> None:
    torch_rng = torch.random.get_rng_state()
    first, again, other = (pretrain([ROUND, FLAT], seed, steps=2) for seed in (0, 0, 1))
    assert all(torch.equal(first[name], again[name]) for name in first)
    assert not torch.equal(first["decoder.0.weight"], other["decoder.0.weight"])
    assert torch.equal(torch.random.get_rng_state(), torch_rng)


def test_pretraining_learns_what_its_hands_draw() -> None:
    hands = [arcs(turning, mm, 12, seed) for seed, (turning, mm) in enumerate([(1, 20), (3, 40), (6, 30), (9, 60)])]
    unseen = arcs(4.5, 30, 30, 9)
    off = [np.median(rms(TrajVAE("", unseen, pretrain(hands, 0, steps)), unseen.paths)) for steps in (1, 60)]
    assert off[1] < 0.2e-3
    assert off[1] < 0.8 * off[0]


def test_strokes_are_learned_in_the_mirror_and_from_their_end() -> None:
    turned = train._turned(ROUND.paths[:3])
    assert np.allclose(turned[:3], ROUND.paths[:3])
    assert np.allclose(turned[3:6, -1], ROUND.paths[:3, -1])
    assert np.allclose(turned[6:9], ROUND.paths[:3] * [1, -1])
    assert np.allclose(turned[3:6, :, 0], ROUND.paths[:3, -1:, 0] - ROUND.paths[:3, ::-1, 0])


def test_the_network_that_ships_is_small() -> None:
    assert sum(tensor.numel() for tensor in NETWORK.values()) * 4 < 1.5e6
    assert all(tensor.dtype == torch.float32 for tensor in NETWORK.values())
