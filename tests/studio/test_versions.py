"""Versions of a plan: what they are planned with, what they keep, and what is said of them."""

import asyncio
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from maulstick.errors import InputError
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.robot.journal import Journal, journal_of
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.plan import Phase, Plan
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.version_words import version_in_words
from maulstick.studio.state.versions import Around, changes_in, painted_of, without_own_places
from maulstick.studio.state.weighing import weights_of
from maulstick.studio.workers.planner import TARGET
from maulstick.studio.workers.said import Said, SaidGuide
from maulstick.studio.workers.said_files import GUIDES, MAP, SAID_FILE, SAY
from maulstick.studio.workers.stroke_changes import StrokeChanges, changes_of
from tests.studio.test_plans import until
from tests.support.robot.small_paintings import SIX
from tests.support.studio.plans_to_paint import put_plan, put_plan_to_direct
from tests.support.studio.said_regions import box, region

_SQUARE = [0.01, 0.01, 0.03, 0.01, 0.03, 0.03, 0.01, 0.03]


def test_what_differs_in_a_version_is_said_in_words(tmp_path: Path) -> None:
    file = put_plan(tmp_path, "six", SIX)
    edits = (
        {"kind": "lock", "strokes": [10, 14]},
        {"kind": "remove", "strokes": [11]},
        {"kind": "move", "strokes": [12], "by": [0.001, 0]},
        {"kind": "repaint", "strokes": [13], "paint": 1 - SIX.strokes[3].paint},
        {"kind": "add", "paint": 0, "trajectory": [[0.01, 0.01, 0.5], [0.02, 0.01, 0.5]]},
    )
    strokes = changes_of(file, tuple(map(json.dumps, edits)))
    assert strokes == StrokeChanges(drawn=1, removed=1, moved=1, repainted=1, locked=2, left=6)
    sky, face = region(1, box(0, 0, 1, 1), name="sky"), region(2, box(0, 0, 1, 1), name="face", style="loops")
    before = Said(regions=(sky,))
    now = Said(
        regions=(face, region(3, box(0, 0, 1, 1), name="paper", bare=True), region(4, box(0, 0, 1, 1), importance=3)),
        guides=(SaidGuide(id=9, line=((0, 0), (1, 1))),),
    )
    assert version_in_words(
        StrokeChanges(drawn=12, removed=3, moved=1), before, now, {"loops": "Loops"}, "planned again"
    ) == (
        "3 strokes taken out, 12 drawn, 1 moved; a region “face” in Loops; bare paper “paper”; a region “region 4”, "
        "counts 3 times; region “sky” taken out; 1 guide; planned again."
    )
    assert version_in_words(StrokeChanges(), now, now, {}, "kept as it is") == "Kept as it is."
    assert version_in_words(StrokeChanges(locked=1), Said(), Said(), {}, "planned again") == (
        "1 stroke locked; planned again."
    )


def test_a_version_is_planned_with_what_is_said_and_begins_with_it_or_keeps_the_painting_as_it_is(
    tmp_path: Path,
) -> None:
    file = put_plan_to_direct(tmp_path, "coast")
    planned = read_painting(file)

    async def act() -> list[Plan]:
        with Folder.opened(tmp_path) as folder:
            studio = Studio(folder)
            try:
                first = studio.directing("coast")
                as_planned = await studio.version_of("coast", is_kept=True)
                await first.saying.enclose([0, 0, 0.06, 0, 0.06, 0.06, 0, 0.06], bare=True)
                bare = await studio.version_of("coast")
                await until(lambda: not (as_planned.is_busy or bare.is_busy))
                assert "leaves all of the sheet bare" in bare.why
                assert read_painting(as_planned.folder / "painting.json") == planned
                await first.undo()
                await first.saying.enclose(_SQUARE, bare=False)
                await first.saying.enclose(_SQUARE, bare=True)
                await first.saying.guide([0.005, 0.05, 0.055, 0.05])
                await first.edit({"kind": "remove", "strokes": [planned.strokes[0].id]})
                again = await studio.version_of("coast")
                await until(lambda: not again.is_busy)
                assert again.why == ""
                assert await studio.mixing.missing(again.name) == [], "the paints that were mixed are the same"
                second = studio.directing(again.name)
                assert second.saying.now == first.saying.now
                for region in second.saying.now.regions:
                    await second.saying.take_out(region.id)
                kept = await studio.version_of(again.name, is_kept=True)
                await until(lambda: not kept.is_busy)
            finally:
                await studio.close()
        return [again, kept]

    again, kept = asyncio.run(act())
    options = again.request.options
    assert (options.regions, options.say, options.guides) == tuple(again.folder / name for name in (MAP, SAY, GUIDES))
    assert changes_in(again.folder, {}) == (
        "1 stroke taken out; a region “Region”; bare paper “Bare paper”; 1 guide; planned again without “Region”, of "
        "which nothing is seen on the picture."
    )
    painting = read_painting(again.folder / "painting.json")
    xy = np.array([point[:2] for stroke in painting.strokes for point in stroke.trajectory])
    assert not ((xy > 0.01) & (xy < 0.03)).all(axis=1).any(), "no ink there"
    assert (kept.phase, kept.why) == (Phase.PLANNED, "")
    assert read_painting(kept.folder / "painting.json") == painting
    assert (kept.folder / "preview.png").is_file()
    assert (kept.folder / TARGET).read_bytes() == (again.folder / TARGET).read_bytes()
    assert kept.request.options.regions is None, "both regions are taken out"
    assert changes_in(kept.folder, {}) == "Region “Region” taken out; region “Bare paper” taken out; kept as it is."


