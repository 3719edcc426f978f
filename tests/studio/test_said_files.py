"""Regions and guides of the canvas as files: planning reads in them what was drawn where it was drawn."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.region_files import RegionFiles
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.brush import load_brush
from maulstick.painting.fit import place_of
from maulstick.painting.picture import encode_png
from maulstick.painting.raster import Canvas
from maulstick.storage.arrays import Bools
from maulstick.studio.workers.areas import brushed, enclosed, geometry_of
from maulstick.studio.workers.said import Said, SaidGuide, SaidRegion, map_colours
from maulstick.studio.workers.said_files import GUIDES, MAP, SAID_FILE, SAY, read_said, said_files
from maulstick.style import load_style
from tests.support.robot.small_paintings import SIX, line, painting_of
from tests.support.studio.plans_to_paint import put_plan
from tests.support.studio.said_regions import box, region

_WIDE, _HIGH = SIX.sheet.width, SIX.sheet.height
_TEXT = PlanOptions(text="lines", size="60x40mm")
_NEAR = 1.5  # pixels: one, and what the planner rounds the picture's place by

sides = st.integers(1, 40)
shares = st.floats(-0.1, 1.1, allow_nan=False)


def picture_of(root: Path, wide: int, high: int) -> Path:
    """Write a picture of so many pixels."""
    path = root / "picture.png"
    path.write_bytes(encode_png(np.ones((high, wide, 3), dtype=np.float32)))
    return path


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
@example(
    picture=(1, 1),
    sheet=(60, 53),
    fit="contain",
    margin=0,
    turned=0,
    lasso=[(0.0, 1.0), (1.0, 0.0), (-0.0625, 0.0), (2.3e-308, 0.5), (2.3e-308, 0.0)],
    dab=(0.0, 0.0),
    pixels=300,
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
            canvas, shape, fit, inset, load_style("loops", canvas), 1.0, (brush,), (brush,)
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
            canvas, (40, 60), "contain", 0, load_style("loops", canvas), 1.0, (brush,), (brush,)
        )
