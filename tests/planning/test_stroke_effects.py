import math
from dataclasses import fields, replace

import pytest
import torch
from torch import Generator, Tensor

from maulstick.planning.stroke_effects import TargetView, coverage, recolouring_costs, removal_costs
from maulstick.rendering.kernels.cpu import composite
from maulstick.rendering.kernels.render import darkness
from maulstick.rendering.traj2stroke import Marks

PROBES = 8  # of one estimate
ESTIMATES = 60
SIGMAS = 5
ROUNDING = 1e-5  # relative, of float32


def error(view: TargetView, canvas: Tensor) -> float:
    return view.difference(canvas).square().sum().item()


def seeded(seed: int) -> Generator:
    return Generator().manual_seed(seed)


def rendered(paper: Tensor, marks: Marks, colours: Tensor) -> Tensor:
    return composite(paper, marks.points, marks.thickness, colours, marks.falloff, marks.plateau, marks.opacity)


def without(marks: Marks, colours: Tensor, i: int) -> tuple[Marks, Tensor]:
    rest = [j for j in range(len(colours)) if j != i]
    return Marks(**{field.name: getattr(marks, field.name)[rest] for field in fields(Marks)}), colours[rest]


def honest_costs(view: TargetView, paper: Tensor, marks: Marks, colours: Tensor) -> tuple[Tensor, Tensor]:
    """Return how much the error grows without each stroke, (N,), and how much the canvas changes, squared."""
    whole = rendered(paper, marks, colours)
    rests = [rendered(paper, *without(marks, colours, i)) for i in range(len(colours))]
    costs = [error(view, rest) - error(view, whole) for rest in rests]
    changes = [(view.difference(rest) - view.difference(whole)).square().sum().item() for rest in rests]
    return torch.tensor(costs), torch.tensor(changes)


def overlapping(seed: int, *, strokes: int = 20, channels: int = 3) -> tuple[Tensor, Marks, Tensor, Tensor]:
    """Paper, overlapping marks of many kinds, their colours, and a target that some of them help to reach."""
    generator = seeded(seed)
    points = 44 * torch.rand(strokes, 1, 2, generator=generator) + 5 * torch.randn(
        strokes, 6, 2, generator=generator
    ).cumsum(1)
    marks = Marks(
        points,
        1 + 3 * torch.rand(strokes, 6, generator=generator),
        1 + torch.rand(strokes, generator=generator),
        0.5 * torch.rand(strokes, generator=generator),
        0.4 + 0.6 * torch.rand(strokes, generator=generator),
    )
    colours = torch.rand(strokes, channels, generator=generator)
    paper = torch.ones(channels, 41, 44)
    shades = (colours + 0.5 * torch.randn(strokes, channels, generator=generator)).clamp(0, 1)
    return paper, marks, colours, rendered(paper, marks, shades)


def dots(at: list[tuple[int, int]], opacity: list[float]) -> Marks:
    """Marks of one pixel each."""
    count = len(at)
    points = torch.tensor(at, dtype=torch.float32)[:, None] + 0.5
    return Marks(
        points, torch.full((count, 1), 0.5), torch.ones(count), torch.full((count,), 0.9), torch.tensor(opacity)
    )


def view_of(target: Tensor, *, pool: int = 1, seed: int | None = None) -> TargetView:
    weights = torch.ones_like(target[0])
    if seed is not None:
        weights = 0.2 + 2 * torch.rand(weights.shape, generator=seeded(seed))
    return TargetView(target, weights, pool)


def test_the_cost_of_taking_a_dot_away_is_exact() -> None:
    paper, target = torch.ones(1, 6, 7), torch.rand(1, 6, 7, generator=seeded(0))
    marks = dots([(1, 1), (4, 2), (4, 2), (6, 5), (0, 5)], [1.0, 0.7, 0.4, 0.9, 0.05])
    colours = torch.tensor([[0.0], [0.3], [0.9], [1.0], [0.5]])
    view = view_of(target, seed=1)
    honest, changes = honest_costs(view, paper, marks, colours)
    assert changes[0] > 0.1
    found = removal_costs(view, paper, marks, colours, seeded(0))
    assert found.tolist() == pytest.approx(honest.tolist(), abs=ROUNDING)


