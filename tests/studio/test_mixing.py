"""Paints of plans: what is shown of them, which are mixed, and the tubes and the tray."""

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.colour.mixing import mixing_advice
from maulstick.colour.tubes import USUAL_PAINTS, NamedPaint
from maulstick.errors import InputError
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import write_painting
from maulstick.robot.tray import read_tray
from maulstick.storage.records import write_record
from maulstick.studio.panels.paints.paints import legible_on
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.mixing import Mixing, RowOfWells, tubes_csv
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.planned_paints import planned_paints
from tests.support.robot.small_paintings import line, painting_of
from tests.support.robot.trays import TRAY
from tests.support.studio.plans_to_paint import put_plan

T = TypeVar("T")
BLUE_FIRST = painting_of([line(i, (0.01, 0.01), (0.03, 0.01), paint=paint) for i, paint in enumerate((1, 1, 0, 1))])
RED, BLUE = (paint.label for paint in BLUE_FIRST.paints)
IN_GREEN: Painting = BLUE_FIRST.model_copy(
    update={"paints": (BLUE_FIRST.paints[0].model_copy(update={"colour": (0.0, 1.0, 0.0)}), BLUE_FIRST.paints[1])}
)


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Folder]:
    """Folder of a studio with a plan in two paints, none of them mixed."""
    with Folder.opened(tmp_path / "studio") as opened:
        put_plan(opened.root, "cat", BLUE_FIRST, mixed=False)
        yield opened


def asked(folder: Folder, ask: Callable[[Mixing], Awaitable[T]]) -> T:
    """Run a coroutine with a desk, and return its result."""

    async def run() -> T:
        desk = Desk()
        try:
            return await ask(Mixing(folder, desk))
        finally:
            desk.close()

    return asyncio.run(run())


async def missing(mixing: Mixing, plan: str) -> list[str]:
    """Return the labels of the paints that are still to be mixed."""
    return [paint.label for paint in await mixing.missing(plan)]


def test_a_paint_is_told_with_its_metres_its_strokes_and_its_turn(folder: Folder) -> None:
    red, blue = planned_paints(folder.root / "plans" / "cat" / "painting.json", None)
    assert (red.number, red.label, red.strokes, red.place, red.times) == (1, RED, 1, 2, 1)
    assert (blue.number, blue.label, blue.strokes, blue.place, blue.times) == (2, BLUE, 3, 1, 2)
    assert [red.metres, blue.metres] == pytest.approx(BLUE_FIRST.metres_of_paints())
    assert red.well is blue.well is None
    assert [red.display_name, blue.display_name] == ["paint 1 (red)", "paint 2 (blue)"]


def test_a_paint_has_the_well_that_the_tray_has_for_its_colour(folder: Folder) -> None:
    there = TRAY.model_copy(update={"paints": {BLUE: TRAY.water}})
    write_record(there, folder.root / "tray.json")
    red, blue = planned_paints(folder.root / "plans" / "cat" / "painting.json", folder.root / "tray.json")
    assert red.well is None
    assert blue.well == (TRAY.water.x, TRAY.water.y)


def test_what_is_mixed_is_kept_and_another_colour_is_not_mixed_yet(folder: Folder) -> None:
    told: list[int] = []

    async def mix(mixing: Mixing) -> list[list[str]]:
        mixing.changed.subscribe(lambda: told.append(1))
        seen = [await missing(mixing, "cat")]
        await mixing.tick("cat", RED, True)
        await mixing.tick("cat", RED, True)
        seen.append(await missing(mixing, "cat"))
        with pytest.raises(InputError, match=f"there is no paint 'mauve'; there are: {BLUE}, {RED}"):
            await mixing.tick("cat", "mauve", True)
        await mixing.tick_all("cat")
        assert not await missing(mixing, "cat")
        again = Mixing(folder, mixing._desk)
        assert not await missing(again, "cat")
        await again.tick("cat", BLUE, False)
        seen.append(await missing(mixing, "cat"))
        await mixing.tick_all("cat")
        write_painting(IN_GREEN, folder.root / "plans" / "cat" / "painting.json")
        return [*seen, await missing(mixing, "cat")]

    assert asked(folder, mix) == [[RED, BLUE], [BLUE], [BLUE], ["#00ff00"]]
    assert len(told) == 3, "the second tick of red changed nothing, and the other Mixing told its own"


def test_a_paint_that_no_stroke_uses_need_not_be_mixed(folder: Folder) -> None:
    only_blue = BLUE_FIRST.model_copy(update={"strokes": BLUE_FIRST.strokes[:2]})
    put_plan(folder.root, "sky", only_blue, mixed=False)
    assert asked(folder, lambda mixing: missing(mixing, "sky")) == [BLUE]


