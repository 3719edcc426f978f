"""The GPU's kernels against the reference: on a GPU where there is one, else as Triton's interpreter runs them."""

import os
import subprocess
import sys
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor
from torch.utils._python_dispatch import TorchDispatchMode, _disable_current_modes
from torch.utils._pytree import tree_leaves

from maulstick.errors import InputError
from tests.rendering.kernels.conftest import (
    REFERENCE,
    Renderer,
    Scene,
    assert_same,
    composite_with_gradients,
    darkness_with_gradients,
    one_stroke,
    random_scene,
    weights_like,
)
from tests.support import tolerances

DEVICE = "cuda" if torch.cuda.is_available() else "cpu"
pytest.importorskip("triton")  # which comes with torch on Linux, and on no other system

from triton.runtime import interpreter  # noqa: E402
from triton.runtime.interpreter import InterpretedFunction  # noqa: E402

from maulstick.rendering.kernels import cpu, gpu, gpu_canvas, gpu_lists, gpu_tiles, render  # noqa: E402


@pytest.fixture(scope="module", autouse=True)
def _functions_call_each_other_fast() -> Generator[None]:
    """The interpreter looks through the whole language at each call of a function; here once for each module."""
    patched = set[str]()

    def call(function: InterpretedFunction, *args: object, **kwargs: object) -> object:
        if function.fn.__module__ not in patched:
            patched.add(function.fn.__module__)
            interpreter._patch_lang(function.fn)
        return function.rewrite()(*args, **kwargs)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(InterpretedFunction, "__call__", call)
        yield


FLOAT32 = {"value": tolerances.FLOAT32_VALUE_CREASED, "gradient": tolerances.FLOAT32_GRADIENT_CREASED}
FAR = {"value": tolerances.FLOAT32_VALUE_FAR, "gradient": tolerances.FLOAT32_GRADIENT_FAR}


def there_and_back(operation: Callable[..., Tensor]) -> Callable[..., Tensor]:
    """The same operation for tensors of the CPU."""

    def moved(x: object) -> object:
        return x.to(DEVICE) if isinstance(x, Tensor) else x

    def run(*args: object, **kwargs: object) -> Tensor:
        return operation(*map(moved, args), **{name: moved(x) for name, x in kwargs.items()}).cpu()

    return run


GPU = Renderer(there_and_back(gpu.darkness), there_and_back(gpu.composite))

scenes = st.builds(
    random_scene,
    seed=st.integers(0, 2**32),
    strokes=st.integers(0, 4),
    points=st.integers(1, 5),
    channels=st.integers(1, 5),
    height=st.integers(1, 36),
    width=st.integers(1, 36),
    shared=st.booleans(),
    thinnest=st.sampled_from([-3.0, 0.0, 0.5]),
)


def small_scene(seed: int, *, strokes: int = 5, points: int = 4, channels: int = 3, shared: bool = False) -> Scene:
    return random_scene(
        seed, strokes=strokes, points=points, channels=channels, shared=shared, height=17, width=21, thinnest=1.0
    )


def assert_composites_as_the_reference(
    scene: Scene, trainable: Tensor | None = None, allowed: dict[str, float] = FLOAT32
) -> dict[str, Tensor]:
    truth = composite_with_gradients(REFERENCE, scene.to(torch.float64), trainable)
    result = composite_with_gradients(GPU, scene, trainable)
    assert_same(result, truth, **allowed)
    return result


def assert_darkens_as_the_reference(scene: Scene, allowed: dict[str, float] = FLOAT32) -> None:
    truth = darkness_with_gradients(REFERENCE, scene.to(torch.float64))
    assert_same(darkness_with_gradients(GPU, scene), truth, **allowed)


def assert_as_the_reference(scene: Scene, allowed: dict[str, float] = FLOAT32) -> None:
    assert_composites_as_the_reference(scene, allowed=allowed)
    assert_darkens_as_the_reference(scene, allowed)


def assert_leaves_no_mark(scene: Scene) -> None:
    result = composite_with_gradients(GPU, scene)
    assert torch.equal(result.pop("value"), scene.canvas)
    assert torch.equal(result.pop("canvas"), weights_like(scene.canvas))
    for name, gradient in result.items():
        assert torch.equal(gradient, torch.zeros_like(gradient)), name
    assert not any(x.any() for x in darkness_with_gradients(GPU, scene).values())


