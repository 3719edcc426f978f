"""The fast kernels against the reference, and the reference against finite differences and numbers done by hand."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from maulstick.rendering.kernels import cpu, reference
from tests.rendering.kernels.conftest import (
    FAST,
    REFERENCE,
    Renderer,
    Scene,
    assert_same,
    composite_with_gradients,
    darkness_with_gradients,
    each_fast_renderer,
    each_renderer,
    mean_over_pixel,
    one_stroke,
    random_scene,
    weights_like,
)
from tests.support import tolerances

FLOAT32 = {"value": tolerances.FLOAT32_VALUE_CREASED, "gradient": tolerances.FLOAT32_GRADIENT_CREASED}

scenes = st.builds(
    random_scene,
    seed=st.integers(0, 2**32),
    strokes=st.integers(0, 6),
    points=st.integers(1, 7),
    channels=st.integers(1, 5),
    height=st.integers(1, 40),
    width=st.integers(1, 140),
    shared=st.booleans(),
    thinnest=st.sampled_from([-3.0, 0.0, 0.5]),
)


@each_fast_renderer
@pytest.mark.parametrize("channels", [1, 3, 5])
@pytest.mark.parametrize("shared", [False, True])
def test_the_fast_composite_has_the_reference_values_and_every_gradient(
    fast: Renderer, channels: int, shared: bool
) -> None:
    scene = random_scene(channels, channels=channels, strokes=8, shared=shared)
    truth = composite_with_gradients(REFERENCE, scene.to(torch.float64))
    assert all(gradient.abs().max() > 0 for gradient in truth.values())
    assert_same(composite_with_gradients(fast, scene), truth, **FLOAT32)


@each_fast_renderer
@pytest.mark.parametrize("shared", [False, True])
def test_the_fast_darkness_has_the_reference_values_and_every_gradient(fast: Renderer, shared: bool) -> None:
    scene = random_scene(5, strokes=8, shared=shared)
    truth = darkness_with_gradients(REFERENCE, scene.to(torch.float64))
    assert all(gradient.abs().max() > 0 for gradient in truth.values())
    assert_same(darkness_with_gradients(fast, scene), truth, **FLOAT32)


@given(scene=scenes)
@settings(derandomize=True, deadline=None, max_examples=40)
def test_any_scene_composites_as_the_reference_does(scene: Scene) -> None:
    truth = composite_with_gradients(REFERENCE, scene.to(torch.float64))
    for fast in FAST.values():
        assert_same(composite_with_gradients(fast, scene), truth, **FLOAT32)


@given(scene=scenes)
@settings(derandomize=True, deadline=None, max_examples=40)
def test_any_stroke_alone_is_as_dark_as_the_reference_says(scene: Scene) -> None:
    truth = darkness_with_gradients(REFERENCE, scene.to(torch.float64))
    for fast in FAST.values():
        assert_same(darkness_with_gradients(fast, scene), truth, **FLOAT32)


@each_fast_renderer
@pytest.mark.parametrize("traces", [cpu.TRACES, 0])
def test_strokes_over_a_tile_that_are_too_many_to_go_back_at_once_have_the_reference_gradients(
    fast: Renderer, traces: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cpu, "TRACES", traces)
    scene = random_scene(2, strokes=300, points=3, height=16, width=60)
    scene = scene._replace(thickness=3 * scene.thickness, opacity=scene.opacity / 20)  # wide, and all of them seen
    truth = composite_with_gradients(REFERENCE, scene.to(torch.float64))
    assert_same(composite_with_gradients(fast, scene), truth, **FLOAT32)


@each_fast_renderer
def test_a_falloff_below_one_has_the_reference_values_and_gradients(fast: Renderer) -> None:
    scene = random_scene(11)._replace(falloff=torch.tensor([0.7]))
    truth = composite_with_gradients(REFERENCE, scene.to(torch.float64))
    assert_same(composite_with_gradients(fast, scene), truth, **FLOAT32)


@each_fast_renderer
def test_neutral_plateau_and_opacity_have_the_reference_values_and_gradients(fast: Renderer) -> None:
    scene = random_scene(13)._replace(
        plateau=torch.zeros(1), opacity=torch.ones(1)
    )  # no pixel centre is near an apex of a cone
    truth = composite_with_gradients(REFERENCE, scene.to(torch.float64))
    assert_same(composite_with_gradients(fast, scene), truth, **FLOAT32)


@each_renderer
def test_only_trainable_strokes_get_gradients_and_the_canvas_keeps_its_own(renderer: Renderer) -> None:
    scene = random_scene(3, strokes=8)
    trainable = torch.tensor([True, False, True, True, False, False, True, False])
    everything = composite_with_gradients(renderer, scene)
    some = composite_with_gradients(renderer, scene, trainable)
    for name in ("value", "canvas"):
        assert torch.equal(some[name], everything[name])
    for name in ("points", "thickness", "colours", "falloff", "plateau", "opacity"):
        assert not some[name][~trainable].any(), name
        assert torch.equal(some[name][trainable], everything[name][trainable]), name
        assert everything[name][~trainable].any(), name


@each_fast_renderer
def test_no_trainable_stroke_still_leaves_the_gradient_of_the_canvas(fast: Renderer) -> None:
    scene = random_scene(4)
    nobody = torch.zeros(5, dtype=torch.bool)
    truth = composite_with_gradients(REFERENCE, scene.to(torch.float64), nobody)
    assert_same(composite_with_gradients(fast, scene, nobody), truth, **FLOAT32)


@pytest.mark.parametrize("seed", range(4))
def test_the_gradients_of_the_reference_are_its_finite_differences_in_all_but_places(seed: int) -> None:
    scene = random_scene(seed, strokes=2, points=2, channels=2, height=6, width=7).to(torch.float64)
    canvas, points, *leaves = scene
    assert reference.composite(*scene).sub(canvas).abs().sum() > 0

    def composite(canvas: torch.Tensor, *rest: torch.Tensor) -> torch.Tensor:
        return reference.composite(canvas, points, *rest)

    inputs = [x.requires_grad_() for x in (canvas, *leaves)]
    assert torch.autograd.gradcheck(composite, inputs, atol=tolerances.FINITE_DIFFERENCE)


@each_renderer
def test_the_projection_is_signed_and_clamped(renderer: Renderer) -> None:
    scene = one_stroke([[2.5, 2.5], [6.5, 2.5]], [2.0, 2.0])
    image = renderer.darkness(*scene[1:3], *scene[4:], height=6, width=10)[0]
    # (1.5, 2.5): T = -1/4, clamped to 0, so 1 pixel from the mark's end. The infinite line would say 0 pixels, the
    # unsigned projection 1/4 would say 2 pixels.
    beyond = mean_over_pixel(lambda x, y: 1 - np.hypot(x - 2.5, y - 2.5) / 2, 1, 2)
    assert float(image[2, 1]) == pytest.approx(beyond, abs=tolerances.BESIDE_A_POINT)
    assert float(image[2, 7]) == pytest.approx(beyond, abs=tolerances.BESIDE_A_POINT)  # T = 5/4, clamped to 1
    assert float(image[2, 4]) == pytest.approx(1 - 0.25 / 2)  # on the line, from which a pixel is 1/4 away on average
    assert float(image[3, 4]) == pytest.approx(0.5)
    assert float(image[4, 4]) == pytest.approx(0.5 * 0.25 / 2)  # half of it lies within a half-width
    assert image[5, 4] == image[2, 9] == 0


@each_renderer
def test_falloff_plateau_opacity_and_thickness_combine_as_computed_by_hand(renderer: Renderer) -> None:
    scene = one_stroke([[2.5, 2.5], [6.5, 2.5]], [1.0, 3.0])
    falloff, plateau, opacity = torch.tensor([2.0]), torch.tensor([0.25]), torch.tensor([0.8])
    image = renderer.darkness(*scene[1:3], falloff, plateau, opacity, height=6, width=12)[0]

    def darkness(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        T = ((x - 2.5) / 4).clip(0, 1)
        ratio = np.hypot(x - 2.5 - 4 * T, y - 2.5) / (1 + 2 * T)
        return np.asarray(0.8 * ((1 - ratio) / 0.75).clip(0, 1) ** 2)

    for x, y in ((4, 3), (8, 2), (6, 2), (7, 2), (1, 2), (5, 1)):
        expected = mean_over_pixel(darkness, x, y)
        assert float(image[y, x]) == pytest.approx(expected, abs=tolerances.BESIDE_A_POINT), (x, y)


@each_renderer
def test_strokes_cover_one_another_in_order(renderer: Renderer) -> None:
    dot = one_stroke([[1.5, 1.5]], [2.0], height=3, width=3, plateau=0.5)
    scene = dot._replace(
        points=dot.points.expand(2, 1, 2),
        thickness=dot.thickness.expand(2, 1),
        colours=torch.tensor([[0.2], [0.6]]),
        opacity=torch.tensor([1.0, 0.5]),
    )
    assert float(renderer.composite(*scene)[0, 1, 1]) == pytest.approx(0.2 * 0.5 + 0.6 * 0.5)


@each_renderer
def test_a_composite_is_its_darkness_laid_over_the_canvas(renderer: Renderer) -> None:
    scene = random_scene(6, strokes=1)
    d = renderer.darkness(*scene[1:3], *scene[4:], height=37, width=70)
    expected = scene.canvas * (1 - d) + scene.colours[0, :, None, None] * d
    torch.testing.assert_close(renderer.composite(*scene), expected, atol=tolerances.FLOAT32_VALUE, rtol=0)


def test_other_number_types_get_the_float32_result_and_gradients_of_their_own_type() -> None:
    scene = random_scene(7)
    fastest = next(iter(FAST.values()))
    single = composite_with_gradients(fastest, scene)
    double = composite_with_gradients(fastest, scene.to(torch.float64))
    assert double["value"].dtype == torch.float32
    assert torch.equal(single["value"], double["value"])
    for name in scene._fields:
        assert double[name].dtype == torch.float64
        assert torch.equal(single[name], double[name].float()), name


@each_fast_renderer
def test_a_canvas_that_needs_no_gradient_changes_no_other_gradient(fast: Renderer) -> None:
    scene = random_scene(14)
    everything = composite_with_gradients(fast, scene)
    leaves = [x.clone().requires_grad_() for x in scene[1:]]
    out = fast.composite(scene.canvas, *leaves)
    for name, gradient in zip(Scene._fields[1:], torch.autograd.grad(out, leaves, weights_like(out)), strict=True):
        assert torch.equal(gradient, everything[name]), name


@each_fast_renderer
def test_memory_layout_does_not_matter(fast: Renderer) -> None:
    scene = random_scene(8)
    strided = Scene(*(torch.stack([x, -x], dim=-1)[..., 0] for x in scene))
    assert not any(x.is_contiguous() for x in strided)
    weights = torch.randn(1, 1, 70, generator=torch.Generator().manual_seed(0)).expand(3, 37, 70)
    plain = composite_with_gradients(fast, scene, weights=weights.contiguous())
    assert_same(composite_with_gradients(fast, strided, weights=weights), plain, value=0, gradient=0)


@each_fast_renderer
def test_arguments_are_left_as_they_were(fast: Renderer) -> None:
    scene = random_scene(9)
    before = Scene(*(x.clone() for x in scene))
    composite_with_gradients(fast, scene)
    for name, x, y in zip(scene._fields, scene, before, strict=True):
        assert torch.equal(x, y), name


def test_a_second_derivative_is_refused() -> None:
    scene = random_scene(10)
    points = scene.points.clone().requires_grad_()
    out = cpu.composite(scene.canvas, points, *scene[2:])
    (gradient,) = torch.autograd.grad(out.square().sum(), points, create_graph=True)
    with pytest.raises(RuntimeError, match="once_differentiable"):
        gradient.sum().backward()
