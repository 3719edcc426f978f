"""Planning on another device than the CPU, to the bit as on the CPU: no tensor is left behind, none is mixed."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
import torch

from maulstick.painting.brush import Brush
from maulstick.painting.painting import Painting, Sheet
from maulstick.painting.raster import Canvas
from maulstick.planning.features.network import Network
from maulstick.planning.from_picture import as_painting, problem_of, provenance_of, with_metrics
from maulstick.planning.layout import lay_out_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.windows import Mural
from maulstick.planning.objectives import edges, pyramid
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.schedule import Schedule
from maulstick.planning.state import State
from maulstick.rendering.kernels.repeated import Repeated
from maulstick.storage.arrays import Image
from maulstick.style import load_style
from tests.planning.conftest import options
from tests.support.nominal import nominal
from tests.support.planning import far_device as far_devices
from tests.support.planning.far_device import FarTensor, far_device
from tests.support.planning.same import same
from tests.support.planning.tiny_network import TinyNetwork

CPU = torch.device("cpu")
PALETTE = ((0.9, 0.8, 0.7), (0.2, 0.2, 0.4), (0.5, 0.3, 0.1))


def planned(
    device: torch.device,
    picture: Image | None,
    settings: PlannerSettings,
    loss_options: LossOptions,
    brush: Brush,
    network: type[Network] = TinyNetwork,
) -> tuple[PlanResult, Painting, State]:
    """Plan, and on another device go on from the middle as well; return plan, painting and the state there."""
    layout = lay_out_for(picture, Sheet(width=0.06, height=0.05), brush, height_px=24)
    style, states = load_style("free", layout.canvas), list[State]()
    problem = problem_of(layout, (brush,), style, settings, loss_options, network, device=device)

    def watch(progress: PlanProgress) -> bool:
        assert isinstance(progress.canvas, FarTensor) == (device != CPU)
        states.append(progress.state())
        return True

    result = plan(problem, settings, watch)
    middle = states[len(states) // 2]
    assert device == CPU or same(plan(problem, settings, resume=middle), result)
    painting = as_painting(result, layout, (brush,), style, provenance_of(settings))
    return result, with_metrics(painting, layout, problem), middle


@pytest.fixture(autouse=True)
def same_pyramid(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tones and edges of both devices are compared plainly: the fast way of the CPU rounds otherwise."""
    for module in (pyramid, edges):
        monkeypatch.setattr(module, "has_native", lambda image: False)


@pytest.mark.parametrize(
    ("settings", "weights", "text"),
    [
        (options(steps=9), {"edges": 1.0}, None),
        (options(steps=9, paints=None, palette=PALETTE, in_colours=True), {}, None),
        (options(steps=9, paints=None, palette=PALETTE), {}, None),
        (options(steps=9, paints=None), {}, None),
        (options(steps=9, ask_every=4), {"likeness": 1.0, "sketch": 1.0, "look": 1.0}, None),
        (options(steps=9, ask_every=4), {}, "a boat"),
    ],
    ids=["mixed paints", "given paints", "inks", "one ink", "networks", "text alone"],
)
def test_a_plan_of_another_device_is_that_of_the_cpu(
    portrait: Image, settings: PlannerSettings, weights: Mapping[str, float], text: str | None
) -> None:
    picture, look = portrait if text is None else None, portrait[::-1] if "look" in weights else None
    arguments = picture, settings, LossOptions(text, look, weights), nominal("round")
    near, near_painting, near_state = planned(CPU, *arguments)
    with far_device() as device:
        far, far_painting, far_state = planned(device, *arguments)
    assert same(far, near)
    assert far_painting == near_painting
    assert far_state.keys() == near_state.keys()
    assert all(np.array_equal(far_state[name], near_state[name]) for name in near_state)


def test_a_mural_of_another_device_is_that_of_the_cpu(portrait: Image) -> None:
    mural = Mural(portrait, Sheet(width=0.06, height=0.05), Canvas(0.06, 0.05, 1000))
    settings, style = options(steps=5), load_style("free", mural.canvas)
    near = plan_mural(mural, (nominal("round"),), style, settings, window_px=32)
    with far_device() as device:
        far = plan_mural(mural, (nominal("round"),), style, settings, window_px=32, device=device)
    assert same(far, near)
    assert len(near.paint_of) > 10


@pytest.mark.parametrize(("coarse", "more"), [((0.0, 0.0), 0), ((1.0, 1.0), 6)])
def test_a_step_asks_another_device_for_few_operations(
    portrait: Image, monkeypatch: pytest.MonkeyPatch, coarse: tuple[float, float], more: int
) -> None:
    moves_and_views = ("_to_copy", "unsqueeze", "squeeze", "expand", "select.int", "view", "detach")
    asked: list[str] = []
    recorded: list[str] = []
    of_steps: list[tuple[list[str], int]] = []
    computed = far_devices._computed

    def noted(operation: Any, *args: Any) -> Any:
        result = computed(operation, *args)
        name = str(operation).removeprefix("aten.")
        if isinstance(result, FarTensor) and not name.startswith(moves_and_views):
            asked.append(name)
        return result

    def watch(progress: PlanProgress) -> bool:
        of_steps.append((asked.copy(), len(recorded)))
        asked.clear()
        recorded.clear()
        return True

    def replayed(self: Repeated, work: Callable[[], None], on: object) -> None:
        before = len(asked)
        repeat(self, work, on)
        recorded.extend(asked[before:])
        asked[before:] = ["replay"]

    repeat = Repeated.__call__
    monkeypatch.setattr(Repeated, "__call__", replayed)
    monkeypatch.setattr(far_devices, "_computed", noted)
    with far_device() as device:
        layout = lay_out_for(portrait, Sheet(width=0.06, height=0.05), nominal("round"), height_px=256)
        style, settings = load_style("free", layout.canvas), options(steps=30)
        problem = problem_of(layout, (nominal("round"),), style, settings, LossOptions(), device=device)
        plan(problem, settings, watch, schedule=Schedule(coarse=coarse))
    first, usual = of_steps[4], of_steps[21]  # nothing is sorted, moved or mixed; later only the finest tones count
    assert 5 + more < len(usual[0]) < len(first[0]) <= 15 + more, first
    assert 5 < usual[1] <= 14
    assert usual[1] < first[1] <= 82


def test_tensors_of_two_devices_do_not_mix() -> None:
    with far_device() as device:
        far = torch.ones(2, device=device)
        assert (far * 2.0 + torch.tensor(1.0))[torch.tensor([0])].cpu().tolist() == [3.0]
        with pytest.raises(RuntimeError, match="mixes tensors of the CPU and of the far device"):
            far + torch.ones(2)
        with pytest.raises(RuntimeError, match="numpy"):
            far.numpy()
