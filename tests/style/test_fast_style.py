"""The fast versions of a style's sums beside the plain ones: values, and all slopes."""

from collections.abc import Callable

import numpy as np
import pytest
import torch
from torch import Tensor

from maulstick.style import shape
from maulstick.style.density import Density
from maulstick.style.free import FreeStyle
from maulstick.style.trait_costs import gist_and_roughness, plain_trait_costs, trait_costs, traits
from maulstick.style.traits import path_length, plain_path_length
from tests.support.style.synthetic_hands import all_hands, circle, drawn, exemplar_of, line, zigzag
from tests.support.tolerances import FLOAT32_GRADIENT, FLOAT32_GRADIENT_CREASED

ROUNDING = 2e-6  # relative to the largest number, of float32

HANDS = all_hands()
KINDS = (circle, zigzag, line)


def numbers() -> tuple[Tensor, Tensor]:
    """Gist (90, 16) and residual (90, 47) of strokes of three kinds, float64."""
    return shape.parts(shape.encode(torch.from_numpy(np.concatenate([drawn(one, 30) for one in KINDS]))))


def seen() -> tuple[Tensor, Tensor]:
    """What costs of traits depend on: gist and roughness (90, 17), and strays (90, 2, 32), float64."""
    gist, residual = numbers()
    return gist_and_roughness(gist, residual), shape.strays(residual)


def slopes(of: Callable[..., Tensor], signal: Tensor, *inputs: Tensor) -> list[Tensor]:
    leaves = [each.clone().requires_grad_() for each in inputs]
    (of(*leaves).double() * signal).sum().backward()
    return [leaf.grad.double() for leaf in leaves if leaf.grad is not None]


def noise(*size: int) -> Tensor:
    return torch.randn(*size, generator=torch.Generator().manual_seed(0), dtype=torch.float64)


def is_near(fast: Tensor, plain: Tensor, share: float) -> bool:
    return bool((fast.double() - plain).abs().max() <= share * plain.abs().max())


def test_paths_and_their_slopes_are_those_of_the_plain_way() -> None:
    gist, residual = numbers()
    given = gist, shape.strays(residual)
    single = [each.float() for each in given]
    assert is_near(shape.drawn(*single), shape.plain_drawn(*given), ROUNDING)
    signal = noise(90, 32, 2)
    found, expected = slopes(shape.drawn, signal, *single), slopes(shape.plain_drawn, signal, *given)
    for fast, plain in zip(found, expected, strict=True):
        for column in plain.unbind(1):
            assert column.any()
        assert is_near(fast, plain, FLOAT32_GRADIENT)


def test_paths_of_splines_without_length_are_those_of_the_plain_way() -> None:
    gist, residual = numbers()
    gist[:45, 1:] = 0
    gist[45:, 1:] *= 1e-9
    single = [each.float() for each in (gist, shape.strays(residual))]
    assert is_near(shape.drawn(*single), shape.plain_drawn(*(each.double() for each in single)), ROUNDING)
    signal = noise(90, 32, 2)
    fast, plain = (slopes(of, signal, *single) for of in (shape.drawn, shape.plain_drawn))
    for one, other in zip(fast, plain, strict=True):
        assert one.isfinite().all()
        assert is_near(one, other, FLOAT32_GRADIENT)


def test_strays_that_stay_have_no_slope_and_change_none() -> None:
    gist, strays = (each.float() for each in seen())
    still, moving = gist[:, :16].clone().requires_grad_(), gist[:, :16].clone().requires_grad_()
    shape.drawn(still, strays).square().sum().backward()
    shape.drawn(moving, strays.clone().requires_grad_()).square().sum().backward()
    assert still.grad is not None
    assert moving.grad is not None
    assert torch.equal(still.grad, moving.grad)


