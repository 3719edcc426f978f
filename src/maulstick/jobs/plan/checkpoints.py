"""A plan that keeps a file to go on from, and whose weights can be changed on the way."""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from maulstick.jobs.plan.prepare import Prepared
from maulstick.jobs.plan.request import PlanRequest, state_file
from maulstick.painting.painting import Painting
from maulstick.planning.from_picture import as_painting, with_metrics
from maulstick.planning.planner import PlanProgress
from maulstick.planning.state import State, read_state, write_state

_EVERY = 15.0  # seconds between two states on the disk, at least
_SHARE = 20  # times as long as writing one takes

Watch = Callable[[PlanProgress], bool]


class _Reweighed(Exception):  # noqa: N818  nothing is wrong
    """The plan is to go on from this state with these weights."""

    def __init__(self, weights: Mapping[str, float], state: State) -> None:
        self.weights, self.state = weights, state


def plan_with(
    prepared: Prepared,
    out: Path,
    asked: PlanRequest,
    watch: Watch,
    reweighed: Callable[[], Mapping[str, float] | None] = lambda: None,
) -> Painting:
    """Plan, or go on with the plan that its file in the folder `out` holds; the file, which says what was asked, stays.

    Once `watch` returns False the file is left as it is, so that going on from there does not hurry.
    reweighed: asked after every step for other weights of the terms, by which planning goes on; None as before.
    Raises InputError for weights that cannot be.
    """
    file = state_file(out, prepared.settings.seed)
    state = read_state(file)[0] if file.is_file() else None
    due, going = time.monotonic() + _EVERY, True

    def keep(progress: PlanProgress) -> bool:
        nonlocal due, going
        wanted = watch(progress)
        if going and (not wanted or time.monotonic() > due):
            started = time.monotonic()
            write_state(file, progress.state(), asked.as_json())
            taken = time.monotonic() - started
            due = time.monotonic() + max(_EVERY, _SHARE * taken)
        going = going and wanted
        if wanted and (weights := reweighed()) is not None:
            raise _Reweighed(weights, progress.state())
        return wanted

    while True:
        try:
            planned = prepared.plan(keep, state)
            break
        except _Reweighed as change:
            prepared, state = prepared.weighed(change.weights), change.state
            asked = replace(asked, options=replace(asked.options, weights=dict(change.weights)))
    painting = as_painting(
        planned, prepared.layout, prepared.brush, prepared.style, prepared.provenance, prepared.names
    )
    return with_metrics(painting, prepared.layout, prepared.problem)