@pytest.mark.parametrize("pool", [1, 5])
@pytest.mark.parametrize("weighed", [None, 7])
def test_the_mean_cost_of_taking_a_stroke_away_is_what_leaving_it_out_costs(pool: int, weighed: int | None) -> None:
    paper, marks, colours, target = overlapping(0)
    view = view_of(target, pool=pool, seed=weighed)
    honest, changes = honest_costs(view, paper, marks, colours)
    found = torch.stack([removal_costs(view, paper, marks, colours, seeded(i)) for i in range(ESTIMATES)]).mean(dim=0)
    # Random signs s estimate |J|² by (s J)², whose variance is at most 2 |J|⁴ (Hutchinson); J is the stroke's change.
    tolerance = SIGMAS * math.sqrt(2 / (ESTIMATES * PROBES)) * changes + 1e-3
    assert ((found - honest).abs() <= tolerance).all()
    assert (honest.abs() > 2 * tolerance).sum() > 5, "there is something to be told apart"
    assert (honest < 0).any()


def test_one_estimate_ranks_strokes_much_as_leaving_each_out_does() -> None:
    for seed in range(3):
        paper, marks, colours, target = overlapping(seed, strokes=30)
        view = view_of(target)
        honest, _ = honest_costs(view, paper, marks, colours)
        found = removal_costs(view, paper, marks, colours, seeded(seed))
        ranks = torch.stack([honest.argsort().argsort(), found.argsort().argsort()]).double()
        assert torch.corrcoef(ranks)[0, 1] > 0.6


def test_what_a_canvas_is_pulled_to_counts_exactly() -> None:
    paper, marks, colours, target = overlapping(0)
    view = view_of(target, pool=5, seed=7)
    pulled = replace(view, pull=torch.randn(target.shape, generator=seeded(8)))
    more = removal_costs(pulled, paper, marks, colours, seeded(0))
    more -= removal_costs(view, paper, marks, colours, seeded(0))
    rests = [rendered(paper, *without(marks, colours, i)) for i in range(len(colours))]
    honest = torch.stack([pulled.pulled(rest) for rest in rests]) - pulled.pulled(rendered(paper, marks, colours))
    assert more.tolist() == pytest.approx(honest.tolist(), abs=100 * ROUNDING)
    assert honest.abs().max() > 0.1


def test_a_stroke_that_shows_nowhere_costs_nothing() -> None:
    marks = Marks(
        torch.tensor([[[10.0, 10], [20, 10]], [[5.0, 10], [25, 10]], [[90.0, 90], [95, 90]]]),
        torch.tensor([[2.0, 2], [8, 8], [3, 3]]),
        torch.ones(3),
        torch.full((3,), 0.7),
        torch.ones(3),
    )
    colours, paper = torch.tensor([[1.0], [0.0], [0.5]]), torch.ones(1, 30, 30)
    view = view_of(rendered(paper, marks, colours))
    costs = removal_costs(view, paper, marks, colours, seeded(0))
    assert costs[0].item() == pytest.approx(0, abs=1e-6), "the second covers it"
    assert costs[1] > 10
    assert costs[2].item() == 0, "it lies off the canvas"


def test_costs_repeat_with_their_generator_and_change_nothing() -> None:
    paper, marks, colours, target = overlapping(2)
    before = marks.opacity.clone(), colours.clone(), paper.clone()
    view = view_of(target)
    once = removal_costs(view, paper, marks, colours, seeded(3))
    assert torch.equal(removal_costs(view, paper, marks, colours, seeded(3)), once)
    assert not torch.equal(removal_costs(view, paper, marks, colours, seeded(4)), once)
    assert torch.equal(marks.opacity, before[0])
    assert torch.equal(colours, before[1])
    assert torch.equal(paper, before[2])
    assert not marks.opacity.requires_grad


def test_strokes_that_train_are_weighed_without_a_gradient() -> None:
    paper, marks, colours, target = overlapping(2)
    training = Marks(**{field.name: getattr(marks, field.name).clone().requires_grad_() for field in fields(Marks)})
    free = colours.clone().requires_grad_()
    view = view_of(target)
    for costs, expected in (
        (
            removal_costs(view, paper, training, free, seeded(3)),
            removal_costs(view, paper, marks, colours, seeded(3)),
        ),
        (coverage(view, paper, training, free), coverage(view, paper, marks, colours)),
    ):
        assert not costs.requires_grad
        assert torch.equal(costs, expected)
    assert free.grad is None


def test_a_lone_stroke_covers_its_darkness() -> None:
    paper, marks, colours, target = overlapping(4, strokes=1)
    darkness = rendered(torch.zeros(1, 41, 44), marks, torch.ones(1, 1))[0]
    assert darkness.sum() > 20
    covered = coverage(view_of(target), paper, marks, colours)
    assert covered.tolist() == pytest.approx([darkness.sum().item()], rel=ROUNDING)
    weighed = view_of(target, seed=9)
    expected = (darkness * weighed.weights).sum().item()
    assert coverage(weighed, paper, marks, colours).tolist() == pytest.approx([expected], rel=ROUNDING)