@pytest.mark.parametrize("copies", [1, 3])
def test_costs_of_traits_and_their_slopes_are_those_of_the_plain_way(copies: int) -> None:
    given = [each.repeat(copies, *[1] * (each.ndim - 1)) for each in seen()]  # copies have equal ranks to share
    wanted = traits(*seen())[:30].repeat(3 * copies, 1).sort(dim=0).values
    widths = traits(*seen()).std(dim=0)
    signal = noise(len(given[0]))

    def fast(*given: Tensor) -> Tensor:
        return trait_costs(*given, wanted, widths)

    def plain(*given: Tensor) -> Tensor:
        return plain_trait_costs(*given, wanted, widths)

    single = [each.float() for each in given]
    assert is_near(fast(*single), plain(*given), FLOAT32_GRADIENT)
    found, expected = slopes(fast, signal, *single), slopes(plain, signal, *given)
    for one, other in zip(found, expected, strict=True):
        for column in other.unbind(1):
            assert column.any()
        assert is_near(one, other, FLOAT32_GRADIENT_CREASED)  # zigzags turn sharply
    assert is_near(found[0], expected[0], FLOAT32_GRADIENT)
    assert torch.equal(slopes(lambda gist: fast(gist, single[1]), signal, single[0])[0], found[0])


def test_turning_is_added_up_over_many_turns() -> None:
    along = torch.linspace(0, 1, 32, dtype=torch.float64)
    angles = 6.283 * torch.tensor([0.1, 0.6, 1.4, 3.0, 6.5], dtype=torch.float64)[:, None] * along
    gist, residual = shape.parts(shape.encode(along[:, None] * torch.stack([angles.cos(), angles.sin()], dim=-1)))
    given = gist_and_roughness(gist, residual), shape.strays(residual)
    wanted = torch.zeros(5, 19, dtype=torch.float64)
    only_turning = torch.cat([torch.full((18,), 1e9, dtype=torch.float64), torch.ones(1, dtype=torch.float64)])
    found = trait_costs(*(each.float() for each in given), wanted, only_turning)
    assert (2 * found.double()).sqrt().numpy() == pytest.approx(traits(*given)[:, -1].numpy(), rel=1e-5)


def test_a_price_has_slopes_in_a_residual_where_they_are_asked_for() -> None:
    gist, residual = (each.float() for each in numbers())
    residual.requires_grad_()
    exemplar_of(circle).price(torch.cat([gist, residual], dim=1), torch.full((90, 4), 0.5)).sum().backward()
    assert residual.grad is not None
    assert residual.grad.any()


def test_codes_decode_alike_after_others_whose_residuals_differ() -> None:
    style = exemplar_of(circle)
    first, second = (style.sample(20, torch.Generator().manual_seed(seed))[0] for seed in (0, 1))
    paths = [style.decode(codes) for codes in (first, second, first)]
    assert torch.equal(paths[0], paths[2])
    assert not torch.equal(paths[0], paths[1])
    changed = first.clone()
    style.decode(changed)
    changed[0, -1] += 1
    assert not torch.equal(style.decode(changed), paths[0])


def test_lengths_are_those_of_the_plain_way() -> None:
    paths = shape.drawn(*(each.float() for each in (numbers()[0], shape.strays(numbers()[1]))))
    assert is_near(path_length(paths), plain_path_length(paths.double()), ROUNDING)
    assert path_length(paths.requires_grad_()).requires_grad


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


@pytest.mark.parametrize("times", [1.0, 1e-3, 30.0, 0.0])
def test_costs_of_free_strokes_and_their_slopes_are_those_of_the_plain_way(times: float) -> None:
    style = FreeStyle(shortest=0.004, longest=0.1)
    codes, knots = times * noise(60, 13), noise(60, 4)
    codes[0], codes[1, 0], codes[2, 5:7] = 0, 0, codes[2, 3:5]  # of no length, no chord, and a step of no length
    given = [each.float() for each in (codes, knots)]
    in_double = [each.double() for each in given]
    fast, plain = style.cost(*given).double(), style.plain_cost(*in_double)
    assert ((fast - plain).abs() <= ROUNDING * plain.abs()).all()
    signal = noise(60)
    found, expected = slopes(style.cost, signal, *given), slopes(style.plain_cost, signal, *in_double)
    for one, other in zip(found, expected, strict=True):
        assert times == 0 or all(column.any() for column in other.unbind(1))
        apart = (one - other).norm(dim=1)
        assert (apart <= FLOAT32_GRADIENT * other.norm(dim=1).clamp(min=1e-3)).all()


def test_a_free_stroke_without_slopes_asked_for_costs_the_same() -> None:
    style, codes, knots = FreeStyle(shortest=0.004, longest=0.1), noise(9, 13).float(), noise(9, 4).float()
    asked = codes.clone().requires_grad_()
    assert torch.equal(style.cost(codes.T.contiguous().T, knots), style.cost(asked, knots).detach())
    assert style.cost(codes[:0], knots[:0]).shape == (0,)
