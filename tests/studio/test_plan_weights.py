"""Weights of a plan that are changed while it waits, is planned or has stopped, each planned in a real process."""

import asyncio
import json
from collections.abc import Callable

import pytest

from maulstick.painting.painting_file import read_painting
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.plan import Phase, Plan
from maulstick.studio.state.plans import Plans
from tests.studio.test_plans import REQUEST, folder, request_with, until

__all__ = ["folder"]


def test_what_matters_can_be_changed_while_it_is_planned(folder: Folder, held_at: Callable[..., None]) -> None:
    held_at(0.05, 0.3, 0.4)

    async def plan() -> Plan:
        plans = Plans(folder)
        plan = plans.add(REQUEST)
        await until(lambda: plan.seen > 1)
        assert set(plan.curve[-1][1]) == {"tone"}
        plans.weigh(plan, {"tone": 1.0, "edges": 1.0, "likeness": 0.5})
        await until(lambda: set(plan.curve[-1][1]) == {"tone", "edges", "likeness"})
        reached = plan.curve[-1][0]
        plans.weigh(plan, {"tone": 0.5})
        await until(lambda: set(plan.curve[-1][1]) == {"tone"})
        assert plan.curve[-1][0] >= min(reached, 0.5)
        plans.stop(plan)
        await until(lambda: not plan.is_busy)
        await until(lambda: not plans._processes)
        return plan

    made = asyncio.run(plan())
    assert made.request.options.weights == {"tone": 0.5}
    assert json.loads((made.folder / "request.json").read_bytes())["options"]["weights"] == {"tone": 0.5}
    assert read_painting(made.folder / "painting.json").provenance.options["weights"] == {"tone": 0.5}


def test_what_matters_late_in_a_plan_lets_it_go_back_some_steps(folder: Folder, held_at: Callable[..., None]) -> None:
    held_at(0.8)

    async def plan() -> tuple[Plan, list[float]]:
        plans, seen = Plans(folder), list[float]()
        plan = plans.add(REQUEST)
        await until(lambda: plan.done > 0.75)
        plan.stepped.subscribe(lambda: seen.append(plan.done))
        plans.weigh(plan, {"tone": 0.5})
        await until(lambda: not plan.is_busy and not plans._processes)
        return plan, seen

    made, seen = asyncio.run(plan())
    assert (made.phase, made.why) == (Phase.PLANNED, "")
    assert 0.5 <= min(seen) < 0.75
    shares = [done for done, _ in made.curve]
    assert shares == sorted(shares)


def test_a_plan_that_goes_on_with_other_weights_than_it_stopped_with_goes_back_some_steps(
    folder: Folder, held_at: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("maulstick.studio.state.plans._AT_ONCE", 1)
    held_at(0.8)

    async def plan() -> tuple[Plan, list[float]]:
        plans, seen = Plans(folder), list[float]()
        plan = plans.add(REQUEST)
        await until(lambda: plan.done > 0.75)
        plans.stop(plan)
        await until(lambda: not plan.is_busy and not plans._processes)
        other = plans.add(REQUEST)
        plans.go_on(plan)
        assert plan.phase is Phase.WAITING
        plans.weigh(plan, {"tone": 0.5})
        plans.stop(other)
        plan.stepped.subscribe(lambda: seen.append(plan.done))
        await until(lambda: not plan.is_busy and not plans._processes)
        return plan, seen

    made, seen = asyncio.run(plan())
    assert (made.phase, made.why) == (Phase.PLANNED, "")
    assert min(seen) < 0.75


def test_a_plan_tells_the_weights_that_it_was_made_with_even_where_others_came_too_late(folder: Folder) -> None:
    async def plan() -> Plan:
        plans = Plans(folder)
        plan = plans.add(request_with(steps=2000))
        await until(lambda: plan.seen > 1)
        plans.weigh(plan, {"tone": 0.5})
        plans.stop(plan)
        await until(lambda: not plan.is_busy and not plans._processes)
        return plan

    made = asyncio.run(plan())
    used = read_painting(made.folder / "painting.json").provenance.options["weights"]
    assert made.request.options.weights == used
    assert json.loads((made.folder / "request.json").read_bytes())["options"]["weights"] == used


def test_a_plan_that_waits_begins_with_the_weights_that_it_was_given_meanwhile(
    folder: Folder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("maulstick.studio.state.plans._AT_ONCE", 1)

    async def plan() -> Plan:
        plans = Plans(folder)
        first = plans.add(request_with(steps=400))
        last = plans.add(REQUEST)
        assert last.phase is Phase.WAITING
        plans.weigh(last, {"tone": 0.5})
        plans.stop(first)
        await until(lambda: not plans._processes and not plans.doing)
        return last

    made = asyncio.run(plan())
    assert read_painting(made.folder / "painting.json").provenance.options["weights"] == {"tone": 0.5}
