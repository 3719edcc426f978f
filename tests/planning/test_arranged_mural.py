"""Murals in ink in a hand whose arrangement is known: windows hold it as the whole does."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from maulstick.painting.painting import Sheet
from maulstick.painting.raster import Canvas
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.windows import Mural
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.state import State
from maulstick.storage.arrays import Image as Picture
from tests.planning.conftest import options
from tests.planning.test_arranged_plan import HAND, far
from tests.support.nominal import nominal
from tests.support.planning.same import same

INK = options(paints=None, strokes=120, steps=30)
CORE = 30  # pixels of a window's side


@pytest.fixture(scope="module")
def mural(portrait: Picture) -> Mural:
    return Mural(portrait, Sheet(width=0.12, height=0.096), Canvas(0.12, 0.096, 500))


def drawn(
    mural: Mural,
    settings: PlannerSettings = INK,
    watch: Callable[[PlanProgress], bool] = lambda progress: True,
    resume: State | None = None,
) -> PlanResult:
    pen = (nominal("fineliner"),)
    return plan_mural(mural, pen, HAND, settings, watch, loss_options=LossOptions(), window_px=CORE, resume=resume)


@pytest.fixture(scope="module")
def states() -> list[State]:
    """States after every step of `arranged`."""
    return []


@pytest.fixture(scope="module")
def arranged(mural: Mural, states: list[State]) -> PlanResult:
    def watch(progress: PlanProgress) -> bool:
        states.append(progress.state())
        return True

    return drawn(mural, watch=watch)


def test_strokes_of_a_mural_lie_as_the_hands_do(mural: Mural, arranged: PlanResult) -> None:
    alone = drawn(mural, replace(INK, arrange=0.0))
    assert far(arranged.strokes) < 0.4 * far(alone.strokes)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_an_arranged_mural_goes_on_as_if_it_had_not_stopped(
    mural: Mural, arranged: PlanResult, states: list[State], share: float
) -> None:
    assert same(drawn(mural, resume=states[int(share * len(states))]), arranged)
