from dataclasses import replace

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from maulstick.planning.objectives import Halftone, Objective, Tone, halved, towards_contours
from maulstick.planning.tones import Tones

ROUNDING = 1e-5  # relative, of float32

progresses = pytest.mark.parametrize("progress", [0.0, 0.3, 0.5, 1.0])
kinds = pytest.mark.parametrize("spacing", [None, 1.0, 6.0], ids=["tone", "halftone", "sparse halftone"])


def noise(seed: int, *shape: int) -> Tensor:
    return torch.rand(*shape, generator=torch.Generator().manual_seed(seed))


def tone(target: Tensor, weights: Tensor | None = None, *, spacing: float | None = None) -> Objective:
    weights = torch.ones_like(target[0]) if weights is None else weights
    return Tone(target, weights) if spacing is None else Halftone(target, weights, spacing, towards_contours(target))


@kinds
@progresses
def test_tone_is_0_for_the_target_alone(spacing: float | None, progress: float) -> None:
    target = noise(0, 3, 40, 52)
    objective = tone(target, spacing=spacing)
    assert objective.loss(target.clone(), progress).item() == 0
    assert objective.loss(0.9 * target, progress).item() > 0.0005


@progresses
def test_the_gradient_points_to_the_target(progress: float) -> None:
    target, canvas = noise(0, 3, 40, 52), noise(1, 3, 40, 52).requires_grad_()
    loss = tone(target).loss(canvas, progress)
    (gradient,) = torch.autograd.grad(loss, canvas)
    towards = target - canvas.detach()
    # The loss is quadratic in the difference, so that its slope towards the target is -2 times the loss (Euler).
    assert (gradient * towards).sum().item() == pytest.approx(-2 * loss.item(), rel=1e-4)


@kinds
@progresses
def test_an_even_difference_is_the_same_loss_for_every_kind(spacing: float | None, progress: float) -> None:
    target = noise(0, 3, 64, 64)
    assert tone(target, spacing=spacing).loss(target + 0.2, progress).item() == pytest.approx(0.04, rel=ROUNDING)


@kinds
@pytest.mark.parametrize("shape", [(1, 1, 1), (3, 3, 5), (3, 33, 37)])
def test_gradients_are_those_of_finite_differences(spacing: float | None, shape: tuple[int, int, int]) -> None:
    target, canvas = noise(0, *shape).double(), noise(1, *shape).double().requires_grad_()
    weights = 0.5 + noise(2, *shape[1:]).double()
    objective = tone(target, weights, spacing=spacing)
    (gradient,) = torch.autograd.grad(objective.loss(canvas, 0.2), canvas)
    step = 1e-4
    for at in torch.randint(0, canvas.numel(), (5,), generator=torch.Generator().manual_seed(3)).tolist():
        moved = [canvas.detach().clone() for _ in range(2)]
        moved[0].view(-1)[at] += step
        moved[1].view(-1)[at] -= step
        slope = (objective.loss(moved[0], 0.2) - objective.loss(moved[1], 0.2)) / (2 * step)
        assert gradient.view(-1)[at].item() == pytest.approx(slope.item(), rel=1e-6, abs=1e-12)


@kinds
@progresses
@pytest.mark.parametrize("shape", [(1, 1, 1), (3, 1, 1), (3, 3, 5), (3, 1, 200), (3, 200, 1)])
def test_tiny_and_thin_canvases_have_a_loss(
    spacing: float | None, progress: float, shape: tuple[int, int, int]
) -> None:
    target = noise(0, *shape)
    loss = tone(target, spacing=spacing).loss(1 - target, progress)
    assert loss.shape == ()
    assert loss.item() == pytest.approx((1 - 2 * target).square().mean().item(), rel=ROUNDING if spacing is None else 1)


