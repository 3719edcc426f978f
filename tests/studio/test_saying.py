"""What a person says of places on the canvas: kept among the acts, and written as files that planning reads."""

import asyncio
import itertools
import json
import tomllib
from collections.abc import Awaitable, Callable
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.colour.palette import parse_colour
from maulstick.errors import InputError
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.region_files import RegionFiles
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.brush import load_brush
from maulstick.painting.fit import place_of
from maulstick.painting.painting import read_painting
from maulstick.painting.picture import encode_png
from maulstick.painting.raster import Canvas
from maulstick.storage.arrays import Bools
from maulstick.studio.state.directing import Directing
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.plans import Phase, Plan
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.version_words import version_in_words
from maulstick.studio.state.versions import Around, changes_in, without_own_places
from maulstick.studio.workers.areas import brushed, enclosed, geometry_of, guide
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.planner import TARGET
from maulstick.studio.workers.said import MOST_REGIONS, Said, SaidGuide, SaidRegion, map_colours
from maulstick.studio.workers.said_files import GUIDES, MAP, SAID_FILE, SAY, read_said, said_files
from maulstick.studio.workers.stroke_changes import StrokeChanges, changes_of
from maulstick.style import load_style
from tests.studio.test_plans import until
from tests.support.robot.small_paintings import SIX, line, painting_of
from tests.support.studio.plans_to_paint import put_plan, put_plan_to_direct

_SQUARE = [0.01, 0.01, 0.03, 0.01, 0.03, 0.03, 0.01, 0.03]
_WIDE, _HIGH = SIX.sheet.width, SIX.sheet.height


def saying(root: Path, act: Callable[[Directing], Awaitable[None]]) -> Directing:
    """Open the acts on a plan as a new studio does, act on them, and return them."""

    async def go() -> Directing:
        desk = Desk()
        directing = Directing(root / "plans" / "six" / "painting.json", desk)
        try:
            await act(directing)
        finally:
            desk.close()
        return directing

    return asyncio.run(go())


def region(id: int, outline: list[tuple[float, float]], **fields: object) -> SaidRegion:
    """Make a region of one outline, metres, with a name and a colour by its id."""
    said = {"id": id, "name": f"region {id}", "colour": map_colours()[id], "area": [[outline]], **fields}
    return SaidRegion.model_validate(said)


def box(left: float, top: float, right: float, bottom: float) -> list[tuple[float, float]]:
    return [(left, top), (right, top), (right, bottom), (left, bottom)]


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

    saying(tmp_path, say)

    async def undo(directing: Directing) -> None:
        assert [each.name for each in directing.saying.now.regions] == ["Bare paper"]
        await directing.undo()
        await directing.undo()

    later = saying(tmp_path, undo)
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
        await said.take_out(one)
        with pytest.raises(InputError, match="taken out"):
            await said.take_out(one)
        with pytest.raises(InputError, match="taken out"):
            await said.change(one, name="face")
        with pytest.raises(InputError, match="width of the brush"):
            await said.emphasise(_SQUARE, 0, 3)

    assert saying(tmp_path, act).version == 3


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

    regions = saying(tmp_path, act).saying.now.regions
    assert [each.importance for each in regions] == [3, 2, 3]
    assert len(regions[0].area) == 2, "two dabs"
    assert geometry_of(regions[0].area).area == pytest.approx(2 * (4e-5 + np.pi * 4e-6), rel=0.02)


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


def picture_of(root: Path, wide: int, high: int) -> Path:
    """Write a picture of so many pixels."""
    path = root / "picture.png"
    path.write_bytes(encode_png(np.ones((high, wide, 3), dtype=np.float32)))
    return path


sides = st.integers(1, 40)
shares = st.floats(-0.1, 1.1, allow_nan=False)


