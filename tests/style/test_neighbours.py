import numpy as np
import pytest
import torch
from torch import Tensor

from maulstick.style.neighbours import Neighbours
from tests.support.tolerances import FLOAT64_ROUND_TRIP

DIMENSIONS = 5


def torch_rng(seed: int = 0) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def crowd(count: int, at: float = 0.0, seed: int = 0) -> Tensor:
    """Codes (count, 5) that vary by 1 about a place."""
    return torch.from_numpy(np.random.default_rng(seed).normal(at, 1, (count, DIMENSIONS)))


def around(centres: Tensor, bandwidth: float = 0.5) -> Neighbours:
    bandwidths = torch.full((centres.shape[1],), bandwidth, dtype=torch.float64)
    return Neighbours(centres, bandwidths, (1 - bandwidths.square()).sqrt())


def drawn(neighbours: Neighbours, k: int, generator: torch.Generator) -> tuple[Tensor, Tensor]:
    """Return k codes, and the rows that they are around."""
    rows = torch.randint(len(neighbours.centres), (k,), generator=generator)
    return neighbours.sample(rows, generator), rows


def test_few_codes_of_one_kind_are_not_mixed_with_many_of_another() -> None:
    few, many = crowd(5), crowd(30, at=100.0, seed=1)
    codes, of = drawn(around(torch.cat([few, many]), 1.0), 500, torch_rng())
    assert torch.bincount((of < 5).long()).tolist() == [
        pytest.approx(500 * 6 / 7, abs=40),
        pytest.approx(500 / 7, abs=40),
    ]
    assert codes[of < 5].abs().max() < 12
    assert (codes[of >= 5] - 100).abs().max() < 12


def test_a_code_that_is_alone_of_its_kind_is_hardly_moved() -> None:
    alone, many = torch.full((1, DIMENSIONS), 100.0, dtype=torch.float64), crowd(30)
    codes, of = drawn(around(torch.cat([alone, many]), 1.0), 500, torch_rng())
    assert (of == 0).any()
    assert (codes[of == 0] - 100).abs().max() < FLOAT64_ROUND_TRIP


def test_codes_vary_as_much_as_those_that_they_are_drawn_between() -> None:
    centres = crowd(200)
    codes, _ = drawn(around(centres, 0.5), 20_000, torch_rng())
    assert codes.mean(dim=0).numpy() == pytest.approx(centres.mean(dim=0).numpy(), abs=0.1)
    assert (codes.std(dim=0) / centres.std(dim=0)).numpy() == pytest.approx(1, abs=0.15)


def test_without_a_bandwidth_codes_are_copies_and_with_one_they_are_not() -> None:
    centres = crowd(20)
    copies, of = drawn(around(centres, 0.0), 50, torch_rng())
    assert (copies - centres[of]).abs().max() < FLOAT64_ROUND_TRIP
    near, far = ((drawn(around(centres, by), 50, torch_rng())[0] - centres[of]).norm(dim=1) for by in (0.2, 0.6))
    assert near.median() > 0.1
    assert (far > near).float().mean() > 0.9


def test_a_number_of_its_own_bandwidth_varies_by_that() -> None:
    centres = crowd(20)
    bandwidths = torch.tensor([0.0, 0.5, 0.5, 0.5, 0.5]).double()
    codes, of = drawn(Neighbours(centres, bandwidths, torch.ones(DIMENSIONS).double()), 50, torch_rng())
    differs = (codes - centres[of]).abs().amax(dim=0)
    assert differs[0] < FLOAT64_ROUND_TRIP
    assert (differs[1:] > 0.1).all()


def test_a_generator_repeats_codes_to_the_bit() -> None:
    (one, of_one), (two, of_two), (other, _) = (drawn(around(crowd(9)), 9, torch_rng(seed)) for seed in (1, 1, 2))
    assert torch.equal(one, two)
    assert torch.equal(of_one, of_two)
    assert not torch.equal(one, other)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_few_and_equal_codes_have_samples(count: int) -> None:
    centres = torch.ones(count, DIMENSIONS).double()
    codes, _ = drawn(around(centres), 10, torch_rng())
    assert (codes - 1).abs().max() < FLOAT64_ROUND_TRIP


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_most_samples_are_found_to_be_drawn_around_what_they_were(dtype: torch.dtype) -> None:
    centres = crowd(40)
    bandwidths = torch.tensor([2.0] + [0.1] * (DIMENSIONS - 1), dtype=torch.float64)
    neighbours = Neighbours(centres, bandwidths, torch.ones(DIMENSIONS, dtype=torch.float64))
    codes, of = drawn(neighbours, 500, torch_rng())
    assert (neighbours.nearest(codes.to(dtype)) == of).double().mean() > 0.98
    plain = torch.cdist(codes, centres).argmin(dim=1)
    assert (plain == of).double().mean() < 0.75
