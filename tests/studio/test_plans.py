"""Plans as the studio's server has them, each made in a real process."""

import asyncio
import shutil
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from multiprocessing import active_children
from pathlib import Path
from typing import Any

import pytest
from skimage.data import data_dir

from maulstick.errors import InputError
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.request import PlanRequest, demo_picture
from maulstick.painting.painting_file import read_painting
from maulstick.robot.journal import Journal, journal_of
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.gallery import keep_picture, picture_of
from maulstick.studio.state.plan import Phase, Plan
from maulstick.studio.state.plans import Plans
from maulstick.studio.workers.planner import TARGET, order_frame
from tests.support.robot.small_paintings import SIX
from tests.support.studio.plans_to_paint import put_plan

_PATIENCE = 240.0  # seconds: plans run at a low priority, and wait where a machine does much else
LONG = 100_000  # steps, more than a test waits for
OPTIONS = PlanOptions(weights={"tone": 1.0}, size="80x80mm", strokes=20, paints=3, steps=20, px=48)
REQUEST = PlanRequest(Path(data_dir) / "astronaut.png", OPTIONS)


def request_with(**changes: Any) -> PlanRequest:
    return replace(REQUEST, options=replace(OPTIONS, **changes))


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Folder]:
    with Folder.opened(tmp_path / "studio") as opened:
        yield opened


async def until(condition: Callable[[], bool]) -> None:
    async with asyncio.timeout(_PATIENCE):
        while not condition():
            await asyncio.sleep(0.02)


def test_a_plan_becomes_a_painting_with_all_that_the_page_shows_of_it(folder: Folder) -> None:
    async def plan() -> Plan:
        plans = Plans(folder)
        plan = plans.add(REQUEST)
        assert plans.doing == "planning data"
        await until(lambda: not plan.is_busy)
        await until(lambda: not plans.doing)
        return plan

    made = asyncio.run(plan())
    assert (made.phase, made.why) == (Phase.PLANNED, "")
    painting = read_painting(made.folder / "painting.json")
    assert f"{len(painting.strokes)} strokes" in made.metrics
    assert made.canvas.startswith(b"\xff\xd8")
    assert (made.folder / TARGET).is_file()
    assert made.frames == len(painting.strokes) + 1
    assert order_frame(made.folder, 0).is_file()
    assert [done for done, _ in made.curve] == sorted(done for done, _ in made.curve)


def test_a_plan_is_made_by_the_process_that_was_ready_for_it_and_as_it_is_without(folder: Folder) -> None:
    async def made(*, ready: bool) -> bytes:
        plans, others = Plans(folder), {child.pid for child in active_children()}
        if ready:
            plans.be_ready()
        waiting = {child.pid for child in active_children()} - others
        plan = plans.add(REQUEST)
        begun = {child.pid for child in active_children()} - others - waiting
        assert (len(waiting), len(begun)) == ((1, 0) if ready else (0, 1))
        await until(lambda: not plan.is_busy and not plans.doing)
        assert plan.phase is Phase.PLANNED, plan.why
        return (plan.folder / "painting.json").read_bytes()

    assert asyncio.run(made(ready=True)) == asyncio.run(made(ready=False))


def test_what_may_be_unexpected_of_a_plan_is_said_while_it_is_made_and_in_a_studio_opened_later(folder: Folder) -> None:
    request = request_with(ink="black", paints=None, style="elephant", brush="fineliner")

    async def plan() -> tuple[list[tuple[Phase, tuple[str, ...]]], Plan]:
        plans, said = Plans(folder), list[tuple[Phase, tuple[str, ...]]]()
        plan = plans.add(request)
        plan.stepped.subscribe(lambda: said.append((plan.phase, plan.notes)))
        await until(lambda: not plan.is_busy)
        await until(lambda: not plans._processes)
        return said, plan

    said, made = asyncio.run(plan())
    notes = tuple(prepare(request).notes)
    assert notes[0].startswith("20 strokes of this length give")
    assert said[0] == (Phase.PLANNING, notes)
    assert made.notes == notes
    assert Plans(folder).of(made.name).notes == notes


def test_a_plan_of_which_no_stroke_is_left_says_so_in_a_studio_opened_later_too(folder: Folder) -> None:
    async def plan() -> Plan:
        plans = Plans(folder)
        plan = plans.add(request_with(ink="white", paints=None, style="elephant", brush="fineliner"))
        await until(lambda: not plan.is_busy and not plans.doing)
        return plan

    made = asyncio.run(plan())
    assert made.phase is Phase.PLANNED, made.why
    assert made.notes[-1].startswith("no stroke is left, for none brings the sheet nearer")
    assert Plans(folder).of(made.name).notes == made.notes


def test_a_plan_that_is_stopped_keeps_what_there_is_and_goes_on_in_a_studio_opened_later(folder: Folder) -> None:
    async def stop() -> Plan:
        plans = Plans(folder)
        plan = plans.add(request_with(steps=LONG))
        await until(lambda: plan.seen > 1)
        plans.stop(plan)
        assert plan.phase is Phase.STOPPING
        await until(lambda: not plan.is_busy)
        await until(lambda: not plans._processes)
        return plan

    stopped = asyncio.run(stop())
    assert stopped.phase is Phase.STOPPED
    assert stopped.curve[-1][0] > 0
    assert stopped.is_painting

    async def go_on() -> tuple[list[tuple[float, Mapping[str, float]]], Plan]:
        plans = Plans(folder)
        (plan,) = plans.plans.values()
        assert (plan.phase, plan.metrics) == (Phase.STOPPED, stopped.metrics)
        plans.go_on(plan)
        await until(lambda: plan.seen > 0)
        curve = plan.curve
        plans.close()
        await until(lambda: not plan.is_busy)
        return curve, plan

    curve, again = asyncio.run(go_on())
    assert [done for done, _ in curve] == sorted({done for done, _ in curve})
    assert curve[0] == stopped.curve[0], "the first part of the curve stays"
    assert again.phase is Phase.STOPPED