@given(
    picture=st.tuples(sides, sides),
    sheet=st.tuples(st.integers(30, 90), st.integers(30, 90)),
    fit=st.sampled_from(["contain", "cover"]),
    margin=st.integers(0, 10),
    turned=st.sampled_from([0, 90]),
    lasso=st.lists(st.tuples(shares, shares), min_size=3, max_size=9),
    dab=st.tuples(shares, shares),
    pixels=st.integers(300, 3000),
)
@settings(max_examples=60, deadline=None)
def test_what_is_drawn_on_the_sheet_holds_there_within_a_pixel_however_the_picture_lies(
    tmp_path_factory: pytest.TempPathFactory,
    picture: tuple[int, int],
    sheet: tuple[int, int],
    fit: str,
    margin: int,
    turned: int,
    lasso: list[tuple[float, float]],
    dab: tuple[float, float],
    pixels: int,
) -> None:
    root = tmp_path_factory.mktemp("round")
    options = PlanOptions(size=f"{sheet[0]}x{sheet[1]}mm", fit=fit, margin=f"{margin}mm", rotate=turned)
    request = PlanRequest(picture_of(root, *picture), options)
    width, height = (1e-3 * side for side in sheet)
    size = SIX.sheet.model_copy(update={"width": width, "height": height})
    file = put_plan(root, "any", painting_of([line(0)]).model_copy(update={"sheet": size}))
    areas = {}
    for name, draw in (
        ("lasso", lambda: enclosed(file, [(width * x, height * y) for x, y in lasso])),
        (
            "ring",
            lambda: brushed(file, [(0.01, 0.01), (0.02, 0.01), (0.02, 0.02), (0.01, 0.02), (0.01, 0.01)], 0.004, ()),
        ),
        ("dab", lambda: brushed(file, [(width * dab[0], height * dab[1])], 0.008, ())),
    ):
        try:
            areas[name] = draw()
        except InputError:  # nothing of it is on the sheet
            continue
    regions = tuple(
        SaidRegion(id=i, name=name, colour=map_colours()[i], area=area) for i, (name, area) in enumerate(areas.items())
    )
    files = said_files(file, Said(regions=regions).model_dump_json(), request)
    for name, content in files.items():
        (root / name).write_bytes(content)
    canvas, inset = Canvas(width, height, pixels), 1e-3 * margin
    shape = picture[::-1] if turned == 0 else picture
    left, top, right, bottom = place_of(shape, canvas, fit, inset)
    if MAP not in files:
        return
    brush = load_brush("round")
    try:
        found = RegionFiles(root / MAP, root / SAY).on(
            canvas, shape, fit, inset, load_style("loops", canvas), (brush,), (brush,)
        )
    except InputError as error:
        if "shows nothing" not in str(error):  # which is said of what is smaller than a pixel
            raise
        return
    y, x = np.mgrid[: canvas.height_px, : canvas.width_px] + 0.5
    inside = (x > left) & (x < right) & (y > top) & (y < bottom)
    names = [each.name for each in found.said]
    under = np.zeros_like(inside)
    for each in reversed(regions):
        seen: Bools = found.labels == names.index(each.name) if each.name in names else np.zeros_like(inside)
        area = shapely.transform(geometry_of(each.area), lambda points: points * pixels)
        sure = inside & shapely.contains_xy(area.buffer(-_NEAR), x, y) & ~under
        assert seen[sure].all(), each.name
        assert not seen[inside & ~shapely.contains_xy(area.buffer(_NEAR), x, y)].any(), each.name
        under |= shapely.contains_xy(area.buffer(_NEAR), x, y)


_NEAR = 1.5  # pixels: one, and what the planner rounds the picture's place by


def test_names_in_any_script_and_what_holds_are_written_as_toml(tmp_path: Path) -> None:
    file = put_plan(tmp_path, "six", SIX)
    names = ['say "no" \\ [x]', "顔", "👩‍🎨", "[face]\u00e9.x", "a = 1 #"]
    regions = tuple(
        region(
            i,
            box(0.002 * i, 0, 0.002 * i + 0.002, 0.03),
            name=name,
            style="loops",
            hand_size=0.5,
            importance=2,
            direction=45,
            soft=5e-3,
        )
        for i, name in enumerate(names)
    )
    bare = region(9, box(0.03, 0, 0.04, 0.04), bare=True, style="loops", importance=5)
    files = said_files(file, Said(regions=(*regions, bare)).model_dump_json(), PlanRequest(None, _TEXT))
    said = tomllib.loads(files[SAY].decode())
    assert list(said) == [*names, bare.name]
    holds = {"style": "loops", "hand_size": 0.5, "importance": 2.0, "direction": 45.0, "soft": "5mm"}
    assert said["顔"] == {"colour": map_colours()[1], **holds}
    assert isinstance(said["顔"]["direction"], float)
    assert said[bare.name] == {"colour": bare.colour, "bare": True}
    (tmp_path / SAID_FILE).write_bytes(files[SAID_FILE])
    assert read_said(tmp_path).regions == (*regions, bare)
    (tmp_path / SAID_FILE).write_text('{"regions": 1}')
    with pytest.raises(InputError, match="another version"):
        read_said(tmp_path)


_TEXT = PlanOptions(text="lines", size="60x40mm")


