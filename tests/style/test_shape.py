import numpy as np
import pytest
import torch
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from torch import Tensor

from maulstick.strokes.strokes import resample, standardise
from maulstick.style.shape import GIST, RESIDUAL, decode, encode, spline_basis
from tests.support.style.synthetic_hands import circle, drawn, line, zigzag
from tests.support.tolerances import FLOAT32_ROUND_TRIP, FLOAT64_ROUND_TRIP, LEAST_SPLINE

NUMBERS = GIST + RESIDUAL

shapes = arrays(np.float64, (3, 32, 2), elements=st.floats(-1, 1))
sizes = st.sampled_from([1e-12, 1e-8, 1e-6, 1e-3, 1.0, 1e4])


def starting_at_0(paths: np.ndarray) -> Tensor:
    return torch.from_numpy(paths - paths[:, :1])


def gist_only(numbers: Tensor) -> Tensor:
    return torch.cat([numbers[:, :GIST], torch.zeros_like(numbers[:, GIST:])], dim=1)


def humanlike() -> Tensor:
    return torch.from_numpy(np.concatenate([drawn(one, 5) for one in (circle, zigzag, line)]))


def size_of(paths: Tensor) -> Tensor:
    return paths.abs().amax(dim=(1, 2))


def test_there_are_as_many_numbers_as_coordinates_that_are_free() -> None:
    assert (GIST, RESIDUAL) == (16, 47)
    assert NUMBERS == 31 * 2 + 1, "a length more than the points have"


@given(shapes, sizes)
def test_any_path_is_found_again_exactly(shape: np.ndarray, size: float) -> None:
    paths = starting_at_0(shape * size)
    numbers = encode(paths)
    assert numbers.shape == (3, NUMBERS)
    assert numbers.isfinite().all()
    long_enough = numbers[:, 0].exp() > 1.001 * LEAST_SPLINE
    assume(long_enough.any())
    wrong = size_of(decode(numbers) - paths) / size_of(paths)
    assert wrong[long_enough].max() < FLOAT64_ROUND_TRIP


def test_a_path_that_takes_one_step_of_a_micrometre_and_then_stays_is_found_again_exactly() -> None:
    path = torch.ones(1, 32, 2, dtype=torch.float64) * 1e-6
    path[0, 0] = 0
    path[..., 0] = 0
    assert (size_of(decode(encode(path)) - path) / size_of(path)).item() < FLOAT64_ROUND_TRIP


@given(shapes, sizes)
def test_a_path_without_length_is_found_again_to_a_micrometre(shape: np.ndarray, size: float) -> None:
    paths = starting_at_0(shape * min(size, 1e-6))
    assert (decode(encode(paths)) - paths).abs().max() < 2 * LEAST_SPLINE


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_a_straight_and_a_closed_path_are_found_again_in_either_precision(size: float) -> None:
    t = np.linspace(0, 1, 200)
    straight = np.stack([t, 0 * t], axis=1)
    ring = np.stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)], axis=1)
    askew = np.stack([np.cos(1.995 * np.pi * t), 1.1 * np.sin(1.995 * np.pi * t)], axis=1)
    there_and_back = np.stack([np.minimum(t, 1 - t), 0 * t], axis=1)
    paths = [resample(path * size) for path in (straight, ring, askew, there_and_back)]
    exact = torch.from_numpy(standardise(np.stack(paths))[0])
    for dtype, close in ((torch.float64, FLOAT64_ROUND_TRIP), (torch.float32, FLOAT32_ROUND_TRIP)):
        rounded = exact.to(dtype)
        again = decode(encode(rounded))
        assert again.dtype == dtype
        assert (size_of(again - rounded) / size_of(rounded)).max() < close


def test_the_gist_alone_is_the_least_squares_spline() -> None:
    paths = humanlike()
    basis = spline_basis(9)
    expected = np.zeros((len(paths), 32, 2))
    for i, path in enumerate(paths.numpy()):
        for axis, columns in ((0, basis[:, 1:]), (1, basis[:, 1:-1])):  # from the origin to the x-axis
            expected[i, :, axis] = columns @ np.linalg.lstsq(columns, path[:, axis], rcond=None)[0]
    found = decode(gist_only(encode(paths)))
    assert found.numpy() == pytest.approx(expected, abs=FLOAT64_ROUND_TRIP)
    lengths = found.diff(dim=1).norm(dim=-1).sum(1)
    assert encode(paths)[:, 0].exp().numpy() == pytest.approx(lengths.numpy(), rel=FLOAT64_ROUND_TRIP)


