"""Several tries of one plan, the best of which is kept, each made in a real process."""

import asyncio
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from maulstick.jobs.plan.request import state_files
from maulstick.painting.painting_file import read_painting
from maulstick.studio.panels.plan.card import outcome
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.plan import Phase, Plan
from maulstick.studio.state.plans import Plans
from tests.studio.test_plans import OPTIONS, REQUEST, folder, request_with, until

__all__ = ["folder"]


def loss_of(plan: Plan) -> float:
    return read_painting(plan.folder / "painting.json").provenance.metrics["loss"]


def test_of_several_tries_the_best_is_kept_and_it_says_which_one_is_made(folder: Folder) -> None:
    async def plan() -> tuple[Plan, list[Plan], set[int]]:
        plans, seen = Plans(folder), set[int]()
        tried = plans.add(replace(REQUEST, tries=2))
        tried.stepped.subscribe(lambda: seen.add(tried.attempt))
        alone = [plans.add(request_with(seed=seed)) for seed in range(2)]
        await until(lambda: not plans._processes and not plans.doing)
        return tried, alone, seen

    tried, alone, seen = asyncio.run(plan())
    assert [each.phase for each in (tried, *alone)] == [Phase.PLANNED] * 3, tried.why
    assert loss_of(tried) == pytest.approx(min(map(loss_of, alone)))
    assert loss_of(alone[0]) != pytest.approx(loss_of(alone[1]))
    assert read_painting(tried.folder / "painting.json").provenance.options["tries"] == 2
    assert seen == {1, 2}
    assert [done for done, _ in tried.curve] == sorted(done for done, _ in tried.curve)
    assert not [*state_files(tried.folder), *tried.folder.glob("try-*")]


def test_tries_that_are_stopped_keep_those_that_are_over_and_go_on_with_the_next(
    folder: Folder, held_at: Callable[..., None]
) -> None:
    held_at(0.6)

    async def stop() -> Plan:
        plans = Plans(folder)
        plan = plans.add(replace(REQUEST, tries=2))
        await until(lambda: plan.attempt == 2)
        assert outcome(plan).startswith(f"{plan.done:.0%}, try 2 of 2")
        plans.stop(plan)
        await until(lambda: not plan.is_busy and not plans._processes)
        return plan

    stopped = asyncio.run(stop())
    assert (stopped.phase, stopped.is_painting) == (Phase.STOPPED, True), stopped.why
    assert [path.name for path in stopped.folder.glob("try-*")] == ["try-0.json"]
    first = read_painting(stopped.folder / "try-0.json")
    assert loss_of(stopped) <= first.provenance.metrics["loss"]

    async def go_on() -> tuple[Plan, list[int]]:
        plans, seen = Plans(folder), list[int]()
        plan = plans.of(stopped.name)
        plan.stepped.subscribe(lambda: seen.append(plan.attempt) if plan.seen else None)
        plans.go_on(plan)
        await until(lambda: not plan.is_busy and not plans._processes)
        return plan, seen

    again, seen = asyncio.run(go_on())
    assert again.phase is Phase.PLANNED, again.why
    assert {*seen} <= {2}
    assert not [*state_files(again.folder), *again.folder.glob("try-*")]


def test_weights_stay_while_tries_are_compared(folder: Folder, held_at: Callable[..., None]) -> None:
    held_at(0.0)

    async def weigh() -> Plan:
        plans = Plans(folder)
        plan = plans.add(replace(REQUEST, tries=2))
        await until(lambda: plan.seen > 0)
        plans.weigh(plan, {"edges": 1.0})
        assert plan.request.options.weights == OPTIONS.weights
        plans.stop(plan)
        await until(lambda: not plan.is_busy and not plans._processes)
        return plan

    stopped = asyncio.run(weigh())
    assert stopped.request.options.weights == OPTIONS.weights
    assert Path(stopped.folder / "painting.json").is_file()