@pytest.mark.parametrize(("channels", "shared"), [(1, False), (3, True), (5, False)])
def test_the_composite_has_the_reference_values_and_every_gradient(channels: int, shared: bool) -> None:
    result = assert_composites_as_the_reference(small_scene(channels + 1, channels=channels, shared=shared))
    assert all(gradient.abs().max() > 0 for gradient in result.values())


@pytest.mark.parametrize("shared", [False, True])
def test_the_darkness_has_the_reference_values_and_every_gradient(shared: bool) -> None:
    assert_darkens_as_the_reference(small_scene(5, shared=shared))


@given(scene=scenes)
@settings(derandomize=True, deadline=None, max_examples=10)
def test_any_scene_composites_as_the_reference_does(scene: Scene) -> None:
    assert_composites_as_the_reference(scene)


@given(scene=scenes)
@settings(derandomize=True, deadline=None, max_examples=10)
def test_any_stroke_alone_is_as_dark_as_the_reference_says(scene: Scene) -> None:
    assert_darkens_as_the_reference(scene)


def test_a_falloff_below_one_has_the_reference_values_and_gradients() -> None:
    assert_composites_as_the_reference(small_scene(11)._replace(falloff=torch.tensor([0.7])))


def test_neutral_plateau_and_opacity_have_the_reference_values_and_gradients() -> None:
    assert_composites_as_the_reference(small_scene(13)._replace(plateau=torch.zeros(1), opacity=torch.ones(1)))


def test_strokes_one_upon_another_are_painted_as_the_reference_does() -> None:
    scene = random_scene(23, strokes=24, points=3, channels=1, height=8, width=8, thinnest=2)
    scene = scene._replace(points=scene.points.remainder(8), opacity=scene.opacity * 0.3)
    result = assert_composites_as_the_reference(scene, torch.arange(24) % 3 > 0)
    assert result["colours"][:6].any()  # the lowest still matter


def test_only_trainable_strokes_get_gradients_and_the_canvas_keeps_its_own() -> None:
    scene = small_scene(3, strokes=6)
    trainable = torch.tensor([True, False, True, True, False, False])
    everything = composite_with_gradients(GPU, scene)
    some = composite_with_gradients(GPU, scene, trainable)
    for name in ("value", "canvas"):
        assert torch.equal(some[name], everything[name])
    for name in ("points", "thickness", "colours", "falloff", "plateau", "opacity"):
        assert not some[name][~trainable].any(), name
        assert torch.equal(some[name][trainable], everything[name][trainable]), name
        assert everything[name][~trainable].any(), name


def test_a_canvas_that_needs_no_gradient_changes_no_other_gradient() -> None:
    scene = small_scene(14)
    everything = composite_with_gradients(GPU, scene)
    leaves = [x.clone().requires_grad_() for x in scene[1:]]
    out = GPU.composite(scene.canvas, *leaves)
    for name, gradient in zip(Scene._fields[1:], torch.autograd.grad(out, leaves, weights_like(out)), strict=True):
        assert torch.equal(gradient, everything[name]), name


# At the edge of what can be drawn


@pytest.mark.parametrize("thickness", [0.0, -1.5])
def test_a_stroke_without_thickness_leaves_no_mark_and_gets_no_gradient(thickness: float) -> None:
    assert_leaves_no_mark(one_stroke([[3.1, 4.2], [9.5, 8.5]], [thickness, thickness]))
    assert_leaves_no_mark(one_stroke([[3.5, 4.5]], [thickness]))


def test_a_stroke_whose_thickness_passes_through_zero_marks_only_its_thick_part() -> None:
    assert_as_the_reference(one_stroke([[2.2, 9.3], [12.1, 10.4], [21.7, 9.9]], [-2.0, 2.5, -1.0], plateau=0.2))


@pytest.mark.parametrize("shift", [(-40.0, 0.0), (40.0, 0.0), (0.0, -40.0), (0.0, 40.0)])
def test_a_stroke_off_the_canvas_leaves_no_mark_and_gets_no_gradient(shift: tuple[float, float]) -> None:
    x, y = shift
    assert_leaves_no_mark(one_stroke([[5 + x, 6 + y], [15 + x, 12 + y], [7 + x, 14 + y]], [2.0, 2.0, 2.0]))