def test_a_plan_that_was_painted_or_rehearsed_does_not_go_on(folder: Folder) -> None:
    file = put_plan(folder.root, "six", SIX)
    (file.parent / "plan-0.npz").touch()  # as of one that was stopped
    with Journal.open(journal_of(file)) as journal:
        journal.revise(file, [])
    plans = Plans(folder)
    plan = plans.of("six")
    assert plan.phase is Phase.STOPPED
    with pytest.raises(InputError, match="six was begun on paper, or rehearsed, so its strokes must stay; plan the"):
        plans.go_on(plan)
    assert plan.phase is Phase.STOPPED


def test_a_plan_goes_on_in_a_studio_that_was_moved(tmp_path: Path) -> None:
    here, there = tmp_path / "studio", tmp_path / "elsewhere" / "Ateliê"

    async def stop(folder: Folder) -> None:
        plans = Plans(folder)
        plan = plans.add(replace(request_with(steps=LONG), picture=picture_of(folder.of("pictures", "cat"))))
        await until(lambda: plan.seen > 0)
        plans.close()

    async def go_on(folder: Folder) -> Plan:
        plans = Plans(folder)
        (plan,) = plans.plans.values()
        assert plan.request.picture == picture_of(folder.of("pictures", "cat"))
        plans.go_on(plan)
        await until(lambda: plan.seen > 0)
        plans.stop(plan)
        await until(lambda: not plan.is_busy)
        return plan

    with Folder.opened(here) as folder:
        keep_picture(demo_picture(), folder.of("pictures", "cat"))
        asyncio.run(stop(folder))
    there.parent.mkdir()
    here.rename(there)
    with Folder.opened(there) as folder:
        plan = asyncio.run(go_on(folder))
    assert plan.why == ""
    assert plan.is_painting


def test_a_plan_that_cannot_be_says_why_and_can_be_thrown_away_and_taken_back(folder: Folder) -> None:
    async def fail() -> None:
        plans = Plans(folder)
        plan = plans.add(request_with(style="nobody"))
        with pytest.raises(InputError, match="data is being planned; stop it first"):
            plans.throw_away(plan)
        await until(lambda: not plan.is_busy)
        assert plan.phase is Phase.FAILED
        assert plan.why.startswith("there is no style 'nobody'; there are: ")
        trashed = plans.throw_away(plan)
        assert not plans.plans
        with pytest.raises(InputError, match="there is no plan data any more"):
            plans.of("data")
        plans.take_back(trashed)
        assert plans.of("data").folder.is_dir()
        await until(lambda: not plans._processes)

    asyncio.run(fail())


def test_plans_take_turns_and_one_that_waits_can_be_taken_out(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("maulstick.studio.state.plans._AT_ONCE", 1)

    async def wait() -> None:
        plans = Plans(folder)
        first, second, third = (plans.add(REQUEST) for _ in range(3))
        assert [plan.phase for plan in (first, second, third)] == [Phase.PLANNING, Phase.WAITING, Phase.WAITING]
        assert [plan.name for plan in (first, second, third)] == ["data", "data-2", "data-3"]
        assert plans.doing == "planning 3 pictures"
        plans.stop(second)
        assert second.phase is Phase.STOPPED
        await until(lambda: not third.is_busy)
        assert third.phase is Phase.PLANNED
        assert not second.is_painting
        await until(lambda: not plans._processes)

    asyncio.run(wait())


def test_a_folder_that_holds_no_plan_of_this_version_is_passed_over(folder: Folder) -> None:
    for name, content in (("empty", None), ("broken", b"{"), ("other", b'{"photo": 3}')):
        (folder.root / "plans" / name).mkdir()
        if content is not None:
            (folder.root / "plans" / name / "request.json").write_bytes(content)
    assert Plans(folder).plans == {}


def test_a_plan_comes_and_goes_with_its_folder_while_the_studio_is_open(folder: Folder) -> None:
    for name in ("lines", "six"):
        put_plan(folder.root, name)
    plans = Plans(folder)
    changes: list[list[str]] = []
    plans.changed.subscribe(lambda: changes.append(sorted(plans.plans)))
    lines = plans.of("lines")
    shutil.rmtree(folder.root / "plans" / "six")
    shutil.copytree(lines.folder, folder.root / "plans" / "copy")
    for _ in range(2):
        plans.look_again()
    assert changes == [["copy", "lines"]]
    assert plans.of("lines") is lines
    with pytest.raises(InputError, match="there is no plan six any more"):
        plans.of("six")


def test_a_plan_that_was_taken_out_of_the_trash_stays_the_last(folder: Folder) -> None:
    for name in ("six", "lines"):
        put_plan(folder.root, name)
    plans = Plans(folder)
    first, last = plans.plans
    plans.take_back(plans.throw_away(plans.of(first)))
    plans.look_again()
    assert [*plans.plans] == [last, first]


def test_a_plan_whose_files_were_still_on_their_way_is_finished_once_they_are_there(folder: Folder) -> None:
    put_plan(folder.root, "six")
    painting = folder.root / "plans" / "six" / "painting.json"
    painting.rename(aside := painting.with_name("painting.part"))
    plans = Plans(folder)
    changes: list[Phase] = []
    plans.changed.subscribe(lambda: changes.append(plans.of("six").phase))
    assert plans.of("six").phase is Phase.STOPPED
    aside.rename(painting)
    for _ in range(2):
        plans.look_again()
    assert changes == [Phase.PLANNED]