def test_recipes_come_from_the_tubes_that_one_has(folder: Folder) -> None:
    mine = (NamedPaint("my red", (1.0, 0.0, 0.0)), NamedPaint("my blue", (0.0, 0.0, 1.0)))

    async def advise(mixing: Mixing) -> None:
        wanted = np.array([paint.colour for paint in BLUE_FIRST.paints])
        assert mixing.tubes() == USUAL_PAINTS
        assert await mixing.advice("cat") == mixing_advice(wanted, USUAL_PAINTS)
        await mixing.use_tubes(tubes_csv([("my red", "#ff0000"), ("my blue", "#0000ff")]))
        assert mixing.tubes() == mine
        assert mixing.has_own_tubes
        assert await mixing.advice("cat") == mixing_advice(wanted, mine)

    asked(folder, advise)


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"", "the list of tubes is empty"),
        (b"ochre,#zzzzzz", "the list of tubes, line 1: '#zzzzzz' is not a colour"),
        (b"ochre,#c08a35\nOchre,#c08a35", "the list of tubes, line 2: there is already a paint 'Ochre'"),
        (b"\xff\xd8\xff\x00", "the list of tubes is not text"),
    ],
)
def test_tubes_that_are_none_are_refused_and_the_earlier_ones_stay(folder: Folder, content: bytes, why: str) -> None:
    mixing = Mixing(folder, Desk())
    asyncio.run(mixing.use_tubes(b"ochre,#c08a35"))
    with pytest.raises(InputError, match=why):
        asyncio.run(mixing.use_tubes(content))
    assert [tube.name for tube in mixing.tubes()] == ["ochre"]


def test_a_tray_comes_goes_and_comes_back(folder: Folder) -> None:
    mixing = Mixing(folder, Desk())
    with pytest.raises(InputError, match="that file is not a tray: "):
        asyncio.run(mixing.use_tray(b"{}"))
    assert not mixing.has_tray
    asyncio.run(mixing.use_tray(TRAY.model_dump_json().encode()))
    assert mixing.has_tray
    trashed = mixing.remove_tray()
    assert not mixing.has_tray
    mixing.take_back(trashed)
    assert mixing.has_tray


def test_no_row_of_wells_is_all_at_one_place(folder: Folder) -> None:
    mixing, row = Mixing(folder, Desk()), RowOfWells(0.0, 0.0, step=0.0, height=0.0, clearance=0.03, reach=0.3)
    with pytest.raises(InputError, match="all wells would be one, water and cloth too; say how far"):
        asyncio.run(mixing.lay_tray("cat", row))
    assert not mixing.has_tray


def test_another_tray_and_other_tubes_leave_the_former_ones_in_the_trash(folder: Folder) -> None:
    async def replace(mixing: Mixing) -> None:
        await mixing.use_tubes(b"ochre,#c08a35")
        await mixing.use_tray(TRAY.model_dump_json().encode())
        assert list((folder.root / "trash").iterdir()) == []
        await mixing.use_tubes(b"umber,#6b4a2a")
        await mixing.lay_tray("cat", RowOfWells(x=-0.06, y=0.02, step=0.04, height=-0.004, clearance=0.03, reach=0.3))

    asked(folder, replace)
    tubes, tray = sorted((folder.root / "trash").glob("*/t*"))
    assert tubes.read_text() == "name,colour\nochre,#c08a35\n"
    assert read_tray(tray) == TRAY


def test_two_ticks_at_once_are_both_kept(folder: Folder) -> None:
    async def tick(mixing: Mixing) -> list[str]:
        await asyncio.gather(mixing.tick("cat", RED, True), mixing.tick("cat", BLUE, True))
        return await missing(mixing, "cat")

    assert asked(folder, tick) == []


def test_a_row_of_wells_has_one_for_each_paint_then_water_then_a_cloth(folder: Folder) -> None:
    row = RowOfWells(x=-0.06, y=0.02, step=0.04, height=-0.004, clearance=0.03, reach=0.3)
    asked(folder, lambda mixing: mixing.lay_tray("cat", row))
    tray = read_tray(folder.root / "tray.json")
    wells = [*tray.wells_of(BLUE_FIRST), tray.water, tray.cloth]
    assert [(well.x, well.y) for well in wells] == [(-0.06, pytest.approx(0.02 + 0.04 * i)) for i in range(4)]
    assert [well.height for well in wells] == [-0.004, -0.004, -0.004, 0.0]


def test_a_row_of_wells_that_the_tip_would_hit_is_refused(folder: Folder) -> None:
    low = RowOfWells(x=-0.06, y=0.02, step=0.04, height=-0.004, clearance=-0.01, reach=0.3)
    with pytest.raises(InputError, match="the wells cannot be so: "):
        asked(folder, lambda mixing: mixing.lay_tray("cat", low))
    assert not (folder.root / "tray.json").exists()


def test_plans_without_paints_are_not_offered(folder: Folder) -> None:
    (folder.root / "plans" / "unfinished").mkdir()
    assert Mixing(folder, Desk()).plans() == {"cat": "cat"}


@given(st.tuples(*[st.integers(0, 255)] * 3))
def test_what_is_written_on_a_paint_can_be_read(colour: tuple[int, int, int]) -> None:
    paint = "#{:02x}{:02x}{:02x}".format(*colour)
    high, low = sorted((luminance(each) for each in (paint, legible_on(paint))), reverse=True)
    assert (high + 0.05) / (low + 0.05) >= 4.5


def luminance(colour: str) -> float:
    """Relative luminance of a colour by WCAG 2.2."""
    pairs = [colour[1:][i : i + 2] for i in (0, 2, 4)] if len(colour) == 7 else [2 * each for each in colour[1:]]
    shares = [int(pair, 16) / 255 for pair in pairs]
    light = [share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4 for share in shares]
    return 0.2126 * light[0] + 0.7152 * light[1] + 0.0722 * light[2]
