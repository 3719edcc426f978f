"""What a person says of places on the canvas: kept among the acts on strokes, undone and redone with them."""

import asyncio
import itertools
from pathlib import Path

import numpy as np
import pytest

from maulstick.colour.palette import parse_colour
from maulstick.errors import InputError
from maulstick.studio.state.directing import Directing
from maulstick.studio.workers.areas import brushed, enclosed, geometry_of, guide
from maulstick.studio.workers.said import MOST_REGIONS, Said, map_colours
from maulstick.studio.workers.said_files import SAY
from tests.support.robot.small_paintings import SIX
from tests.support.studio.acting import acting
from tests.support.studio.plans_to_paint import put_plan
from tests.support.studio.said_regions import box, region

_SQUARE = [0.01, 0.01, 0.03, 0.01, 0.03, 0.03, 0.01, 0.03]


def test_colours_of_regions_are_told_apart_on_a_map_from_each_other_and_from_white() -> None:
    colours = [parse_colour(colour) for colour in (*map_colours(), "white")]
    assert len(colours) == MOST_REGIONS + 1
    for one, other in itertools.combinations(colours, 2):
        assert max(abs(a - b) for a, b in zip(one, other, strict=True)) > 60 / 255


def test_regions_and_guides_are_undone_with_strokes_and_are_there_in_a_later_studio(tmp_path: Path) -> None:
    put_plan(tmp_path, "six", SIX)

    async def say(directing: Directing) -> None:
        face = await directing.saying.enclose(_SQUARE, bare=False)
        await directing.edit({"kind": "lock", "strokes": [10]})
        await directing.saying.change(face, name="  Gesicht \u2603 ", style="loops", direction=45, soft=0.003)
        await directing.saying.change(face, style="loops")
        await directing.saying.enclose(_SQUARE, bare=True)
        await directing.saying.guide([0.01, 0.01, 0.02, 0.02])
        assert directing.version == 5, "what was said already is no act"
        await directing.saying.take_out(face)

    acting(tmp_path, say)

    async def undo(directing: Directing) -> None:
        assert [each.name for each in directing.saying.now.regions] == ["Bare paper"]
        await directing.undo()
        await directing.undo()

    later = acting(tmp_path, undo)
    face, bare = later.saying.now.regions
    assert (face.name, face.style, face.direction, face.soft) == ("Gesicht \u2603", "loops", 45, 0.003)
    assert bare.bare
    assert later.saying.now.guides == ()
    assert len(later.edits) == 1
    assert geometry_of(face.area).area == pytest.approx(4e-4)


def test_what_cannot_be_said_is_refused_in_a_sentence_and_not_kept(tmp_path: Path) -> None:
    put_plan(tmp_path, "six", SIX)

    async def act(directing: Directing) -> None:
        said = directing.saying
        for points in ([0.01, 0.01], [0.01, 0.01, 0.02, 0.02], [1.0, 1.0, 1.1, 1.0, 1.1, 1.1], [0.01] * 80_002):
            with pytest.raises(InputError, match=r"area|points"):
                await said.enclose(points, bare=False)
        for points in ([0.01, 0.01], [1.0, 1.0, 2.0, 2.0]):
            with pytest.raises(InputError, match="no length"):
                await said.guide(points)
        one, other = await said.enclose(_SQUARE, bare=False), await said.enclose(_SQUARE, bare=False)
        assert directing.version == 2
        for fields in ({"name": "Region"}, {"name": "rest"}, {"name": "\n"}, {"importance": -1}, {"hand_size": 0}):
            with pytest.raises(InputError, match=r"called|said of a region"):
                await said.change(other, **fields)
        for degrees in (361, -400.5):
            with pytest.raises(InputError, match="direction: it must be from -360 to 360 degrees"):
                await said.change(other, direction=degrees)
        for name in ("all", "7", " 2-5 "):
            with pytest.raises(InputError, match=f"strokes are named as {name.strip()} is; give the region another"):
                await said.change(other, name=name)
        await said.take_out(one)
        with pytest.raises(InputError, match="taken out"):
            await said.take_out(one)
        with pytest.raises(InputError, match="taken out"):
            await said.change(one, name="face")
        await said.change(other, direction="guides")
        with pytest.raises(InputError, match="none on the picture"):
            said.check_guides({})
        assert said.unseen({}) == ["Region 2"]
        assert said.unseen({SAY: b'["Region 2"]\nbare = true'}) == []
        with pytest.raises(InputError, match="width of the brush"):
            await said.emphasise(_SQUARE, 0, 3)

    assert acting(tmp_path, act).version == 4


def test_there_are_as_many_regions_as_a_map_has_colours(tmp_path: Path) -> None:
    said = Said(regions=tuple(region(i, box(0, 0, 0.01, 0.01)) for i in range(MOST_REGIONS)))
    with pytest.raises(InputError, match="63 regions"):
        _ = said.free_colour
    fewer = said.model_copy(update={"regions": said.regions[:5] + said.regions[6:]})
    assert fewer.free_colour == said.regions[5].colour


def test_what_is_brushed_with_one_importance_is_one_region(tmp_path: Path) -> None:
    put_plan(tmp_path, "six", SIX)

    async def act(directing: Directing) -> None:
        said = directing.saying
        for x in (0.01, 0.02):
            await said.emphasise([x, 0.01, x, 0.02], 0.004, 3)
        await said.emphasise([0.01, 0.015], 0.004, 2)
        await said.change(said.now.regions[0].id, style="loops")
        await said.emphasise([0.015, 0.015], 0.004, 3)

    regions = acting(tmp_path, act).saying.now.regions
    assert [each.importance for each in regions] == [3, 2, 3]
    assert len(regions[0].area) == 2, "two dabs"
    assert geometry_of(regions[0].area).area == pytest.approx(2 * (4e-5 + np.pi * 4e-6), rel=0.02)


def test_what_is_said_twice_at_once_is_said_one_after_the_other(tmp_path: Path) -> None:
    put_plan(tmp_path, "six", SIX)

    async def act(directing: Directing) -> None:
        said = directing.saying
        await asyncio.gather(*(said.emphasise([x, 0.01, x, 0.02], 0.004, 3) for x in (0.01, 0.02)))
        await asyncio.gather(*(said.change(said.now.regions[0].id, name="Gesicht") for _ in range(2)))

    directing = acting(tmp_path, act)
    (region,) = directing.saying.now.regions
    assert len(region.area) == 2, "two dabs"
    assert directing.version == 3, "a name that it has already is no act"


def test_a_line_that_crosses_itself_encloses_each_of_its_parts_within_the_sheet(tmp_path: Path) -> None:
    file = put_plan(tmp_path, "six", SIX)
    eight = geometry_of(enclosed(file, [(0.01, 0.01), (0.03, 0.03), (0.03, 0.01), (0.01, 0.03)]))
    assert eight.is_valid
    assert eight.area == pytest.approx(2e-4)
    beyond = geometry_of(enclosed(file, box(-1, -1, 0.01, 0.01)))
    assert beyond.bounds == pytest.approx((0, 0, 0.01, 0.01))
    ring = brushed(file, [(0.02, 0.01), (0.03, 0.02), (0.02, 0.03), (0.01, 0.02), (0.02, 0.01)], 0.004, ())
    assert [len(rings) for rings in ring] == [2], "an outline and a hole"
    assert guide(file, [(-1, 0.01), (0.01, 0.01)]) == ((0, 0.01), (0.01, 0.01))