@pytest.mark.parametrize("shift", [(-11.0, 0.0), (13.0, 0.0), (0.0, -8.0), (13.0, 11.0)])
def test_a_stroke_partly_off_the_canvas_is_cut_off_at_its_edge(shift: tuple[float, float]) -> None:
    x, y = shift
    assert_composites_as_the_reference(
        one_stroke([[5.2 + x, 6.1 + y], [15.3 + x, 12.7 + y], [7.4 + x, 14.6 + y]], [2.0, 3.0, 1.0], plateau=0.2)
    )


def test_a_segment_without_length_is_as_the_reference_says() -> None:
    assert_as_the_reference(
        one_stroke([[3.1, 4.2], [9.3, 8.1], [9.3, 8.1], [14.2, 5.7]], [1.0, 2.0, 3.0, 1.5], plateau=0.1)
    )


def test_one_point_is_a_dot_with_the_reference_gradients() -> None:
    assert_as_the_reference(small_scene(20, points=1, strokes=9))


def test_the_first_of_equal_segments_gets_the_gradient() -> None:
    a, b = [3.1, 4.2], [15.3, 11.8]
    again = darkness_with_gradients(GPU, one_stroke([a, b, b, a, b], [2.0, 3.0, 3.0, 2.0, 3.0], plateau=0.2))
    assert again["points"][0, :2].abs().max() > 0
    assert not again["points"][0, 4].any()
    dot = darkness_with_gradients(GPU, one_stroke([[9.3, 8.1]] * 4, [3.0] * 4, plateau=0.1))
    assert dot["points"][0, 0].abs().max() > 0
    assert not dot["points"][0, 2:].any()


def test_on_a_kink_the_same_side_is_chosen_as_by_the_reference() -> None:
    # Exact numbers: pixels on the centre line, at right angles to an end, and a half-width away from it.
    assert_as_the_reference(one_stroke([[2.5, 2.5], [10.5, 2.5], [10.5, 10.5]], [2.0, 4.0, 2.0]))
    assert_as_the_reference(one_stroke([[2.5, 2.5], [10.5, 2.5], [10.5, 10.5]], [2.0, 4.0, 2.0], plateau=0.5))


@pytest.mark.parametrize("shared", [False, True])
def test_an_empty_set_of_strokes_leaves_the_canvas_as_it_was(shared: bool) -> None:
    scene = small_scene(21, strokes=0, shared=shared)
    result = composite_with_gradients(GPU, scene)
    assert torch.equal(result["value"], scene.canvas)
    assert torch.equal(result["canvas"], weights_like(scene.canvas))
    assert GPU.darkness(*scene[1:3], *scene[4:], height=3, width=5).shape == (0, 3, 5)


@pytest.mark.parametrize(("height", "width"), [(1, 1), (1, 33), (33, 1), (16, 16), (17, 15)])
def test_a_canvas_of_any_shape_is_painted_as_the_reference_does(height: int, width: int) -> None:
    assert_as_the_reference(random_scene(22, height=height, width=width, strokes=4, points=3, thinnest=1.5))


def test_a_long_stroke_between_two_points_is_drawn_over_its_whole_length() -> None:
    ends = [[[-60.3, -40.1], [110.2, 80.7]], [[90.3, -30.7], [-50.9, 90.1]], [[34.1, -900.3], [33.7, 800.2]]]
    scene = random_scene(24, strokes=3, points=2, height=40, width=50)._replace(points=torch.tensor(ends))
    assert_composites_as_the_reference(scene, allowed=FAR)


of_overflows = pytest.mark.filterwarnings("ignore::RuntimeWarning")  # NumPy's, of what a GPU passes over