def test_strokes_and_bare_paper_together_cover_the_canvas() -> None:
    paper, marks, colours, target = overlapping(5)
    bare = rendered(torch.ones(1, 41, 44), marks, torch.zeros(20, 1)).sum().item()
    covered = coverage(view_of(target), paper, marks, colours)
    assert (covered >= 0).all()
    assert covered.sum().item() + bare == pytest.approx(41 * 44, rel=ROUNDING)
    assert bare < 0.8 * 41 * 44


def test_a_stroke_covers_what_later_ones_leave_of_it() -> None:
    marks = dots([(1, 1), (1, 1), (3, 3)], [0.8, 0.25, 0.5])
    covered = coverage(view_of(torch.ones(3, 5, 5)), torch.ones(3, 5, 5), marks, torch.rand(3, 3, generator=seeded(0)))
    alone = dots([(1, 1)], [1.0])
    dark = (
        darkness(alone.points, alone.thickness, alone.falloff, alone.plateau, alone.opacity, height=5, width=5)
        .sum()
        .item()
    )
    expected = [0.8 * dark * (1 - 0.25 * dark), 0.25 * dark, 0.5 * dark]
    assert covered.tolist() == pytest.approx(expected, rel=ROUNDING)


def test_the_error_is_the_weighed_sum_of_squares() -> None:
    target, canvas = torch.rand(3, 9, 11, generator=seeded(0)), torch.rand(3, 9, 11, generator=seeded(1))
    assert error(view_of(target), canvas) == pytest.approx((canvas - target).square().sum().item(), rel=ROUNDING)
    view = view_of(target, seed=2)
    expected = ((canvas - target).square() * view.weights).sum().item()
    assert error(view, canvas) == pytest.approx(expected, rel=ROUNDING)
    assert error(view, target) == 0


@pytest.mark.parametrize(("shape", "pool", "seen"), [((8, 12), 4, (2, 3)), ((9, 11), 4, (3, 3)), ((3, 5), 9, (1, 1))])
def test_a_pooled_view_sees_means_over_squares(shape: tuple[int, int], pool: int, seen: tuple[int, int]) -> None:
    target = torch.rand(3, *shape, generator=seeded(0))
    view = view_of(target, pool=pool)
    assert view.difference(target + 0.25).shape == (3, *seen)
    assert view.difference(target + 0.25).numpy() == pytest.approx(0.25, rel=ROUNDING)
    y, x = torch.meshgrid(torch.arange(shape[0]), torch.arange(shape[1]), indexing="ij")
    checks = ((y + x) % 2).float() - 0.5
    assert error(view, target + checks) < 0.1 * error(view_of(target), target + checks)


@pytest.mark.parametrize("pool", [1, 5])
def test_the_mean_cost_of_another_paint_is_what_painting_with_it_costs(pool: int) -> None:
    paper, marks, colours, target = overlapping(0)
    view, paints = view_of(target, pool=pool, seed=7), torch.tensor([[0.1], [0.6], [0.95]])
    paints = paints.expand(3, colours.shape[1])
    before = view.difference(rendered(paper, marks, colours))
    honest, changes = torch.zeros(len(colours), 3), torch.zeros(len(colours), 3)
    for i in range(len(colours)):
        for k in range(3):
            others = colours.clone()
            others[i] = paints[k]
            after = view.difference(rendered(paper, marks, others))
            honest[i, k] = after.square().sum() - before.square().sum()
            changes[i, k] = (after - before).square().sum()
    found = torch.stack(
        [recolouring_costs(view, paper, marks, colours, paints, seeded(i)) for i in range(ESTIMATES)]
    ).mean(dim=0)
    tolerance = SIGMAS * math.sqrt(2 / (ESTIMATES * PROBES)) * changes + 1e-3
    assert ((found - honest).abs() <= tolerance).all()
    assert (honest < -tolerance).any()
    assert (honest > tolerance).any()


def test_a_stroke_that_keeps_its_paint_costs_nothing() -> None:
    paper, marks, colours, target = overlapping(1)
    costs = recolouring_costs(view_of(target), paper, marks, colours, colours[:2], seeded(0))
    assert costs[0, 0] == 0
    assert costs[1, 1] == 0
