"""Drawings of the studio without its page: kept, read in other ways, painted, and gone on with."""

import asyncio
import errno
import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from unittest.mock import patch

import pytest
from PIL import Image

from maulstick.drawing.options import DrawingOptions
from maulstick.errors import InputError, OutputError
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paintable import read_paintable
from maulstick.robot.journal import Journal, journal_of
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.mixing import Mixing
from maulstick.studio.state.plans import Plans
from maulstick.studio.state.run import Run
from maulstick.studio.state.svgs import Svgs
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.svg_work import keep_svg
from tests.studio.test_run import outcome, stroke, until
from tests.support.studio.drawings import BOAT, COMB, ROWS, WITH_TEXT, svg
from tests.support.studio.plans_to_paint import put_plan

pytestmark = pytest.mark.usefixtures("data")

HATCHED = DrawingOptions(size=(0.3, 0.2), margin=0.01, hatch=0.002, no_repeats=True, join=1e-4)
ENTITIES = '<!DOCTYPE svg [<!ENTITY a "aaaa">]>' + svg("<path d='M 0 0 H 5' id='&a;'/>")
PICTURE = svg('<image width="5" height="5" href="cat.png"/>')


@asynccontextmanager
async def opened(root: Path) -> AsyncIterator[tuple[Svgs, Run]]:
    """Open a studio without a page, and stop its machine at the end."""
    with Folder.opened(root) as folder:
        desk = Desk()
        run = Run(folder, desk, Mixing(folder, desk), Plans(folder))
        try:
            yield Svgs(folder, desk), run
        finally:
            await run.close()
            desk.close()


async def bring(svgs: Svgs, root: Path, content: str, called: str = "My Boat.SVG") -> str:
    """Bring a drawing, as the page does; return its name in the studio."""
    (root / "incoming").write_text(content)
    return await svgs.keep(root / "incoming", called)


def size_of(picture: Path) -> tuple[int, int]:
    with Image.open(picture) as seen:
        return seen.size


def test_a_drawing_is_kept_with_its_card_and_its_picture_and_read_in_other_ways(tmp_path: Path) -> None:
    async def keep() -> None:
        async with opened(tmp_path / "studio") as (svgs, _):
            changes: list[int] = []
            svgs.changed.subscribe(lambda: changes.append(len(svgs.cards())))
            assert await bring(svgs, tmp_path, BOAT) == "my-boat"
            card, picture = svgs.cards()["my-boat"], svgs.file("my-boat").with_name("preview.png")
            assert svgs.file("my-boat").read_text() == BOAT
            assert card.sheet == pytest.approx((0.06, 0.04))
            assert (card.options, card.paths, card.pens) == (DrawingOptions(), 2, 2)
            assert card.metres == pytest.approx(0.055 + 0.056)
            assert card.notes == ("lines that reach beyond the sheet of 60 x 40 mm are cut at its edges: 1",)
            assert size_of(picture) == (1024, 683)
            await svgs.read("my-boat", HATCHED)
            read = read_paintable(svgs.file("my-boat"), HATCHED)
            card = svgs.cards()["my-boat"]
            assert (card.options, card.notes) == (HATCHED, read.notes)
            assert (card.sheet, card.paths) == ((0.3, 0.2), len(read.painting.strokes))
            assert size_of(picture) == (1024, 683)
            assert changes == [1, 1]
            await svgs.read("my-boat", DrawingOptions(hatch=0.002, hatch_hand="loops"))
            assert svgs.cards()["my-boat"].paths > 2
            await svgs.read("my-boat", HATCHED)
            with pytest.raises(InputError, match="hatch is 5000 mm; it must be"):
                await svgs.read("my-boat", DrawingOptions(hatch=5))
            assert svgs.cards()["my-boat"] == card

    asyncio.run(keep())


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (WITH_TEXT, "cannot draw My Boat.SVG: it has text; a pen draws paths"),
        (PICTURE, "cannot draw My Boat.SVG: it has a picture; a pen draws paths"),
        (ENTITIES, "My Boat.SVG declares entities, which may hide anything"),
        (svg(""), "cannot draw My Boat.SVG: there is no path or shape in it"),
        ("dear", "My Boat.SVG is not an SVG that can be read"),
        ("<html/>", "My Boat.SVG is not an SVG"),
    ],
    ids=["text", "picture", "entities", "empty", "letter", "page"],
)
def test_what_no_pen_draws_is_refused_in_a_sentence_and_leaves_nothing(tmp_path: Path, content: str, told: str) -> None:
    async def refuse() -> None:
        async with opened(tmp_path / "studio") as (svgs, run):
            with pytest.raises(InputError) as refused:
                await bring(svgs, tmp_path, content)
            assert str(refused.value).startswith(told)
            assert (svgs.cards(), run.plans()) == ({}, {})

    asyncio.run(refuse())
    assert list((tmp_path / "studio" / "drawings").iterdir()) == []