@of_overflows
@pytest.mark.parametrize("huge", [1e10, 1e19, 3e38])
def test_huge_coordinates_and_thicknesses_paint_finite_colours_with_finite_gradients(huge: float) -> None:
    for points, thickness in (
        ([[huge, huge], [huge, -huge]], [2.0, 2.0]),
        ([[-huge, -huge], [huge, huge], [5.0, 5.0]], [2.0, 2.0, 2.0]),
        ([[-huge, 5.5], [huge, 5.5]], [2.0, 2.0]),
        ([[5.5, 5.5], [9.5, 9.5]], [huge, huge]),
        ([[5.5, 5.5], [9.5, 9.5]], [-huge, huge]),
        ([[huge, 5.5], [5.5, huge]], [huge, 1.0]),
        ([[huge, -huge]], [huge]),
    ):
        for name, x in composite_with_gradients(GPU, one_stroke(points, thickness)).items():
            assert x.isfinite().all(), name


def test_a_thickness_next_to_nothing_does_not_hide_the_next_segment() -> None:
    scene = one_stroke([[5.5, 5.5], [5.5, 5.5], [9.5, 5.5]], [1e-30, 2.0, 2.0])
    behind = one_stroke([[5.5, 5.5], [9.5, 5.5]], [2.0, 2.0])
    found, expected = (GPU.darkness(*x[1:3], *x[4:], height=20, width=24)[0, 5, 5] for x in (scene, behind))
    assert expected > 0.8
    assert abs(found - expected) <= tolerances.FLOAT32_VALUE


@of_overflows
def test_what_cannot_be_drawn_is_refused_in_the_words_of_the_reference() -> None:
    scene = small_scene(25)
    for change, message in (
        ({"thickness": torch.ones(5)}, r"thickness has shape \(5,\); points ask for \(5, 4\)"),
        ({"plateau": torch.tensor([0, 1.0, 0, 0, 0])}, r"plateau of stroke 1 is 1; it must be in \[0, 1\)"),
        ({"colours": torch.full((5, 3), 1e39, dtype=torch.float64)}, "stroke 0 has a colour that is not finite"),
        ({"canvas": torch.zeros(3, 0, 7)}, r"the canvas has shape \(3, 0, 7\); it must be \(C, H, W\)"),
    ):
        with pytest.raises(InputError, match=message):
            GPU.composite(*scene._replace(**change))
    with pytest.raises(InputError, match="the image size is 0 x 5; it must be at least 1 x 1"):
        GPU.darkness(*scene[1:3], *scene[4:], height=0, width=5)


# How they run


class Launches(TorchDispatchMode):
    """Names of the operations and programs that compute: no views, no empty tensors."""

    def __init__(self) -> None:
        super().__init__()
        self.names: list[str] = []

    def __torch_dispatch__(self, operation, types, args=(), kwargs=None):  # type: ignore[no-untyped-def]
        result = operation(*args, **kwargs or {})
        came, went = ([x for x in tree_leaves(each) if isinstance(x, Tensor)] for each in ((args, kwargs), result))
        places = {x.untyped_storage().data_ptr() for x in came}
        is_view = not operation._schema.is_mutable and {x.untyped_storage().data_ptr() for x in went} <= places
        if "empty" not in str(operation) and (not is_view or not went):
            self.names.append(str(operation))
        return result