def ask_for(folder: Path, **options: Any) -> None:
    """Write other options into the request of the plan in a folder."""
    file = folder / "request.json"
    request = PlanRequest.from_json(json.loads(file.read_bytes()), file)
    file.write_text(json.dumps(replace(request, options=replace(request.options, **options)).as_json()))


def version_of_coast(root: Path, locked: list[int], taken_out: Sequence[int] = (), **how: Any) -> Plan:
    """Make a version of the plan "coast" with these strokes locked, as `Studio.version_of`, and wait for it."""

    async def act() -> Plan:
        with Folder.opened(root) as folder:
            studio = Studio(folder)
            try:
                await studio.directing("coast").edit({"kind": "lock", "strokes": locked})
                if taken_out:
                    await studio.directing("coast").edit({"kind": "remove", "strokes": taken_out})
                version = await studio.version_of("coast", **how)
                await until(lambda: not version.is_busy)
            finally:
                await studio.close()
        return version

    return asyncio.run(act())


def test_a_version_in_which_other_things_matter_goes_on_from_the_painting(tmp_path: Path) -> None:
    file = put_plan_to_direct(tmp_path, "coast")
    planned = read_painting(file)
    weights = {"tone": 0.5, "edges": 1.5, "likeness": 0.0}
    version = version_of_coast(tmp_path, [planned.strokes[0].id], weights=weights)
    assert version.why == ""
    assert changes_in(version.folder, weights_of(version.request)) == (
        "1 stroke locked; planned again, “Light and dark” at 0.5 instead of 1, “Outlines” at 1.5 instead of 0."
    )
    painting = read_painting(version.folder / "painting.json")
    assert painting.provenance.options["weights"] == {"tone": 0.5, "edges": 1.5}
    assert [stroke.id for stroke in painting.strokes if stroke.locked] == [planned.strokes[0].id]
    assert read_painting(file) == planned, "what it came from is as it was"


def test_regions_of_the_command_line_stay_until_some_are_painted(tmp_path: Path) -> None:
    options = PlanOptions(regions=tmp_path / "map.png", say=tmp_path / "map.toml")
    request = PlanRequest(None, options)
    assert without_own_places(request, tmp_path) == request
    own = PlanRequest(None, PlanOptions(regions=tmp_path / MAP, say=tmp_path / SAY, guides=tmp_path / GUIDES))
    left = without_own_places(own, tmp_path).options
    assert (left.regions, left.say, left.guides) == (None, None, None)
    (tmp_path / "now.json").touch()
    (tmp_path / "version").mkdir()
    files = {SAID_FILE: b"{}", MAP: b"", SAY: b""}
    moved = Around(tmp_path / "now.json", b"", files).move_to(tmp_path / "version", request).options
    assert (moved.regions, moved.say) == (tmp_path / "version" / MAP, tmp_path / "version" / SAY)


