"""Strokes, canvases and numbers at the edge of what can be drawn, and beyond it."""

from functools import cache

import numpy as np
import pytest
import torch
from torch import Tensor

from maulstick.errors import InputError
from maulstick.rendering.kernels import cpu
from tests.rendering.kernels.conftest import (
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

FLOAT32 = {"value": tolerances.FLOAT32_VALUE, "gradient": tolerances.FLOAT32_GRADIENT}
FAR = {"value": tolerances.FLOAT32_VALUE_FAR, "gradient": tolerances.FLOAT32_GRADIENT_FAR}


def assert_leaves_no_mark(renderer: Renderer, scene: Scene) -> None:
    result = composite_with_gradients(renderer, scene)
    assert torch.equal(result.pop("value"), scene.canvas)
    assert torch.equal(result.pop("canvas"), weights_like(scene.canvas))
    for name, gradient in result.items():
        assert torch.equal(gradient, torch.zeros_like(gradient)), name
    assert not any(x.any() for x in darkness_with_gradients(renderer, scene).values())


def assert_as_the_reference(fast: Renderer, scene: Scene, allowed: dict[str, float] = FLOAT32) -> None:
    truth = composite_with_gradients(REFERENCE, scene.to(torch.float64))
    assert_same(composite_with_gradients(fast, scene), truth, **allowed)
    truth = darkness_with_gradients(REFERENCE, scene.to(torch.float64))
    assert_same(darkness_with_gradients(fast, scene), truth, **allowed)


@each_renderer
@pytest.mark.parametrize("thickness", [0.0, -1.5])
def test_a_stroke_without_thickness_leaves_no_mark_and_gets_no_gradient(renderer: Renderer, thickness: float) -> None:
    assert_leaves_no_mark(renderer, one_stroke([[3.1, 4.2], [9.5, 8.5]], [thickness, thickness]))
    assert_leaves_no_mark(renderer, one_stroke([[3.5, 4.5]], [thickness]))


@each_fast_renderer
def test_a_stroke_whose_thickness_passes_through_zero_marks_only_its_thick_part(fast: Renderer) -> None:
    scene = one_stroke([[2.2, 9.3], [12.1, 10.4], [21.7, 9.9]], [-2.0, 2.5, -1.0], plateau=0.6)
    assert_as_the_reference(fast, scene)
    image = fast.darkness(*scene[1:3], *scene[4:], height=20, width=24)[0]
    assert image[:, :6].sum() == 0
    assert image[10, 12] == 1


@each_renderer
@pytest.mark.parametrize("shift", [(-40.0, 0.0), (40.0, 0.0), (0.0, -40.0), (0.0, 40.0), (90.0, 90.0)])
def test_a_stroke_off_the_canvas_leaves_no_mark_and_gets_no_gradient(
    renderer: Renderer, shift: tuple[float, float]
) -> None:
    x, y = shift
    assert_leaves_no_mark(renderer, one_stroke([[5 + x, 6 + y], [15 + x, 12 + y], [7 + x, 14 + y]], [2.0, 2.0, 2.0]))


@each_fast_renderer
@pytest.mark.parametrize("shift", [(-11.0, 0.0), (13.0, 0.0), (0.0, -8.0), (0.0, 11.0), (13.0, 11.0)])
def test_a_stroke_partly_off_the_canvas_is_cut_off_at_its_edge(fast: Renderer, shift: tuple[float, float]) -> None:
    x, y = shift
    scene = one_stroke([[5.2 + x, 6.1 + y], [15.3 + x, 12.7 + y], [7.4 + x, 14.6 + y]], [2.0, 3.0, 1.0], plateau=0.2)
    assert_as_the_reference(fast, scene)


@each_fast_renderer
def test_a_segment_without_length_is_as_the_reference_says(fast: Renderer) -> None:
    assert_as_the_reference(
        fast, one_stroke([[3.1, 4.2], [9.3, 8.1], [9.3, 8.1], [14.2, 5.7]], [1.0, 2.0, 3.0, 1.5], plateau=0.1)
    )
    assert_as_the_reference(fast, one_stroke([[9.3, 8.1], [9.3, 8.1]], [2.0, 3.0], plateau=0.1))


@each_renderer
def test_one_point_is_a_dot_and_so_are_equal_points(renderer: Renderer) -> None:
    dot = darkness_with_gradients(renderer, one_stroke([[9.3, 8.1]], [4.0], plateau=0.1))
    points = darkness_with_gradients(renderer, one_stroke([[9.3, 8.1]] * 3, [4.0] * 3, plateau=0.1))
    expected = mean_over_pixel(lambda x, y: (1 - np.hypot(x - 9.3, y - 8.1) / 4) / 0.9, 7, 10)
    assert float(dot["value"][0, 10, 7]) == pytest.approx(expected, abs=tolerances.BESIDE_A_POINT)
    assert torch.equal(points.pop("value"), dot.pop("value"))
    for name in ("points", "thickness"):
        assert dot[name].abs().max() > 0
        total = points[name].sum(dim=1, keepdim=True)
        torch.testing.assert_close(total, dot[name], rtol=tolerances.FLOAT32_GRADIENT, atol=0)


@each_fast_renderer
def test_one_point_has_the_reference_gradients(fast: Renderer) -> None:
    assert_as_the_reference(fast, random_scene(20, points=1, strokes=9))


@each_renderer
def test_a_stroke_that_goes_over_itself_is_as_dark_as_once(renderer: Renderer) -> None:
    a, b = [3.1, 4.2], [15.3, 11.8]
    once = composite_with_gradients(renderer, one_stroke([a, b], [2.0, 3.0], plateau=0.2))
    again = composite_with_gradients(renderer, one_stroke([a, b, a, b], [2.0, 3.0, 2.0, 3.0], plateau=0.2))
    torch.testing.assert_close(again["value"], once["value"], atol=tolerances.BESIDE_A_CORNER, rtol=0)


@each_renderer
def test_the_first_of_equal_segments_gets_the_gradient(renderer: Renderer) -> None:
    result = darkness_with_gradients(renderer, one_stroke([[9.3, 8.1]] * 4, [3.0] * 4, plateau=0.1))
    for name in ("points", "thickness"):
        assert result[name][0, 0].abs().max() > 0
        assert not result[name][0, 2:].any()


@each_fast_renderer
def test_on_a_kink_both_renderers_choose_the_same_side(fast: Renderer) -> None:
    # Exact numbers: pixels on the centre line, at right angles to an end, and a half-width away from it.
    scene = one_stroke([[2.5, 2.5], [10.5, 2.5], [10.5, 10.5]], [2.0, 4.0, 2.0])
    assert_as_the_reference(fast, scene)
    assert_as_the_reference(fast, scene._replace(plateau=torch.tensor([0.5])))


@each_renderer
def test_an_empty_set_of_strokes_leaves_the_canvas_as_it_was(renderer: Renderer) -> None:
    for shared in (False, True):
        scene = random_scene(21, strokes=0, shared=shared)
        result = composite_with_gradients(renderer, scene)
        assert torch.equal(result["value"], scene.canvas)
        assert torch.equal(result["canvas"], weights_like(scene.canvas))
        for name in ("points", "thickness", "colours", "falloff", "plateau", "opacity"):
            assert result[name].shape == getattr(scene, name).shape
            assert not result[name].any()
        image = renderer.darkness(*scene[1:3], *scene[4:], height=3, width=5)
        assert image.shape == (0, 3, 5)


@each_fast_renderer
@pytest.mark.parametrize(
    ("height", "width"), [(1, 1), (1, 200), (150, 1), (5, 3), (16, 64), (32, 128), (17, 65), (33, 63), (15, 130)]
)
def test_a_canvas_of_any_shape_is_painted_as_the_reference_does(fast: Renderer, height: int, width: int) -> None:
    assert_as_the_reference(fast, random_scene(22, height=height, width=width, strokes=9, thinnest=1.5))


@cache
def hundreds_over_one_tile(channels: int) -> tuple[Scene, Tensor, dict[str, Tensor]]:
    """Return a scene, which of its strokes are trainable, and what the reference makes of it, which takes seconds."""
    scene = random_scene(23, strokes=420, points=4, channels=channels, height=18, width=22)
    scene = scene._replace(opacity=scene.opacity * 0.2)
    trainable = torch.arange(420) % 3 > 0
    return scene, trainable, composite_with_gradients(REFERENCE, scene.to(torch.float64), trainable)


@each_fast_renderer
@pytest.mark.parametrize("channels", [1, 4])
def test_hundreds_of_strokes_over_one_tile_are_painted_as_the_reference_does(fast: Renderer, channels: int) -> None:
    scene, trainable, truth = hundreds_over_one_tile(channels)
    assert truth["colours"][:9].any()  # the lowest still matter
    assert_same(composite_with_gradients(fast, scene, trainable), truth, **FLOAT32)


@each_fast_renderer
def test_a_long_stroke_between_two_points_is_drawn_over_its_whole_length(fast: Renderer) -> None:
    ends = [[[-60.3, -40.1], [190.2, 140.7]], [[170.3, -30.7], [-50.9, 150.1]], [[64.1, -900.3], [63.7, 800.2]]]
    scene = random_scene(24, strokes=3, points=2, height=100, width=130)._replace(points=torch.tensor(ends))
    assert_as_the_reference(fast, scene, FAR)


@each_fast_renderer
@pytest.mark.parametrize("huge", [1e10, 1e19, 1e30, 3e38])
def test_huge_coordinates_and_thicknesses_paint_finite_colours_with_finite_gradients(
    fast: Renderer, huge: float
) -> None:
    for points, thickness in (
        ([[huge, huge], [huge, -huge]], [2.0, 2.0]),
        ([[-huge, -huge], [huge, huge], [5.0, 5.0]], [2.0, 2.0, 2.0]),
        ([[-huge, 5.5], [huge, 5.5]], [2.0, 2.0]),
        ([[5.5, 5.5], [9.5, 9.5]], [huge, huge]),
        ([[5.5, 5.5], [9.5, 9.5]], [-huge, huge]),
        ([[huge, 5.5], [5.5, huge]], [huge, 1.0]),
        ([[huge, -huge]], [huge]),
    ):
        result = composite_with_gradients(fast, one_stroke(points, thickness))
        for name, x in result.items():
            assert x.isfinite().all(), name


@each_renderer
def test_a_thickness_next_to_nothing_does_not_hide_the_next_segment(renderer: Renderer) -> None:
    scene = one_stroke([[5.5, 5.5], [5.5, 5.5], [9.5, 5.5]], [1e-30, 2.0, 2.0], plateau=0.6)
    image = renderer.darkness(*scene[1:3], *scene[4:], height=20, width=24)[0]
    assert image[5, 5] == 1


def scene_with(name: str, index: tuple[int, ...], value: float) -> Scene:
    scene = random_scene(25)
    changed = getattr(scene, name).clone()
    changed[index] = value
    return scene._replace(**{name: changed})


@each_renderer
@pytest.mark.parametrize("value", [torch.nan, torch.inf, -torch.inf])
def test_a_number_that_is_not_finite_is_refused_and_its_stroke_named(renderer: Renderer, value: float) -> None:
    for name, index, message in (
        ("points", (3, 2, 1), r"stroke 3 has a point that is not finite: \[.*(nan|inf)\] at index 2"),
        ("thickness", (1, 4), r"stroke 1 has a thickness that is not finite: (nan|-?inf) at index 4"),
        ("colours", (4, 0), r"stroke 4 has a colour that is not finite: (nan|-?inf) at index 0"),
        ("falloff", (2,), r"falloff of stroke 2 is (nan|-?inf); it must be above 0"),
        ("plateau", (2,), r"plateau of stroke 2 is (nan|-?inf); it must be in \[0, 1\)"),
        ("opacity", (2,), r"opacity of stroke 2 is (nan|-?inf); it must be in \(0, 1\]"),
    ):
        scene = scene_with(name, index, value)
        with pytest.raises(InputError, match=message):
            renderer.composite(*scene)
        if name != "colours":
            with pytest.raises(InputError, match=message):
                renderer.darkness(*scene[1:3], *scene[4:], height=37, width=70)


@each_renderer
@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("falloff", 0.0, r"falloff of stroke 1 is 0; it must be above 0"),
        ("falloff", -2.0, r"falloff of stroke 1 is -2; it must be above 0"),
        ("plateau", 1.0, r"plateau of stroke 1 is 1; it must be in \[0, 1\)"),
        ("plateau", -0.25, r"plateau of stroke 1 is -0.25; it must be in \[0, 1\)"),
        ("opacity", 0.0, r"opacity of stroke 1 is 0; it must be in \(0, 1\]"),
        ("opacity", 1.5, r"opacity of stroke 1 is 1.5; it must be in \(0, 1\]"),
    ],
)
def test_a_number_out_of_range_is_refused_and_its_stroke_named(
    renderer: Renderer, name: str, value: float, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        renderer.composite(*scene_with(name, (1,), value))


@each_renderer
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"points": torch.zeros(5, 6)}, r"points have shape \(5, 6\); they must be \(N, n, 2\)"),
        ({"points": torch.zeros(5, 6, 3)}, r"points have shape \(5, 6, 3\); they must be \(N, n, 2\)"),
        (
            {"points": torch.zeros(5, 0, 2), "thickness": torch.zeros(5, 0)},
            r"points have shape \(5, 0, 2\); .* at least 1",
        ),
        ({"thickness": torch.ones(5, 4)}, r"thickness has shape \(5, 4\); points ask for \(5, 6\)"),
        ({"thickness": torch.ones(5)}, r"thickness has shape \(5,\); points ask for \(5, 6\)"),
        ({"falloff": torch.ones(2)}, r"falloff has shape \(2,\); it must be \(5,\) or \(1,\)"),
        ({"plateau": torch.tensor(0.5)}, r"plateau has shape \(\); it must be \(5,\) or \(1,\)"),
        ({"opacity": torch.ones(5, 1)}, r"opacity has shape \(5, 1\); it must be \(5,\) or \(1,\)"),
        ({"colours": torch.zeros(5, 4)}, r"colours have shape \(5, 4\); it must be \(5, 3\)"),
        ({"canvas": torch.zeros(37, 70)}, r"the canvas has shape \(37, 70\); it must be \(C, H, W\), none of them 0"),
        (
            {"canvas": torch.zeros(3, 0, 70)},
            r"the canvas has shape \(3, 0, 70\); it must be \(C, H, W\), none of them 0",
        ),
    ],
)
def test_a_wrong_shape_is_refused(renderer: Renderer, change: dict[str, Tensor], message: str) -> None:
    with pytest.raises(InputError, match=message):
        renderer.composite(*random_scene(26)._replace(**change))