def test_a_canvas_and_its_gradients_take_few_launches(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = small_scene(31)
    leaves = [x.to(DEVICE, copy=True).requires_grad_() for x in scene]
    weights = weights_like(scene.canvas).to(DEVICE)
    launches = Launches()
    launch = gpu_lists.launch

    def counted(program: Any, *args: Any, **warps: int) -> None:
        with _disable_current_modes():  # the interpreter computes by tensors
            launch(program, *args, **warps)
        launches.names.append(str(program))

    for module in (gpu_lists, gpu_canvas):
        monkeypatch.setattr(module, "launch", counted)
    with launches:
        torch.autograd.grad(gpu.composite(*leaves), leaves, weights)
    assert len(launches.names) <= 25, launches.names


@pytest.mark.parametrize("room", [gpu_lists.Room(3, 2), gpu_lists.Room(1024, 2)])
def test_lists_that_had_too_little_room_are_made_again(room: gpu_lists.Room, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = small_scene(32)
    for channels in (0, 3):  # of strokes each alone, and on a canvas
        monkeypatch.setitem(gpu_lists._rooms, gpu_lists.Sizes(5, 4, channels, 17, 21), room)
    assert_as_the_reference(scene)
    assert all(gpu_lists._rooms[gpu_lists.Sizes(5, 4, channels, 17, 21)] != room for channels in (0, 3))


def test_what_is_painted_again_and_again_and_its_gradients_are_of_its_own_strokes() -> None:
    sizes = {"strokes": 2, "points": 2, "channels": 1, "height": 8, "width": 8, "thinnest": 1.0}
    scenes = [random_scene(seed, **sizes) for seed in (40, 44)]
    masks = None, torch.tensor([True, False])
    leaves = [[x.clone().requires_grad_() for x in scene] for scene in scenes]
    weights = weights_like(scenes[0].canvas)
    for _ in range(3):  # a GPU records what it does for the second time, and replays it for the third
        canvases = [GPU.composite(*scene, trainable=mask) for scene, mask in zip(leaves, masks, strict=True)]
        for scene, mask, canvas, own in zip(scenes, masks, canvases, leaves, strict=True):
            alone = composite_with_gradients(GPU, scene, mask, weights)
            assert alone["points"].ne(0).any(dim=2).any(dim=1).tolist() == [True, mask is None]
            assert torch.equal(canvas, alone["value"])
            for _ in range(2):
                gradients = torch.autograd.grad(canvas, own, weights, retain_graph=True)
                for name, gradient in zip(Scene._fields, gradients, strict=True):
                    assert torch.equal(gradient, alone[name]), name


@pytest.mark.parametrize("operation", [composite_with_gradients, darkness_with_gradients])
def test_the_bits_are_the_same_at_every_repeat(operation: Callable[..., dict[str, Tensor]]) -> None:
    scene = small_scene(30)
    first, second = operation(GPU, scene), operation(GPU, scene)
    for name in first:
        assert torch.equal(first[name].view(torch.int32), second[name].view(torch.int32)), name


def test_number_type_and_memory_layout_do_not_matter() -> None:
    scene = small_scene(7)
    plain = composite_with_gradients(GPU, scene)
    strided = Scene(*(torch.stack([x, -x], dim=-1)[..., 0] for x in scene.to(torch.float64)))
    weights = weights_like(plain["value"]).transpose(1, 2).contiguous().transpose(1, 2)
    double = composite_with_gradients(GPU, strided, weights=weights)
    assert double["value"].dtype == torch.float32
    for name in scene._fields:
        assert double[name].dtype == torch.float64
        assert torch.equal(plain[name], double[name].float()), name


def test_arguments_are_left_as_they_were() -> None:
    scene = small_scene(9)
    before = Scene(*(x.clone() for x in scene))
    composite_with_gradients(GPU, scene)
    for name, x, y in zip(scene._fields, scene, before, strict=True):
        assert torch.equal(x, y), name


def test_a_second_derivative_is_refused() -> None:
    scene = small_scene(10)
    points = scene.points.clone().requires_grad_()
    out = GPU.composite(scene.canvas, points, *scene[2:])
    (gradient,) = torch.autograd.grad(out.square().sum(), points, create_graph=True)
    with pytest.raises(RuntimeError, match="once_differentiable"):
        gradient.sum().backward()


@of_overflows
def test_more_segments_than_one_program_prepares_are_painted_as_the_reference_does() -> None:
    count, points = 3, 70  # those that are seen have more segments than one program lists, or goes along at once
    assert (count - 1) * (points - 1) > gpu_tiles.LANES.value
    assert points - 1 > 2 * gpu_tiles.SPAN.value
    scene = random_scene(33, strokes=count, points=points, channels=1, height=12, width=12, thinnest=1)
    places = scene.points.remainder(12) + 1000 * (torch.arange(count) == 0)[:, None, None]
    result = assert_composites_as_the_reference(scene._replace(points=places))
    assert result["points"][1:].any(dim=2).any(dim=1).all()
    spoilt = scene.colours.clone()
    spoilt[count - 1] = torch.nan
    with pytest.raises(InputError, match=f"stroke {count - 1} has a colour that is not finite"):
        GPU.composite(*scene._replace(colours=spoilt))


def test_a_long_thin_segment_is_listed_only_in_the_tiles_along_it() -> None:
    points = torch.tensor([[[3.0, 5.0], [1020.0, 1001.0]], [[700.0, 4.0], [700.0, 1020.0]]], device=DEVICE)
    strokes = torch.tensor([[1.5, 0.0, 1.0, 1.0]] * 2, device=DEVICE)
    segments, counts = points.new_empty(2, 6), torch.zeros(3, dtype=torch.int64, device=DEVICE)
    sizes = 2, 1, 1, 4, 1024, 1024
    gpu_lists.launch(gpu_tiles.list_segments, 1, points, points.new_ones(2, 2), strokes, segments, counts, *sizes)
    diagonal, upright, _ = counts.tolist()
    across = 1024 // gpu_tiles.TILE.value
    assert 2 * across - 1 <= diagonal <= 4 * across
    assert upright == across


def test_tensors_are_rendered_where_they_are() -> None:
    assert render.kernels_for(torch.device("cpu")) is cpu
    assert render.kernels_for(torch.device("cuda", 1)) is gpu


ON_THE_CPU = """
import sys
import torch
from maulstick.rendering.kernels import cpu, render
from tests.rendering.kernels.conftest import Renderer, composite_with_gradients, darkness_with_gradients, random_scene

scene = random_scene(1)
for operation in (composite_with_gradients, darkness_with_gradients):
    chosen = operation(Renderer(render.darkness, render.composite), scene)
    plain = operation(Renderer(cpu.darkness, cpu.composite), scene)
    assert all(torch.equal(chosen[name], plain[name]) for name in plain)
print([name for name in sys.modules if name == "triton" or name.endswith("kernels.gpu")])
"""

COMPILED = """
from triton.backends.compiler import GPUTarget
from triton.compiler import ASTSource, compile
from maulstick.rendering.kernels import gpu_programs, gpu_shapes, gpu_sums, gpu_tiles

SIZES = ("channels", "columns", "height", "width", "count", "tile_count", "each", "after", "beyond")
SIZES += ("room", "item_room")
OTHERS = dict.fromkeys(SIZES, "i32")
OTHERS |= dict.fromkeys(("pairs", "items", "item_count", "tiles", "keys", "firsts", "numbers"), "*i32")
OTHERS |= dict.fromkeys(("slots", "starts", "counts"), "*i64")
for name, module in {
    "find_shapes": gpu_shapes,
    "find_tight": gpu_shapes,
    "list_segments": gpu_tiles,
    "list_tiles": gpu_tiles,
    "find_items": gpu_tiles,
    "list_items": gpu_tiles,
    "find_tiles": gpu_tiles,
    "sum_gradients": gpu_sums,
    "shade": gpu_programs,
    "shade_backward": gpu_programs,
    "blend": gpu_programs,
    "blend_backward": gpu_programs,
}.items():
    program = getattr(module, name)
    signature = {each: OTHERS.get(each, "*fp32") for each in program.arg_names}
    constants = {}
    for chosen, value in {"CHANNELS": 4, "COLUMNS": 16, "ALONE": False}.items():
        if chosen in signature:
            signature[chosen], constants = "constexpr", {(program.arg_names.index(chosen),): value}
    compiled = compile(
        ASTSource(program, signature, constants), GPUTarget("cuda", 80, 32), {"enable_fp_fusion": True}
    )
    print(name, len(compiled.asm["cubin"]) > 0)
"""


def output_of(script: str, folder: Path, **environment: str) -> str:
    kept = {name: value for name, value in os.environ.items() if name != "TRITON_INTERPRET"}
    run = subprocess.run(
        [sys.executable, "-c", script],
        cwd=folder,
        env=kept | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return run.stdout.strip()


def test_on_the_cpu_the_chosen_renderer_is_the_native_one_and_triton_is_never_imported(
    pytestconfig: pytest.Config,
) -> None:
    assert output_of(ON_THE_CPU, pytestconfig.rootpath) == "[]"


def test_every_program_compiles_for_a_real_gpu(pytestconfig: pytest.Config, tmp_path: Path) -> None:
    lines = output_of(COMPILED, pytestconfig.rootpath, TRITON_CACHE_DIR=str(tmp_path)).splitlines()
    assert [line.split()[1] for line in lines] == ["True"] * 12
