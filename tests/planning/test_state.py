import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from maulstick.errors import InputError
from maulstick.jobs.plan.request import MOST_WORKERS
from maulstick.painting.brush import Brush
from maulstick.planning.initialise import Initialiser
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem, Weighted
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.state import _LARGEST, KIND, State, read_state, set_back, write_state
from maulstick.storage.arrays import Image as Picture
from maulstick.storage.arrays import read_arrays, write_arrays
from tests.planning.conftest import options, problem_for
from tests.support.planning.network_losses import Shifted


class PowerCutError(Exception):
    """A power cut in the middle of planning."""


def same(one: PlanResult, two: PlanResult) -> bool:
    """Return whether two plans are equal to the bit."""
    pairs = [(one.paints, two.paints), (one.paint_of, two.paint_of)]
    pairs += [(tensor, two.strokes.each()[name]) for name, tensor in one.strokes.each().items()]
    return all(torch.equal(a, b) for a, b in pairs)


def killed_after(steps: int, file: Path) -> Callable[[PlanProgress], bool]:
    taken = [0]

    def watch(progress: PlanProgress) -> bool:
        taken[0] += 1
        if taken[0] == steps:
            write_state(file, progress.state(), {"strokes": 3})
        if taken[0] > steps + 2:  # what was done after the file was written is lost
            raise PowerCutError
        return True

    return watch


def resumed(problem: PlanningProblem, settings: PlannerSettings, steps: int, file: Path) -> PlanResult:
    with pytest.raises(PowerCutError):
        plan(problem, settings, killed_after(steps, file))
    state, request = read_state(file)
    assert request == {"strokes": 3}
    return plan(problem, settings, resume=state)


@pytest.fixture(scope="module")
def problem(portrait: Picture, round_brush: Brush) -> PlanningProblem:
    return problem_for(portrait, round_brush)


@pytest.mark.parametrize("steps", [1, 20, 35, 37])
@pytest.mark.parametrize("paints", [4, None])
def test_a_plan_goes_on_from_its_file_as_if_it_had_not_stopped(
    problem: PlanningProblem, steps: int, paints: int | None, tmp_path: Path
) -> None:
    settings = options(steps=40, paints=paints)
    assert same(resumed(problem, settings, steps, tmp_path / "plan.npz"), plan(problem, settings))


def test_a_plan_that_goes_on_looks_for_no_strokes_to_begin_with(
    problem: PlanningProblem, monkeypatch: pytest.MonkeyPatch
) -> None:
    states: list[State] = []

    def note(progress: PlanProgress) -> bool:
        states.append(progress.state())
        return True

    whole = plan(problem, options(steps=40), note)
    monkeypatch.delattr(Initialiser, "first")
    assert same(plan(problem, options(steps=40), resume=states[20]), whole)


def test_a_plan_of_an_older_file_without_what_is_kept_now_goes_on(problem: PlanningProblem) -> None:
    states: list[State] = []

    def note(progress: PlanProgress) -> bool:
        states.append(progress.state())
        return True

    whole = plan(problem, options(steps=40), note)
    older = {name: array for name, array in states[30].items() if name not in ("spacing", "usual_stride")}
    assert same(plan(problem, options(steps=40), resume=older), whole)
    assert np.array_equal(set_back(older)["progress"], set_back(states[30])["progress"])


@pytest.mark.parametrize("steps", [3, 30])
def test_the_last_values_of_network_losses_are_kept(problem: PlanningProblem, steps: int, tmp_path: Path) -> None:
    assert problem.target is not None
    with_losses = replace(problem, network_losses=(Weighted(Shifted(problem.target), 0.5),))
    settings = options(steps=40, ask_every=6)
    whole = plan(with_losses, settings)
    assert same(resumed(with_losses, settings, steps, tmp_path / "plan.npz"), whole)
    assert not same(plan(problem, settings), whole)


def test_a_plan_that_was_to_end_early_still_does(problem: PlanningProblem) -> None:
    states: list[State] = []

    def hurry(progress: PlanProgress) -> bool:
        states.append(progress.state())
        return len(states) < 10

    settings = options(steps=400)
    whole = plan(problem, settings, hurry)
    assert len(states) < 100
    assert same(plan(problem, settings, resume=states[20]), whole)


def test_a_file_that_is_no_plan_in_the_making_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "plan.npz"
    file.write_bytes(b"PK\x03\x04 cut")
    with pytest.raises(InputError, match="is not a file of plan in the making, or it is damaged"):
        read_state(file)
    write_arrays(file, KIND, {"codes": np.zeros((3, 2))})
    with pytest.raises(InputError, match="plan in the making, or it is damaged; plan anew"):
        read_state(file)
    write_arrays(file, "ink", {})
    with pytest.raises(InputError, match="holds ink"):
        read_state(file)


def test_a_state_of_another_plan_is_refused_and_one_s_own_is_not_changed(problem: PlanningProblem) -> None:
    states: list[State] = []

    def note(progress: PlanProgress) -> bool:
        states.append(progress.state())
        return True

    settings = options(steps=20)
    whole = plan(problem, settings, note)
    before = {name: array.copy() for name, array in states[15].items()}
    assert same(plan(problem, settings, resume=states[15]), whole)
    for name, array in before.items():
        assert np.array_equal(array, states[15][name]), name
    with pytest.raises(InputError, match="is no plan of the same request; plan anew"):
        plan(problem, options(steps=20, strokes=29), resume=states[15])
    with pytest.raises(InputError, match="is no plan of the same request; plan anew"):
        plan(problem, settings, resume={"progress": states[15]["progress"]})


def test_what_windows_in_work_keep_may_be_larger_than_other_files_but_not_any_size(tmp_path: Path) -> None:
    path = tmp_path / "plan.npz"
    write_state(path, {"slope": np.zeros(8)}, {})
    content = bytearray(path.read_bytes())
    place = content.index(b"PK\x01\x02", content.index(b"slope.npy", content.index(b"PK\x01\x02")) - 46)
    content[place + 24 : place + 28] = struct.pack("<I", 3 * 2**30)  # the size that the directory states
    path.write_bytes(content)
    assert read_state(path)[0]["slope"].tolist() == [0.0] * 8
    with pytest.raises(InputError, match="unpacks to 3072 MiB; no leaves is that large"):
        read_arrays(path, "leaves")
    assert 2**31 < 2 * 3 * 4 * 6144**2 * MOST_WORKERS < _LARGEST