def test_coarse_levels_fade_by_the_middle_of_planning() -> None:
    target = torch.full((1, 64, 64), 0.5)
    stripes = (torch.arange(64) // 2 % 2).float().expand(1, 64, 64)
    losses = [tone(target).loss(stripes, progress).item() for progress in (0, 0.2, 0.4, 0.5, 1)]
    assert losses == sorted(losses)
    assert losses[0] < 0.3 * losses[-1], "from far off, stripes are grey"
    assert losses[-2] == losses[-1] == 0.25, "plain mean squared error"


@pytest.mark.parametrize("every", [2, 4, 8])
def test_one_ink_makes_grey_of_lines_however_far_they_are_apart(every: int) -> None:
    grey, blank = torch.full((3, 128, 128), 1 - 1 / every), torch.ones(3, 128, 128)
    lines = (torch.arange(128) % every != 0).float().expand(3, 128, 128)
    halftone = tone(grey, spacing=float(every))
    seen, black, white = (halftone.loss(x, 0.5).item() for x in (lines, torch.zeros_like(blank), blank))
    assert seen < 0.3 * min(black, white)
    assert tone(grey).loss(lines, 1.0).item() >= tone(grey).loss(blank, 1.0).item(), "it would pay to draw nothing"


@pytest.mark.parametrize("blank", [False, True])
def test_contours_earn_most_for_a_line_along_their_dark_side_where_tones_leave_them_blank_too(blank: bool) -> None:
    picture = torch.ones(3, 64, 64)
    picture[:, :, 32:] = 0.8
    target = torch.ones_like(picture) if blank else picture

    def losses(*, contours: bool) -> Tensor:
        halftone = Halftone(target, torch.ones_like(target[0]), 5.0, towards_contours(picture) if contours else None)
        lines = 1 - torch.eye(64)[:, None, None, :].expand(64, 3, 64, 64)
        return torch.stack([halftone.loss(canvas, 0.5) for canvas in lines])

    earned = losses(contours=False) - losses(contours=True)
    assert earned.argmax() == 32
    assert earned.argmin() == 31
    assert torch.allclose(earned[[20, 45, 60]], earned[5], atol=0.02 * earned.max().item()), "nothing elsewhere"


@pytest.mark.parametrize(("paper", "ink"), [(1.0, 0.0), (0.2, 1.0)], ids=["black on white", "white on grey"])
def test_ink_costs_in_lights_that_are_left_blank_most_where_the_picture_is_lightest(paper: float, ink: float) -> None:
    sheet = torch.full((3, 64, 64), paper)
    picture, target = sheet.clone(), sheet.clone()
    picture[:, 20:40], picture[:, 40:] = 0.8 * paper + 0.2 * ink, 0.2 * paper + 0.8 * ink
    target[:, 40:] = picture[:, 40:]
    veiled = Tones(veil=0.3, contrast=1.0, lightest=100.0, darkest=20.0, inks=((ink, ink, ink),))
    pull = veiled.away_from_lights(target, picture, sheet)
    assert replace(veiled, veil=0.0).away_from_lights(picture, picture, sheet) is None
    with_lights, without = (Halftone(target, torch.ones(64, 64), 5.0, each) for each in (pull, None))

    def cost_of_a_line(y: int) -> float:
        canvas = target.clone()
        canvas[:, y, 8:24] = ink
        return (with_lights.loss(canvas, 0.5) - without.loss(canvas, 0.5)).item()

    bare, light, dark = map(cost_of_a_line, (10, 30, 50))
    assert light == pytest.approx(0.8 * bare, rel=1e-3)
    assert bare > 0
    assert dark == 0


@pytest.mark.parametrize(("paper", "ink"), [(1.0, 0.0), (0.2, 1.0)], ids=["black on white", "white on grey"])
def test_ink_earns_on_lines_the_more_the_darker_they_are_and_the_shorter_ink_is(paper: float, ink: float) -> None:
    sheet, full = torch.full((3, 64, 64), paper), torch.full((3, 1, 1), ink)
    dark = torch.zeros(64, 64)
    dark[10], dark[30] = 1.0, 0.5
    short = Tones(veil=0.3, contrast=1.0, lightest=100.0, darkest=20.0, inks=((ink, ink, ink),), lines=0.6)
    target = short.with_lines(sheet, dark, full)
    assert torch.allclose(target[:, 10], 0.6 * full[:, 0] + 0.4 * sheet[:, 10])
    assert torch.equal(target[:, 20], sheet[:, 20])

    def earned_by_a_line(y: int, tones: Tones) -> float:
        canvas, weights = sheet.clone(), torch.ones(64, 64)
        canvas[:, y, 8:24] = ink
        pull = tones.towards_lines(dark, full, sheet)
        costs = [Halftone(target, weights, 5.0, pull if lines else None) for lines in (True, False)]
        of_sheet, of_canvas = (costs[1].loss(each, 0.5) - costs[0].loss(each, 0.5) for each in (sheet, canvas))
        return (of_canvas - of_sheet).item()

    on_dark, on_faint, beside = (earned_by_a_line(y, short) for y in (10, 30, 20))
    assert on_dark > 0
    assert on_faint == pytest.approx(on_dark / 2, rel=1e-3)
    assert beside == pytest.approx(0, abs=1e-9)
    assert earned_by_a_line(10, replace(short, lines=0.3)) == pytest.approx(on_dark / 2, rel=1e-3)


def test_halftone_does_not_change_as_planning_goes_on() -> None:
    objective = tone(noise(0, 3, 64, 64), spacing=1.0)
    canvas = noise(1, 3, 64, 64)
    assert objective.loss(canvas, 0.0).item() == objective.loss(canvas, 1.0).item()


def test_a_pixel_counts_by_its_weight() -> None:
    target = torch.zeros(3, 5, 5)
    canvas = torch.zeros(3, 5, 5)
    canvas[:, 2, 3] = 0.5
    weights = torch.ones(5, 5)
    once = tone(target, weights).loss(canvas, 1.0).item()
    weights[2, 3] = 4.0
    assert tone(target, weights).loss(canvas, 1.0).item() == pytest.approx(4 * once, rel=ROUNDING)
    weights[:] = 0.0
    assert tone(target, weights).loss(canvas, 1.0).item() == 0


def test_losing_changes_neither_canvas_nor_target() -> None:
    target, canvas = noise(0, 3, 40, 40), noise(1, 3, 40, 40)
    before = target.clone(), canvas.clone()
    tone(target, spacing=1.0).loss(canvas, 0.1)
    assert torch.equal(target, before[0])
    assert torch.equal(canvas, before[1])


@settings(max_examples=40)
@given(st.integers(1, 4), st.integers(1, 20), st.integers(1, 20), st.integers(0, 99))
def test_a_halved_image_is_half_as_large_and_within_its_range(
    channels: int, height: int, width: int, seed: int
) -> None:
    image = noise(seed, channels, height, width)
    half = halved(image)
    assert half.shape == (channels, (height + 1) // 2, (width + 1) // 2)
    assert half.min() >= image.min() - 1e-6
    assert half.max() <= image.max() + 1e-6
    assert torch.allclose(halved(torch.full_like(image, 0.3)), torch.tensor(0.3))
    turned = halved(image.transpose(1, 2)).transpose(1, 2)
    assert torch.allclose(turned, half, atol=1e-6), "rows are treated as columns are"


def test_a_line_costs_alike_in_every_direction() -> None:
    y, x = torch.meshgrid(torch.arange(96.0), torch.arange(96.0), indexing="ij")
    losses = []
    for angle in torch.linspace(0, torch.pi, 9).tolist():
        across = x * torch.cos(torch.tensor(angle)) + y * torch.sin(torch.tensor(angle))
        waves = 0.5 + 0.5 * torch.sin(across * 2 * torch.pi / 5)  # lines five pixels apart
        losses.append(tone(torch.full((1, 96, 96), 0.5), spacing=1.0).loss(waves[None], 0.0).item())
    assert max(losses) < 1.15 * min(losses)
