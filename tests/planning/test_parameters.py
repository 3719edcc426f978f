import math

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from maulstick.planning.parameters import StrokeParameters
from maulstick.strokes import strokes
from maulstick.style.free import FreeStyle
from maulstick.style.pressure import pressure_along
from tests.support.tolerances import FLOAT32_METRES

STYLE = FreeStyle(shortest=0.002, longest=0.05)
WIDTH, HEIGHT = 0.2, 0.1


def some_strokes(count: int, seed: int = 0, spread: float = 1.0) -> StrokeParameters:
    generator = torch.Generator().manual_seed(seed)
    codes, knots = STYLE.sample(count, generator)
    centres = (0.5 + spread * (torch.rand(count, 2, generator=generator) - 0.5)) * torch.tensor([WIDTH, HEIGHT])
    angles = 4 * torch.randn(count, generator=generator)
    colours = torch.rand(count, 3, generator=generator)
    return StrokeParameters(codes, centres, angles, knots, colours, torch.zeros(count, dtype=torch.long))


def trained(parameters: StrokeParameters) -> StrokeParameters:
    return StrokeParameters(**{k: x.requires_grad_(x.is_floating_point()) for k, x in parameters.each().items()})


def paths_of(parameters: StrokeParameters) -> Tensor:
    return parameters.trajectories(STYLE)[..., :2]


def test_the_middle_of_a_path_lies_at_its_centre_at_every_angle() -> None:
    parameters = some_strokes(20)
    middles = paths_of(parameters).mean(dim=1)
    assert middles.numpy() == pytest.approx(parameters.centres.numpy(), abs=FLOAT32_METRES)
    assert len(parameters) == 20


def test_a_trajectory_is_the_decoded_path_in_its_pose_and_its_pressure() -> None:
    parameters = some_strokes(9)
    paths = STYLE.decode(parameters.codes)
    poses = parameters.poses(paths)
    trajectories = parameters.trajectories(STYLE)
    assert trajectories.shape == (9, 32, 3)
    assert torch.equal(poses[:, 2], parameters.angles)
    placed = strokes.place(paths.double().numpy(), poses.double().numpy())
    assert trajectories[..., :2].numpy() == pytest.approx(placed, abs=2 * FLOAT32_METRES)
    assert torch.equal(trajectories[..., 2], pressure_along(parameters.pressure_knots))
    assert torch.allclose(trajectories[:, 0, :2], poses[:, :2], atol=FLOAT32_METRES), "a standardised path starts at 0"


def test_an_angle_turns_a_stroke_about_its_middle() -> None:
    parameters = some_strokes(5)
    turned = StrokeParameters(**(parameters.each() | {"angles": parameters.angles + math.pi / 2}))
    about = (paths_of(parameters) - parameters.centres[:, None]).numpy()
    assert (paths_of(turned) - parameters.centres[:, None]).numpy() == pytest.approx(
        np.stack([-about[..., 1], about[..., 0]], axis=-1), abs=2 * FLOAT32_METRES
    )


def test_every_parameter_has_a_gradient() -> None:
    parameters = trained(some_strokes(4))
    moved = [parameters.codes, parameters.centres, parameters.angles, parameters.pressure_knots]
    weights = torch.rand(4, 32, 3, generator=torch.Generator().manual_seed(1))
    for gradient in torch.autograd.grad((parameters.trajectories(STYLE) * weights).sum(), moved):
        assert gradient.isfinite().all()
        assert (gradient.abs().reshape(4, -1).amax(dim=1) > 0).all()


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.floats(0, 3))
def test_strokes_are_kept_inside_by_the_smallest_move(seed: int, spread: float) -> None:
    parameters = some_strokes(8, seed, spread)
    before = StrokeParameters(**{name: x.clone() for name, x in parameters.each().items()})
    parameters.keep_inside(STYLE, WIDTH, HEIGHT)
    paths, were = paths_of(parameters), paths_of(before)
    size = torch.tensor([WIDTH, HEIGHT])
    assert paths.min() >= -FLOAT32_METRES
    assert (paths - size).max() <= FLOAT32_METRES
    beyond = (-were.amin(dim=1)).clamp(min=0) + (were.amax(dim=1) - size).clamp(min=0)
    moved = (parameters.centres - before.centres).abs()
    assert moved.numpy() == pytest.approx(beyond.numpy(), abs=2 * FLOAT32_METRES)
    for name in ("codes", "angles", "pressure_knots", "colours"):
        assert torch.equal(getattr(parameters, name), getattr(before, name))


def test_strokes_that_train_are_kept_inside_without_a_gradient() -> None:
    parameters = trained(some_strokes(6, spread=3))
    parameters.keep_inside(STYLE, WIDTH, HEIGHT)
    assert parameters.centres.is_leaf
    assert parameters.centres.requires_grad


def test_some_strokes_are_a_copy_without_gradients() -> None:
    parameters = trained(some_strokes(6))
    some = parameters[torch.tensor([4, 1])]
    assert len(some) == 2
    for name, tensor in some.each().items():
        assert not tensor.requires_grad
        assert torch.equal(tensor, parameters.each()[name].detach()[[4, 1]])
    some.centres.zero_()
    assert parameters.centres.abs().min() > 0


def test_rows_are_replaced_and_the_others_left() -> None:
    parameters = trained(some_strokes(6))
    before, others = some_strokes(6), some_strokes(2, seed=9)
    parameters.replace_rows(torch.tensor([5, 0]), others)
    for name, tensor in parameters.each().items():
        assert torch.equal(tensor.detach()[[5, 0]], others.each()[name])
        assert torch.equal(tensor.detach()[1:5], before.each()[name][1:5])