@each_renderer
@pytest.mark.parametrize(
    ("trainable", "message"),
    [
        (torch.ones(4, dtype=torch.bool), r"trainable is torch.bool \(4,\); it must be torch.bool \(5,\)"),
        (torch.ones(5), r"trainable is torch.float32 \(5,\); it must be torch.bool \(5,\)"),
    ],
)
def test_a_wrong_choice_of_strokes_is_refused(renderer: Renderer, trainable: Tensor, message: str) -> None:
    with pytest.raises(InputError, match=message):
        renderer.composite(*random_scene(27), trainable=trainable)


@each_renderer
@pytest.mark.parametrize(("height", "width"), [(0, 5), (5, -1)])
def test_an_image_without_pixels_is_refused(renderer: Renderer, height: int, width: int) -> None:
    scene = random_scene(28)
    with pytest.raises(InputError, match=rf"the image size is {height} x {width}; it must be at least 1 x 1"):
        renderer.darkness(*scene[1:3], *scene[4:], height=height, width=width)


@pytest.mark.parametrize(
    ("name", "index", "value", "message"),
    [
        ("points", (3, 2, 1), 1e300, "stroke 3 has a point that is not finite"),
        ("thickness", (1, 4), -1e39, "stroke 1 has a thickness that is not finite"),
        ("colours", (4, 0), 1e39, "stroke 4 has a colour that is not finite"),
        ("falloff", (2,), 1e-60, "falloff of stroke 2 is 0; it must be above 0"),
        ("plateau", (2,), 1 - 1e-12, r"plateau of stroke 2 is 1; it must be in \[0, 1\)"),
    ],
)
def test_a_number_that_float32_cannot_hold_is_refused(
    name: str, index: tuple[int, ...], value: float, message: str
) -> None:
    scene = random_scene(25).to(torch.float64)
    getattr(scene, name)[index] = value
    with pytest.raises(InputError, match=message):
        cpu.composite(*scene)


def test_an_unknown_instruction_set_is_refused() -> None:
    with pytest.raises(ValueError, match="no instruction set abacus"):
        cpu.composite(*random_scene(29), instructions="abacus")
