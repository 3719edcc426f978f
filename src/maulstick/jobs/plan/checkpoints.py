"""Checkpoints: a plan that keeps a file to go on from, and whose weights can be changed on the way."""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from maulstick.jobs.plan.prepared import Prepared
from maulstick.jobs.plan.request import PlanRequest, state_file
from maulstick.painting.painting import Painting
from maulstick.planning.result import PlanProgress
from maulstick.planning.state import State, read_state, set_back, write_state

_EVERY = 15.0  # least seconds between two checkpoints: at most so much work is lost
_SHARE = 20  # least time between two checkpoints, in times that writing one takes: at most 5 % go into writing

Watch = Callable[[PlanProgress], bool]


class _Reweighed(Exception):  # noqa: N818  nothing is wrong
    """Signal that the plan is to go on from this state with these weights."""

    def __init__(self, weights: Mapping[str, float], state: State) -> None:
        self.weights, self.state = weights, state


def plan_with(
    prepared: Prepared,
    out: Path,
    request: PlanRequest,
    watch: Watch,
    reweighed: Callable[[], Mapping[str, float] | None] = lambda: None,
) -> Painting:
    """Return a planned painting; go on with the plan in its file in the folder `out`, if there is one.

    The file, which also holds the request, stays. Once `watch` returns False it is no longer written, so that going on
    from there does not hurry.
    reweighed: called after every step; returns new weights of the terms to go on with, or None. Late in a plan it goes
    back by some of its steps, so that strokes have time to follow; a mural goes on from where it is.
    Raises InputError for weights that cannot be used.
    """
    file = state_file(out, prepared.settings.seed)
    state = _state_in(file, prepared, request) if file.is_file() else None
    due, going = time.monotonic() + _EVERY, True

    def keep(progress: PlanProgress) -> bool:
        nonlocal due, going
        wanted = watch(progress)
        if going and (not wanted or time.monotonic() > due):
            started = time.monotonic()
            write_state(file, progress.state(), request.as_json())
            written = time.monotonic()
            due = written + max(_EVERY, _SHARE * (written - started))
        going = going and wanted
        if wanted and (weights := reweighed()) is not None:
            raise _Reweighed(weights, progress.state())
        return wanted

    while True:
        try:
            planned = prepared.plan(keep, state)
            break
        except _Reweighed as change:
            state, prepared = _set_back(change.state, prepared), prepared.weighed(change.weights)
            request = replace(request, options=replace(request.options, weights=dict(change.weights)))
    return prepared.painting(planned)


def _state_in(file: Path, prepared: Prepared, request: PlanRequest) -> State:
    """Return the state in a file; its request may be of before the weights were changed."""
    state, before = read_state(file)
    weights = PlanRequest.from_json(before, file).options.weights
    return state if weights == request.options.weights else _set_back(state, prepared)


def _set_back(state: State, prepared: Prepared) -> State:
    """Return a state from which strokes can follow other weights; windows of a mural go on from where they are."""
    return state if prepared.mural is not None else set_back(state)
