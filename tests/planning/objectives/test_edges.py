import pytest
import torch
from skimage.data import astronaut
from torch import Tensor
from torch.nn.functional import avg_pool2d, interpolate

from maulstick.planning.objectives import Edges
from tests.support.planning.tiny_network import check_gradient, noise
from tests.support.tolerances import FLOAT32_VALUE

SHAPES = [(1, 1), (3, 5), (1, 200), (33, 37), (64, 48)]


@pytest.fixture(scope="module")
def portrait() -> Tensor:
    """A face, (3, 128, 128)."""
    return avg_pool2d(torch.from_numpy(astronaut()[:256, 80:336]).permute(2, 0, 1) / 255, 2)


def edges(target: Tensor, weights: Tensor | None = None) -> Edges:
    return Edges(target, torch.ones_like(target[0]) if weights is None else weights)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_picture_itself_costs_nothing(shape: tuple[int, int]) -> None:
    target = noise(0, 3, *shape)
    assert edges(target).loss(target.clone(), 0.5).item() == pytest.approx(0, abs=1e-12)


def test_blank_paper_costs_about_1_and_the_negative_about_2(portrait: Tensor) -> None:
    objective = edges(portrait)
    assert objective.name == "edges"
    assert objective.loss(torch.ones_like(portrait), 0.0).item() == pytest.approx(1, abs=0.15)
    assert objective.loss(1 - portrait, 0.0).item() == pytest.approx(2, abs=0.15)
    assert objective.loss(portrait.flip(2), 0.0).item() == pytest.approx(1, abs=0.15)


def test_contrast_and_brightness_matter_little(portrait: Tensor) -> None:
    objective = edges(portrait)
    pale = 0.7 + 0.3 * portrait
    assert objective.loss(pale, 0.0).item() < 0.1
    assert objective.loss(portrait - 0.2, 0.0).item() == pytest.approx(0, abs=FLOAT32_VALUE)


def test_it_costs_more_the_further_edges_are_moved(portrait: Tensor) -> None:
    objective = edges(portrait)
    losses = [objective.loss(portrait.roll(by, 2), 0.0).item() for by in (0, 1, 2, 4, 8, 16)]
    assert losses == sorted(losses)
    assert losses[1] < 0.3
    assert losses[-1] > 0.7


def test_an_edge_across_the_wanted_one_does_not_count() -> None:
    upright = (torch.arange(64) >= 32).float().expand(3, 64, 64)
    objective = edges(upright)
    assert objective.loss(upright.transpose(1, 2), 0.0).item() > 0.8
    assert objective.loss(0.5 + 0.2 * upright, 0.0).item() < 0.1


def test_lines_on_a_flat_ground_cost_and_faint_noise_does_not() -> None:
    flat = torch.full((3, 64, 64), 0.8)
    lined = flat.clone()
    lined[:, ::8] = 0
    objective = edges(flat)
    assert objective.loss(lined, 0.0).item() > 0.5
    assert objective.loss(flat + 0.002 * noise(0, 3, 64, 64).float(), 0.0).item() < 0.01


def test_strong_edges_of_the_picture_matter_more_than_flat_places(portrait: Tensor) -> None:
    target = torch.ones(3, 64, 64)
    target[:, :32, 20:] = 0.2
    without_edge, with_lines = target.clone(), target.clone()
    without_edge[:, :32] = 1
    with_lines[:, 40:, ::8] = 0.5
    objective = edges(target)
    assert objective.loss(without_edge, 0.0).item() > 2 * objective.loss(with_lines, 0.0).item()


def test_a_place_that_does_not_matter_costs_nothing(portrait: Tensor) -> None:
    weights = torch.ones(128, 128)
    weights[:, 40:] = 0
    spoilt = portrait.clone()
    spoilt[:, :, 112:] = 1
    assert edges(portrait).loss(spoilt, 0.0).item() > 0.02
    assert edges(portrait, weights).loss(spoilt, 0.0).item() == pytest.approx(0, abs=FLOAT32_VALUE)
    assert edges(portrait, 0 * weights).loss(spoilt, 0.0).item() == 0


def test_a_large_canvas_is_judged_as_a_small_one(portrait: Tensor) -> None:
    small = portrait.repeat(1, 4, 3)
    large = interpolate(small[None], scale_factor=4, mode="bilinear")[0]
    for spoil in (torch.ones_like, lambda x: x.roll(x.shape[1] // 128, 1)):
        losses = [edges(x).loss(spoil(x), 0.0).item() for x in (small, large)]
        assert losses[0] > 0.2
        assert losses[0] == pytest.approx(losses[1], rel=0.15)


def test_it_is_the_same_at_any_progress_and_changes_nothing(portrait: Tensor) -> None:
    canvas, objective = portrait.flip(1), edges(portrait)
    before = canvas.clone(), portrait.clone()
    assert objective.loss(canvas, 0.0).item() == objective.loss(canvas, 1.0).item()
    assert torch.equal(canvas, before[0])
    assert torch.equal(portrait, before[1])


@pytest.mark.parametrize("shape", SHAPES)
def test_gradients_are_those_of_finite_differences(shape: tuple[int, int]) -> None:
    target, weights = noise(0, 3, *shape), 0.5 + noise(1, *shape)
    objective = edges(target, weights)
    check_gradient(lambda canvas: objective.loss(canvas, 0.0), noise(2, 3, *shape))


def test_a_blank_canvas_is_told_where_edges_belong(portrait: Tensor) -> None:
    canvas = torch.ones_like(portrait, requires_grad=True)
    objective = edges(portrait)
    (gradient,) = torch.autograd.grad(objective.loss(canvas, 0.0), canvas)
    assert torch.isfinite(gradient).all()
    better = canvas.detach() - 0.002 * gradient.sign()
    assert objective.loss(better, 0.0).item() < objective.loss(canvas, 0.0).item() - 0.05
