"""Rounds of windows: none needs another of its round, so it does not matter who plans which of them, and when."""

import tracemalloc
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import torch

from maulstick.errors import InputError
from maulstick.painting.painting import Sheet
from maulstick.painting.raster import Canvas
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.window import PlanWindows, WatchWindow, Window, WindowPlanner, in_turn
from maulstick.planning.mural.windows import Mural
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.state import State, read_state, write_state
from maulstick.style import load_style
from tests.support.nominal import nominal
from tests.support.planning.same import same
from tests.support.planning.strip import ROUNDS, SETTINGS, TONE, plan_strip


@pytest.fixture(scope="module")
def states() -> list[State]:
    """States after every step of `planned`."""
    return []


@pytest.fixture(scope="module")
def planned(states: list[State]) -> PlanResult:
    def watch(progress: PlanProgress) -> bool:
        states.append(progress.state())
        return True

    return plan_strip(watch=watch)


class _Abandoned(Exception):  # noqa: N818  nothing is wrong
    """Signal that a window is left in the middle."""


def last_first(
    planner: WindowPlanner, windows: Iterator[Window], watch: WatchWindow
) -> Iterator[tuple[int, PlanResult]]:
    """Plan the windows of a round from the last to the first, after each was begun and left in the middle."""

    def leave(index: int, progress: PlanProgress) -> bool:
        watch(index, progress)
        raise _Abandoned

    begun = list(windows)
    for window in begun:
        with pytest.raises(_Abandoned):
            planner.plan(window, partial(leave, window.index))
    for window in reversed(begun):
        yield window.index, planner.plan(window, partial(watch, window.index))


def unplanned(
    planner: WindowPlanner, windows: Iterator[Window], watch: WatchWindow
) -> Iterator[tuple[int, PlanResult]]:
    """Leave all strokes as they begin."""
    for window in windows:
        paints = torch.tensor(window.settings.palette)
        yield window.index, PlanResult(window.start, paints, torch.zeros(len(window.start), dtype=torch.long))


def test_the_order_in_which_windows_of_a_round_are_planned_does_not_show(planned: PlanResult) -> None:
    assert same(plan_strip(last_first), planned)


def test_windows_are_planned_round_by_round(states: list[State], planned: PlanResult) -> None:
    in_windows = states[SETTINGS.steps :]
    done = [state["windows_done"].tolist() for state in in_windows]
    assert done == [[]] * 12 + [ROUNDS[0]] * 12
    ready = [sum(name.startswith("planned-") and name.endswith(".angles") for name in state) for state in in_windows]
    assert ready == [0] * 3 + [1] * 3 + [2] * 3 + [3] * 3 + [0] * 3 + [1] * 3 + [2] * 3 + [3] * 3


@pytest.mark.parametrize("step", [3, 7, 14, 21])
def test_a_round_goes_on_from_its_file_as_if_it_had_not_stopped(
    planned: PlanResult, states: list[State], step: int, tmp_path: Path
) -> None:
    write_state(tmp_path / "plan.npz", states[step], {})
    assert same(plan_strip(resume=read_state(tmp_path / "plan.npz")[0]), planned)


def test_windows_that_were_planned_at_the_same_time_go_on_one_after_another(planned: PlanResult) -> None:
    seen: list[State] = []

    def watch(progress: PlanProgress) -> bool:
        seen.append(progress.state())
        return True

    plan_strip(last_first, watch)
    at_once = [state for state in seen if {f"window-{index}.progress" for index in ROUNDS[1]} <= state.keys()]
    assert len(at_once) == 1 + SETTINGS.steps
    for state in at_once[::2]:
        assert same(plan_strip(resume=state), planned)


def noting(asked: list[Window]) -> PlanWindows:
    """Return `in_turn` that notes each window as it is asked for."""

    def noted(windows: Iterator[Window]) -> Iterator[Window]:
        for window in windows:
            asked.append(window)
            yield window

    return lambda planner, windows, watch: in_turn(planner, noted(windows), watch)


def test_a_window_is_made_when_it_is_asked_for_and_none_once_planning_is_to_end() -> None:
    asked: list[Window] = []

    def stop_in_second(progress: PlanProgress) -> bool:
        return len(asked) < 2

    plan_strip(noting(asked), stop_in_second)
    assert [window.index for window in asked] == [0, 2]


@pytest.mark.parametrize("arrange", [1.0, 0.5])
def test_a_window_is_arranged_as_far_as_the_whole(arrange: float) -> None:
    asked: list[Window] = []
    plan_strip(noting(asked), settings=replace(SETTINGS, arrange=arrange))
    assert {window.settings.arrange for window in asked} == {arrange}


@pytest.mark.parametrize(("paints", "is_ink"), [(1, False), (None, True)])
def test_a_window_draws_in_one_ink_where_the_whole_does_and_never_in_a_paint_mixed_alone(
    paints: int | None, is_ink: bool
) -> None:
    asked: list[Window] = []
    plan_strip(noting(asked), settings=replace(SETTINGS, paints=paints))
    assert {len(window.settings.palette) for window in asked} == {1}
    assert {window.settings.in_ink for window in asked} == {is_ink}


def test_a_mural_goes_on_from_no_other_plan(states: list[State], planned: PlanResult) -> None:
    other = {name: array for name, array in states[5].items() if name != "windows_done"}
    with pytest.raises(InputError, match="what there is to go on from is no plan of the same request; plan anew"):
        plan_strip(resume=other)


def most_memory(side: int) -> int:
    """Return the most memory, bytes, that NumPy has while a mural of `side` pixels each way is cut into its windows."""
    sheet, strokes = Sheet(width=side / 4000, height=side / 4000), side * side // 6400
    mural = Mural(np.full((60, 60, 3), 0.5, np.float32), sheet, Canvas(sheet.width, sheet.height, 4000))
    settings = PlannerSettings(strokes=strokes, exact=True, paints=None, steps=1)
    style = load_style("free", mural.canvas)
    tracemalloc.start()
    try:
        plan_mural(
            mural,
            (nominal("fineliner"),),
            style,
            settings,
            loss_options=TONE,
            window_px=200,
            plan_windows=unplanned,
        )
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_no_picture_of_all_of_a_mural_is_ever_in_memory() -> None:
    most_memory(400)  # what is loaded stays
    grown = most_memory(1600) - most_memory(800)
    assert grown < 1600 * 1600 * 3, "a quarter of one picture of the mural, in single precision"
