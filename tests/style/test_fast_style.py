"""The fast versions of a style's sums beside the plain ones: values, and all slopes."""

from collections.abc import Callable

import numpy as np
import pytest
import torch
from torch import Tensor

from maulstick.style import shape
from maulstick.style.density import Density
from maulstick.style.trait_costs import plain_trait_costs, trait_costs, traits
from tests.support.style.synthetic_hands import all_hands, circle, drawn, exemplar_of, line, zigzag
from tests.support.tolerances import FLOAT32_GRADIENT

ROUNDING = 2e-6  # relative to the largest number, of float32

HANDS = all_hands()
KINDS = (circle, zigzag, line)


def numbers() -> tuple[Tensor, Tensor]:
    """Gist (90, 16) and residual (90, 47) of strokes of three kinds, float64."""
    return shape.parts(shape.encode(torch.from_numpy(np.concatenate([drawn(one, 30) for one in KINDS]))))


def slopes(of: Callable[..., Tensor], signal: Tensor, *inputs: Tensor) -> list[Tensor]:
    leaves = [each.clone().requires_grad_() for each in inputs]
    (of(*leaves).double() * signal).sum().backward()
    return [leaf.grad.double() for leaf in leaves if leaf.grad is not None]


def noise(*size: int) -> Tensor:
    return torch.randn(*size, generator=torch.Generator().manual_seed(0), dtype=torch.float64)


def is_near(fast: Tensor, plain: Tensor, share: float) -> bool:
    return bool((fast.double() - plain).abs().max() <= share * plain.abs().max())


def test_paths_and_their_slopes_are_those_of_the_plain_way() -> None:
    given = numbers()
    single = [each.float() for each in given]
    assert is_near(shape.drawn(*single), shape.plain_drawn(*given), ROUNDING)
    signal = noise(90, 32, 2)
    for fast, plain in zip(
        slopes(shape.drawn, signal, *single), slopes(shape.plain_drawn, signal, *given), strict=True
    ):
        for column in plain.unbind(1):
            assert column.any()
        assert is_near(fast, plain, FLOAT32_GRADIENT)


def test_paths_of_splines_without_length_are_those_of_the_plain_way() -> None:
    gist, residual = numbers()
    gist[:45, 1:] = 0
    gist[45:, 1:] *= 1e-9
    single = [each.float() for each in (gist, residual)]
    assert is_near(shape.drawn(*single), shape.plain_drawn(*(each.double() for each in single)), ROUNDING)
    signal = noise(90, 32, 2)
    fast, plain = (slopes(of, signal, *single) for of in (shape.drawn, shape.plain_drawn))
    for one, other in zip(fast, plain, strict=True):
        assert one.isfinite().all()
        assert is_near(one, other, FLOAT32_GRADIENT)


def test_a_residual_that_stays_has_no_slope_and_changes_none() -> None:
    gist, residual = (each.float() for each in numbers())
    still, moving = gist.clone().requires_grad_(), gist.clone().requires_grad_()
    shape.drawn(still, residual).square().sum().backward()
    shape.drawn(moving, residual.clone().requires_grad_()).square().sum().backward()
    assert still.grad is not None
    assert moving.grad is not None
    assert torch.equal(still.grad, moving.grad)


@pytest.mark.parametrize("copies", [1, 3])
def test_costs_of_traits_and_their_slopes_are_those_of_the_plain_way(copies: int) -> None:
    gist, residual = (each.repeat(copies, 1) for each in numbers())  # of copies, traits have equal ranks to share
    wanted = traits(*numbers())[:30].repeat(3 * copies, 1).sort(dim=0).values
    widths = traits(*numbers()).std(dim=0)
    signal = noise(len(gist))

    def fast(gist: Tensor) -> Tensor:
        return trait_costs(gist, residual.float(), wanted, widths)

    def plain(gist: Tensor) -> Tensor:
        return plain_trait_costs(gist, residual, wanted, widths)

    assert is_near(fast(gist.float()), plain(gist), 1e-4)
    (found,), (expected,) = slopes(fast, signal, gist.float()), slopes(plain, signal, gist)
    for column in expected.unbind(1):
        assert column.any()
    assert is_near(found, expected, FLOAT32_GRADIENT)


def test_turning_is_added_up_over_many_turns() -> None:
    along = torch.linspace(0, 1, 32, dtype=torch.float64)
    spirals = torch.stack(
        [torch.stack([along * (turns * 6.283 * along).cos(), along * (turns * 6.283 * along).sin()], dim=-1)
         for turns in (0.1, 0.6, 1.4, 3.0, 6.5)]
    )  # fmt: skip
    gist, residual = shape.parts(shape.encode(spirals))
    wanted = torch.zeros(5, 19, dtype=torch.float64)
    only_turning = torch.cat([torch.full((18,), 1e9, dtype=torch.float64), torch.ones(1, dtype=torch.float64)])
    found = trait_costs(gist.float(), residual.float(), wanted, only_turning)
    assert (2 * found.double()).sqrt().numpy() == pytest.approx(traits(gist, residual)[:, -1].numpy(), rel=1e-5)


def test_a_residual_with_slopes_is_priced_plainly() -> None:
    gist, residual = (each.float() for each in numbers())
    residual.requires_grad_()
    style = exemplar_of(circle)
    style.price(torch.cat([gist, residual], dim=1), torch.full((90, 4), 0.5)).sum().backward()
    assert residual.grad is not None
    assert residual.grad.any()


@pytest.mark.parametrize("alike", [True, False])
def test_costs_by_a_density_and_their_slopes_are_those_of_the_plain_way(alike: bool) -> None:
    rng = np.random.default_rng(0)
    factor, centres = rng.normal(size=(6, 9)), rng.normal(size=(40, 6))
    scales = rng.uniform(0.3, 1, (40, 6))
    if alike:
        scales[:, 1:4], scales[:, 5] = scales[:, 1:2], 0.2
    density = Density(*(torch.from_numpy(x) for x in (centres, scales, factor @ factor.T)))
    points = torch.cat([density.centres[:10], 3 * noise(50, 6)])
    (fast, nearest), (plain, expected) = density.cost(points), density.plain_cost(points)
    assert is_near(fast, plain, 1e-12)
    assert nearest.tolist() == expected.tolist()
    signal = noise(60)
    (found,), (wanted,) = (
        slopes(lambda x, of=of: of(x)[0], signal, points) for of in (density.cost, density.plain_cost)
    )
    assert is_near(found, wanted, 1e-9)
