import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import logsumexp
from scipy.stats import multivariate_normal

from maulstick.style.density import Density, kernel
from tests.support.tolerances import NATS

DIMENSIONS = 5


def covariance(seed: int, d: int = DIMENSIONS) -> np.ndarray:
    """(d, d) of numbers that vary together, and by very different amounts."""
    rng = np.random.default_rng(seed)
    factor = rng.normal(size=(d, 2 * d)) * 10 ** rng.uniform(-2, 1, (d, 1))
    return np.asarray(factor @ factor.T)


def mixture(m: int, seed: int = 0) -> Density:
    rng = np.random.default_rng(seed)
    centres, scales = rng.normal(size=(m, DIMENSIONS)), rng.uniform(0.3, 2, (m, DIMENSIONS))
    return Density(*(torch.from_numpy(x) for x in (centres, scales, covariance(seed))))


def correlation(matrix: np.ndarray) -> np.ndarray:
    spread = np.sqrt(np.diag(matrix))
    return np.asarray(matrix / np.outer(spread, spread))


def covariance_of(density: Density, i: int) -> np.ndarray:
    scales = density.scales[i].numpy()
    return density.covariance.numpy() * np.outer(scales, scales)


@pytest.mark.parametrize("m", [1, 2, 30])
def test_cost_is_that_of_a_mixture_whose_kernels_are_equally_high(m: int) -> None:
    density = mixture(m)
    points = np.random.default_rng(1).normal(size=(40, DIMENSIONS))
    logs = []
    for i, centre in enumerate(density.centres.numpy()):
        normal = multivariate_normal(centre, covariance_of(density, i))
        logs.append(normal.logpdf(points) - normal.logpdf(centre))
    expected = np.log(m) - logsumexp(logs, axis=0)
    assert density.cost(torch.from_numpy(points))[0].numpy() == pytest.approx(expected, rel=1e-9)


def test_cost_is_between_0_and_the_logarithm_of_how_many_there_are_at_a_centre() -> None:
    density = mixture(12)
    costs = density.cost(density.centres)[0]
    assert costs.min() >= 0
    assert costs.max() <= np.log(12) + NATS
    at_one = Density(density.centres[:1].expand(12, -1), density.scales, density.covariance)
    assert at_one.cost(at_one.centres)[0].numpy() == pytest.approx(0, abs=NATS)


def test_cost_far_from_all_is_finite_and_half_the_square_of_the_distance() -> None:
    density = Density(
        torch.zeros(1, 2).double(), torch.ones(1, 2).double(), torch.diag(torch.tensor([4.0, 1.0])).double()
    )
    far = torch.tensor([[2e6, 0.0], [0.0, 1e6]]).double()
    assert density.cost(far)[0].tolist() == pytest.approx([5e11, 5e11])


def test_cost_has_the_gradient_of_finite_differences() -> None:
    density = mixture(6)
    points = torch.from_numpy(np.random.default_rng(2).normal(size=(4, DIMENSIONS))).requires_grad_()
    assert torch.autograd.gradcheck(density.cost, points)


def test_the_nearest_centre_is_that_of_the_smallest_distance_in_standard_deviations() -> None:
    density = mixture(25)
    points = np.random.default_rng(3).normal(size=(60, DIMENSIONS)) * 2
    apart = []
    for i, centre in enumerate(density.centres.numpy()):
        off = points - centre
        apart.append((off @ np.linalg.inv(covariance_of(density, i)) * off).sum(axis=1))
    nearest = density.nearest(torch.from_numpy(points))
    assert nearest.tolist() == np.argmin(apart, axis=0).tolist()
    assert len(set(nearest.tolist())) > 5
    assert density.nearest(density.centres).tolist() == list(range(25))


def test_a_kernel_of_many_samples_is_shaped_by_them_and_by_what_is_pooled() -> None:
    own = covariance(4)
    stretch = np.sqrt(np.diag(own)) * [1.0, 2.0, 0.5, 3.0, 1.0]
    pooled = correlation(covariance(5)) * np.outer(stretch, stretch)
    drawn = np.random.default_rng(0).multivariate_normal(np.zeros(DIMENSIONS), own, 50_000)
    found = kernel(drawn, pooled)
    mixed = 0.2 * correlation(own) + 0.8 * correlation(pooled)
    assert correlation(found) == pytest.approx(mixed, abs=0.01)
    spread, usual = np.sqrt(np.diag(own)), np.sqrt(np.diag(pooled))
    between = np.sqrt(spread * usual * np.exp(np.mean(np.log(spread / usual))))
    assert np.sqrt(np.diag(found)) == pytest.approx(between, rel=0.02)


def test_a_kernel_where_all_vary_as_is_usual_is_the_usual_one() -> None:
    pooled = covariance(6)
    factor = np.linalg.cholesky(pooled)
    white = np.random.default_rng(0).normal(size=(400, DIMENSIONS))
    white -= white.mean(axis=0)
    white = white @ np.linalg.inv(np.linalg.cholesky(np.cov(white, rowvar=False))).T
    assert kernel(white @ factor.T, pooled) == pytest.approx(pooled, rel=1e-9)
    assert kernel(3 * white @ factor.T, pooled) == pytest.approx(9 * pooled, rel=1e-9), "a hand that varies more"


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.integers(2, 8), st.integers(0, DIMENSIONS))
def test_a_kernel_is_positive_definite_however_few_and_alike_the_samples(seed: int, m: int, constant: int) -> None:
    rng = np.random.default_rng(seed)
    centres = rng.normal(size=(m, DIMENSIONS)) * 10 ** rng.uniform(-3, 1, DIMENSIONS)
    centres[:, :constant] = centres[0, :constant]
    found = kernel(centres, covariance(seed))
    assert np.array_equal(found, found.T)
    least = np.linalg.eigvalsh(correlation(found)).min()
    assert least >= 0.79 * np.linalg.eigvalsh(correlation(covariance(seed))).min()
    assert np.isfinite(np.linalg.cholesky(found)).all()


def test_a_kernel_of_samples_that_are_all_the_same_is_the_usual_one_made_small() -> None:
    pooled = covariance(7)
    found = kernel(np.tile(np.arange(float(DIMENSIONS)), (6, 1)), pooled)
    assert np.sqrt(np.diag(found)) == pytest.approx(0.02 * np.sqrt(np.diag(pooled)))


def test_the_cost_comes_with_the_nearest_centre() -> None:
    density = mixture(9)
    points = torch.randn(40, density.centres.shape[1], generator=torch.Generator().manual_seed(1), dtype=torch.float64)
    assert density.cost(points)[1].tolist() == density.nearest(points).tolist()
