"""Plans whose picture or hand changes before they go on, and plans in the trash whose picture is thrown away."""

import asyncio
import json
from dataclasses import replace
from pathlib import Path

import pytest

from maulstick.errors import InputError
from maulstick.jobs.plan.request import PlanRequest, state_file
from maulstick.storage.files import file_sum
from maulstick.studio.state.plan import Phase
from maulstick.studio.workers.unchanged import check_or_keep_sums
from tests.studio.test_own_pictures import opened, put_picture
from tests.studio.test_plans import LONG, OPTIONS, until

pytestmark = pytest.mark.usefixtures("data")
CHANGED = "the picture has changed since planning began; put it back, or “Plan again like this”"


def test_a_plan_whose_picture_has_changed_does_not_go_on_and_its_card_says_why(tmp_path: Path) -> None:
    (tmp_path / "studio").mkdir()
    picture = put_picture(tmp_path, "cat", 1)
    before = picture.read_bytes()

    async def go_on() -> list[tuple[Phase, str]]:
        found = list[tuple[Phase, str]]()
        async with opened(tmp_path) as studio:
            plan = studio.plans.add(PlanRequest(picture, replace(OPTIONS, steps=LONG)))
            await until(lambda: plan.seen > 0)
            studio.plans.stop(plan)
            await until(lambda: not plan.is_busy)
            for content in (put_picture(tmp_path, "dog", 2).read_bytes(), before):
                picture.write_bytes(content)
                seen = plan.seen
                studio.plans.go_on(plan)
                await until(lambda seen=seen: plan.seen > seen or not plan.is_busy)
                studio.plans.stop(plan)
                await until(lambda: not plan.is_busy)
                found.append((plan.phase, plan.why))
        return found

    assert asyncio.run(go_on()) == [(Phase.FAILED, CHANGED), (Phase.STOPPED, "")]


def test_what_changed_is_named_and_nothing_is_compared_before_a_plan_is_begun(tmp_path: Path) -> None:
    picture, moved = tmp_path / "here" / "picture.png", tmp_path / "there" / "picture.png"
    sums = {str(picture): "1", "the brush": "2", "the style": "3"}
    request = PlanRequest(picture, replace(OPTIONS), sums=sums)
    check_or_keep_sums(replace(request, sums={**sums, "the brush": "0"}), tmp_path, is_begun=False)
    check_or_keep_sums(request, tmp_path, is_begun=False)
    state_file(tmp_path, 0).touch()
    check_or_keep_sums(request, tmp_path, is_begun=False)
    check_or_keep_sums(PlanRequest(moved, sums={**sums, str(moved): "1"}), tmp_path, is_begun=True)
    for name in ("the brush", "the style"):
        with pytest.raises(InputError, match=f"^{name} has changed"):
            check_or_keep_sums(replace(request, sums={**sums, name: "0"}), tmp_path, is_begun=False)
    state_file(tmp_path, 0).unlink()
    with pytest.raises(InputError, match=r"^the picture has changed"):  # since an earlier try, which is over
        check_or_keep_sums(replace(request, sums={**sums, str(picture): "0"}), tmp_path, is_begun=True)
    (tmp_path / "sums.json").unlink()
    check_or_keep_sums(request, tmp_path, is_begun=True)  # a plan of an earlier Maulstick


def test_a_plan_comes_back_from_the_trash_with_its_picture_that_was_thrown_away_after_it(tmp_path: Path) -> None:
    (tmp_path / "studio").mkdir()
    picture = put_picture(tmp_path, "cat", 1)
    first = file_sum(picture)

    async def put_back() -> Path | None:
        async with opened(tmp_path) as studio:
            plan = studio.plans.add(PlanRequest(picture, OPTIONS))
            studio.plans.stop(plan)
            await until(lambda: not plan.is_busy)
            studio.plans.throw_away(plan)
            broken = tmp_path / "studio" / "trash" / "1-00000000" / "broken"
            broken.mkdir(parents=True)
            (broken / "request.json").write_text(json.dumps({"picture": 3}))
            studio.throw_picture_away("cat")
            put_picture(tmp_path, "cat", 2)
            thing = next(thing for thing in studio.trash.things() if thing.where == "plans")
            studio.trash.put_back(thing, studio.trash.free_name(thing))
            return studio.plans.of("cat").picture

    kept = asyncio.run(put_back())
    assert kept is not None
    assert file_sum(kept) == first