def test_a_region_that_lies_wholly_under_later_ones_or_beside_the_picture_is_not_planned(tmp_path: Path) -> None:
    file = put_plan(tmp_path, "six", SIX)
    under, over = region(1, box(0.02, 0.012, 0.03, 0.02)), region(2, box(0.015, 0.011, 0.04, 0.03))
    beside = region(3, box(0, 0, 0.01, 0.04))
    guides = tuple(SaidGuide(id=i, line=line) for i, line in ((4, ((0, 0.02), (0.06, 0.02))), (5, ((0, 0), (0, 0.04)))))
    request = PlanRequest(picture_of(tmp_path, 10, 20), PlanOptions(size="60x40mm"))
    files = said_files(file, Said(regions=(under, over, beside), guides=guides).model_dump_json(), request)
    assert list(tomllib.loads(files[SAY].decode())) == [over.name]
    assert files[GUIDES].count(b"<polyline") == 1, "what lies on the picture"
    assert b'viewBox="0 0 20.0000 40.0000"' in files[GUIDES]
    assert b'points="0.0000,20.0000 20.0000,20.0000"' in files[GUIDES]
    assert len(Said.model_validate_json(files[SAID_FILE]).regions) == 3
    assert said_files(file, Said().model_dump_json(), request) == {}


def test_a_sheet_that_is_left_all_bare_is_refused_by_the_planner_in_a_sentence(tmp_path: Path) -> None:
    file = put_plan(tmp_path, "six", SIX)
    said = Said(regions=(region(1, box(0, 0, _WIDE, _HIGH), bare=True),))
    for name, content in said_files(file, said.model_dump_json(), PlanRequest(None, _TEXT)).items():
        (tmp_path / name).write_bytes(content)
    canvas, brush = Canvas(_WIDE, _HIGH, 1000), load_brush("round")
    with pytest.raises(InputError, match="leaves all of the sheet bare"):
        RegionFiles(tmp_path / MAP, tmp_path / SAY).on(
            canvas, (40, 60), "contain", 0, load_style("loops", canvas), (brush,), (brush,)
        )


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
    assert strokes == StrokeChanges(drawn=1, removed=1, moved=1, repainted=1, locked=2)
    sky, face = region(1, box(0, 0, 1, 1), name="sky"), region(2, box(0, 0, 1, 1), name="face", style="loops")
    before = Said(regions=(sky,))
    now = Said(
        regions=(face, region(3, box(0, 0, 1, 1), name="paper", bare=True), region(4, box(0, 0, 1, 1), importance=3)),
        guides=(SaidGuide(id=9, line=((0, 0), (1, 1))),),
    )
    assert version_in_words(
        StrokeChanges(drawn=12, removed=3, moved=1), before, now, {"loops": "Loops"}, is_kept=False
    ) == (
        "3 strokes taken out, 12 drawn, 1 moved; a region “face” in Loops; bare paper “paper”; a region “region 4”, "
        "counts 3 times; region “sky” taken out; 1 guide; planned again."
    )
    assert version_in_words(StrokeChanges(), now, now, {}, is_kept=True) == "Kept as it is."
    assert version_in_words(StrokeChanges(locked=1), Said(), Said(), {}, is_kept=False) == (
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
                await first.saying.enclose(_SQUARE, bare=True)
                await first.saying.guide([0.005, 0.05, 0.055, 0.05])
                await first.edit({"kind": "remove", "strokes": [planned.strokes[0].id]})
                again = await studio.version_of("coast")
                await until(lambda: not again.is_busy)
                assert again.why == ""
                second = studio.directing(again.name)
                assert second.saying.now == first.saying.now
                await second.saying.take_out(second.saying.now.regions[0].id)
                kept = await studio.version_of(again.name, is_kept=True)
                await until(lambda: not kept.is_busy)
            finally:
                await studio.close()
        return [again, kept]

    again, kept = asyncio.run(act())
    options = again.request.options
    assert (options.regions, options.say, options.guides) == tuple(again.folder / name for name in (MAP, SAY, GUIDES))
    assert changes_in(again.folder) == "1 stroke taken out; bare paper “Bare paper”; 1 guide; planned again."
    painting = read_painting(again.folder / "painting.json")
    xy = np.array([point[:2] for stroke in painting.strokes for point in stroke.trajectory])
    assert not ((xy > 0.01) & (xy < 0.03)).all(axis=1).any(), "no ink there"
    assert (kept.phase, kept.why) == (Phase.PLANNED, "")
    assert read_painting(kept.folder / "painting.json") == painting
    assert (kept.folder / "preview.png").is_file()
    assert (kept.folder / TARGET).read_bytes() == (again.folder / TARGET).read_bytes()
    assert kept.request.options.regions is None, "the one region is taken out"
    assert changes_in(kept.folder) == "Region “Bare paper” taken out; kept as it is."


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