def test_a_spline_leaves_no_residual() -> None:
    splines = decode(gist_only(encode(humanlike())))
    assert encode(splines)[:, GIST:].abs().max() < FLOAT64_ROUND_TRIP


def test_a_residual_is_as_large_as_what_the_spline_leaves_and_orthogonal_to_it() -> None:
    paths = humanlike()
    numbers = encode(paths)
    left = (paths - decode(gist_only(numbers))).numpy()
    in_lengths = np.linalg.norm(left.reshape(len(left), -1), axis=1) / numbers[:, 0].exp().numpy()
    assert numbers[:, GIST:].norm(dim=1).numpy() == pytest.approx(in_lengths, rel=1e-9)
    for axis, columns in ((0, spline_basis(9)[:, 1:]), (1, spline_basis(9)[:, 1:-1])):
        assert np.abs(left[..., axis] @ columns).max() < FLOAT64_ROUND_TRIP


def test_residuals_are_measured_in_an_orthonormal_basis() -> None:
    numbers = encode(humanlike()[:1]).expand(RESIDUAL, -1).clone()
    numbers[:, GIST:] = torch.eye(RESIDUAL)
    moves = ((decode(numbers) - decode(gist_only(numbers))) / numbers[0, 0].exp()).flatten(1)
    assert (moves @ moves.T).numpy() == pytest.approx(np.eye(RESIDUAL), abs=FLOAT64_ROUND_TRIP)


def test_a_code_means_the_same_stroke_on_every_machine() -> None:
    i = np.arange(32)
    comb = np.where((i > 0) & (i < 31), 0.002 * (i % 3 - 1), 0)
    numbers = encode(torch.from_numpy(np.stack([0.03 * i / 31, comb], axis=1))[None])[0]
    assert numbers[[0, 3, 9, 15, 40, 41, 62]].tolist() == pytest.approx(
        [
            -3.5051740401101745,
            0.33287236662634684,
            0.016479509599516915,
            -0.0050719601065863495,
            -0.0021309786354393877,
            0.018271854807332406,
            -2.7506214001119052e-05,
        ],
        rel=1e-9,
    )
    numbers = torch.cat([torch.tensor([-3.5]), torch.arange(15) / 10, torch.linspace(-0.02, 0.03, RESIDUAL)]).double()
    assert decode(numbers[None])[0, [1, 10, 20, 31]].numpy() == pytest.approx(
        np.array(
            [
                [-0.0012471674517952737, 0.005648188692434134],
                [0.0021174199035776118, 0.010231701518943584],
                [0.004111580372171949, 0.012432588160788792],
                [0.00741750933110397, 7.16873773634725e-06],
            ]
        ),
        abs=1e-9,  # the numbers that were pinned began in float32
    )


def test_the_logarithm_of_length_makes_all_of_a_stroke_longer() -> None:
    numbers = encode(humanlike())
    longer = torch.cat([numbers[:, :1] + np.log(2), numbers[:, 1:]], dim=1)
    assert decode(longer).numpy() == pytest.approx(2 * decode(numbers).numpy(), rel=FLOAT64_ROUND_TRIP)


def test_decoding_has_the_gradients_of_finite_differences() -> None:
    numbers = encode(humanlike()[[0, 5, 10]])
    numbers = numbers + 0.01 * torch.randn(numbers.shape, generator=torch.Generator().manual_seed(0)).double()
    assert torch.autograd.gradcheck(decode, numbers.requires_grad_())


def test_a_stroke_of_no_length_is_a_point_with_finite_gradients() -> None:
    numbers = encode(torch.zeros(1, 32, 2)).requires_grad_()
    path = decode(numbers)
    assert not path.any()
    (gradient,) = torch.autograd.grad(path.sum(), numbers)
    assert gradient.isfinite().all()


def test_no_strokes_are_no_numbers() -> None:
    assert encode(torch.zeros(0, 32, 2)).shape == (0, NUMBERS)
    assert decode(torch.zeros(0, NUMBERS)).shape == (0, 32, 2)