def test_a_version_over_a_photograph_leaves_out_what_is_painted(tmp_path: Path) -> None:
    file = put_plan_to_direct(tmp_path, "coast")
    planned = read_painting(file)
    painted = [stroke.id for stroke in planned.strokes[:10]]
    (tmp_path / "pictures" / "sheet").mkdir()
    Image.new("RGB", (48, 48), "white").save(tmp_path / "pictures" / "sheet" / "picture.png")
    with Journal.open(journal_of(file)) as journal:
        journal.revise(file, painted)

    over = version_of_coast(tmp_path, [painted[0], planned.strokes[11].id], photograph="sheet")
    assert over.why == ""
    assert changes_in(over.folder, {}) == "2 strokes locked; planned again over a photograph of the sheet."
    painting = read_painting(over.folder / "painting.json")
    assert painting.sheet.picture is not None
    assert len(painting.strokes) == len(planned.strokes) - 10
    assert [stroke.id for stroke in painting.strokes if stroke.locked] == [planned.strokes[11].id]


def test_strokes_that_were_taken_out_come_back_in_a_version_beside_guides_that_are_painted(tmp_path: Path) -> None:
    file = put_plan_to_direct(tmp_path, "coast")
    planned = read_painting(file)
    guides = [stroke.model_copy(update={"locked": True, "origin": "guide"}) for stroke in planned.strokes[:3]]
    write_painting(planned.model_copy(update={"strokes": (*guides, *planned.strokes[3:])}), file)
    ask_for(file.parent, strokes=len(planned.strokes) - 3, exact=True)  # the guides come beside those

    version = version_of_coast(tmp_path, [guides[0].id], taken_out=[stroke.id for stroke in planned.strokes[3:8]])
    assert version.why == ""
    assert len(read_painting(version.folder / "painting.json").strokes) == len(planned.strokes)


def test_strokes_that_are_on_paper_come_back_in_no_later_round_over_a_photograph(tmp_path: Path) -> None:
    file = put_plan_to_direct(tmp_path, "coast")
    planned = read_painting(file)
    left = planned.model_copy(update={"strokes": planned.strokes[16:]})  # of 24
    options = {**left.provenance.options, "strokes": len(left.strokes)}
    write_painting(
        left.model_copy(update={"provenance": left.provenance.model_copy(update={"options": options})}), file
    )
    ask_for(file.parent, strokes=len(planned.strokes), paints=10)
    (tmp_path / "pictures" / "sheet").mkdir()
    Image.new("RGB", (48, 48), "white").save(tmp_path / "pictures" / "sheet" / "picture.png")
    with Journal.open(journal_of(file)) as journal:
        journal.revise(file, [stroke.id for stroke in left.strokes[:4]])

    over = version_of_coast(tmp_path, [left.strokes[5].id], photograph="sheet")
    assert over.why == ""
    assert len(read_painting(over.folder / "painting.json").strokes) == len(left.strokes) - 4
    assert over.request.options.paints == len(left.strokes), "more paints than strokes cannot be asked for"


def test_a_plan_with_fewer_strokes_left_than_there_are_tubes_is_planned_again_in_its_paints(tmp_path: Path) -> None:
    file = put_plan_to_direct(tmp_path, "coast")
    tubes = tmp_path / "tubes.csv"
    tubes.write_text("".join(f"grey {level},#{level}0{level}0{level}0\n" for level in range(1, 10)))
    ask_for(file.parent, strokes=40, paints=None, paints_from=tubes)
    few = read_painting(file)
    few = few.model_copy(update={"strokes": few.strokes[:4]})
    options = {**few.provenance.options, "strokes": 4}
    write_painting(few.model_copy(update={"provenance": few.provenance.model_copy(update={"options": options})}), file)

    version = version_of_coast(tmp_path, [few.strokes[0].id])
    assert version.why == ""
    assert read_painting(version.folder / "painting.json").paints == few.paints


def test_what_a_camera_had_planned_again_cannot_be_planned_over_a_photograph(tmp_path: Path) -> None:
    file = put_plan_to_direct(tmp_path, "coast")
    assert painted_of(file) == frozenset()
    second = file.with_name("painting.r1.json")
    second.write_bytes(file.read_bytes())
    with Journal.open(journal_of(file)) as journal:
        journal.revise(file)
        journal.revise(second)
    with pytest.raises(InputError, match="other strokes are on the sheet; plan the picture anew"):
        painted_of(file)


def test_no_version_is_kept_of_which_no_stroke_is_left(tmp_path: Path) -> None:
    strokes = [stroke.id for stroke in read_painting(put_plan_to_direct(tmp_path, "coast")).strokes]
    with pytest.raises(InputError, match="no stroke of coast is left; draw one, or undo, before it is kept"):
        version_of_coast(tmp_path, strokes[:1], taken_out=strokes, is_kept=True)
    assert [each.name for each in (tmp_path / "plans").iterdir()] == ["coast"]