def test_a_drawing_and_a_plan_never_have_one_name_and_come_back_from_the_trash(tmp_path: Path) -> None:
    put_plan(tmp_path / "studio", "my-boat")

    async def keep() -> None:
        async with opened(tmp_path / "studio") as (svgs, run):
            assert await bring(svgs, tmp_path, COMB) == "my-boat-2"
            assert sorted(run.plans()) == ["my-boat", "my-boat-2"]
            trashed = await svgs.throw_away("my-boat-2")
            assert (svgs.cards(), run.plans()) == ({}, {"my-boat": "my-boat"})
            put_plan(tmp_path / "studio", "my-boat-2")
            with pytest.raises(OutputError, match="another one has the name my-boat-2 by now"):
                svgs.take_back(trashed)
            (tmp_path / "studio" / "plans" / "my-boat-2").rename(tmp_path / "elsewhere")
            svgs.take_back(trashed)
            assert list(svgs.cards()) == ["my-boat-2"]

    asyncio.run(keep())


def test_a_drawing_is_checked_and_painted_without_paints_to_mix_and_goes_on_as_it_was_read(tmp_path: Path) -> None:
    hatched = PaintOptions(robot="sim", drawing=HATCHED)

    async def paint() -> None:
        async with opened(tmp_path / "studio") as (svgs, run):
            name = await bring(svgs, tmp_path, BOAT)
            await svgs.read(name, HATCHED)
            run.check(name, hatched)
            assert await outcome(run) == "It fits."
            card = svgs.cards()[name]
            assert run.state.estimate is not None
            assert (run.state.estimate.strokes, run.state.estimate.paints) == (card.paths, card.pens)
            await run.begin(name, hatched.model_copy(update={"robot": "sim:real"}))
            await until(run, lambda: stroke(run) == 2)
            run.stop()
            assert await outcome(run) == "You stopped it. The pen is lifted."
            status = await run.status(name)
            assert status is not None
            assert (status.strokes, status.options.drawing) == (card.paths, HATCHED)
            await run.resume(name, PaintOptions(robot="sim", drawing=DrawingOptions()), False)
            assert await outcome(run) == (
                "this drawing was begun with other options, and would have other strokes; "
                "choose those again, or “Start again on a new sheet”"
            )
            await run.resume(name, hatched, False)
            assert await outcome(run) == "My Boat is painted."
            assert Journal.read(journal_of(svgs.file(name))).painted == set(range(card.paths))
            assert svgs.file(name).with_name("drawing-painted.png").is_file()

    asyncio.run(paint())


def test_a_drawing_that_was_begun_with_no_options_goes_on_with_the_usual_ones(tmp_path: Path) -> None:
    async def paint() -> None:
        async with opened(tmp_path / "studio") as (svgs, run):
            name = await bring(svgs, tmp_path, COMB)
            await run.begin(name, PaintOptions(robot="sim:real"))
            await until(run, lambda: stroke(run) == 2)
            run.stop()
            await outcome(run)
            await run.resume(name, PaintOptions(robot="sim", drawing=DrawingOptions()), True)
            assert await outcome(run) == "My Boat is painted."
            assert len(Journal.read(journal_of(svgs.file(name))).painted) == ROWS

    asyncio.run(paint())


def test_a_full_disk_while_a_drawing_is_kept_is_told_in_a_sentence_and_leaves_nothing(tmp_path: Path) -> None:
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    (tmp_path / "boat.svg").write_text(BOAT)
    with Folder.opened(tmp_path / "studio") as folder:
        file = folder.of("drawings", "boat") / "drawing.svg"
        with (
            patch("maulstick.studio.workers.svg_work.shutil.copyfile", side_effect=full),
            pytest.raises(OutputError, match=r"No space left on device; make room for it there$"),
        ):
            keep_svg(tmp_path / "boat.svg", "boat.svg", file)
        assert not list(file.parent.parent.iterdir())
