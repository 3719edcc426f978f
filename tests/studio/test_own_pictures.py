"""Pictures that are thrown away while plans are made from them, without a page."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from maulstick.errors import InputError
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.painting_file import read_painting
from maulstick.storage.files import file_sum
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.own_pictures import with_own
from maulstick.studio.state.studio import Studio
from tests.studio.test_plans import LONG, OPTIONS, until

pytestmark = pytest.mark.usefixtures("data")


@asynccontextmanager
async def opened(root: Path) -> AsyncIterator[Studio]:
    with Folder.opened(root / "studio") as folder:
        studio = Studio(folder)
        try:
            yield studio
        finally:
            await studio.close()


def put_picture(root: Path, name: str, seed: int) -> Path:
    """Put a picture of noise into the studio's folder; return its file."""
    folder = root / "studio" / "pictures" / name
    folder.mkdir(parents=True)
    pixels = np.random.default_rng(seed).integers(0, 256, (40, 40, 3), dtype=np.uint8)
    Image.fromarray(pixels).save(folder / "picture.png")
    return folder / "picture.png"


def test_a_plan_goes_on_from_its_own_copy_even_if_another_picture_has_the_name_by_then(tmp_path: Path) -> None:
    (tmp_path / "studio").mkdir()
    picture = put_picture(tmp_path, "cat", 1)
    first = file_sum(picture)

    async def plan_twice() -> Path:
        async with opened(tmp_path) as studio:
            plan = studio.plans.add(PlanRequest(picture, replace(OPTIONS, steps=LONG)))
            await until(lambda: plan.seen > 0)
            with pytest.raises(InputError, match=r"^cat is being planned from that picture; stop it first$"):
                studio.throw_picture_away("cat")
            studio.plans.stop(plan)
            await until(lambda: not plan.is_busy)
            trashed = studio.throw_picture_away("cat")
            assert (trashed / "cat" / "picture.png").is_file()
            assert studio.gallery.names() == []
            assert [(thing.where, thing.title) for thing in studio.trash.things()] == [("pictures", "cat")]
            other = put_picture(tmp_path, "cat", 2)
            assert plan.picture is not None
            assert (file_sum(plan.picture), plan.request.picture) == (first, other)
            (plan.folder / "painting.json").unlink()
            seen = plan.seen
            studio.plans.go_on(plan)
            await until(lambda: plan.seen > seen)
            studio.plans.stop(plan)
            await until(lambda: not plan.is_busy)
            studio.throw_picture_away("cat")  # the other one, which the plan is not of
            assert file_sum(plan.picture) == first
            return plan.folder / "painting.json"

    assert read_painting(asyncio.run(plan_twice())).provenance.image_sha256 == first


def test_all_pictures_that_a_plan_names_are_kept_and_no_others(tmp_path: Path) -> None:
    (tmp_path / "studio").mkdir()
    cat, look, dog = (put_picture(tmp_path, name, seed) for seed, name in enumerate(("cat", "look", "dog")))

    async def throw() -> PlanRequest:
        async with opened(tmp_path) as studio:
            plan = studio.plans.add(PlanRequest(cat, replace(OPTIONS, look=look)))
            studio.plans.stop(plan)
            await until(lambda: not plan.is_busy)
            for name in ("cat", "look", "dog"):
                studio.throw_picture_away(name)
            with pytest.raises(InputError, match="that picture is there no more; look in the trash"):
                studio.throw_picture_away("dog")
            assert dog not in plan.request.files
            return with_own(plan.request, plan.folder)

    request = asyncio.run(throw())
    own = tmp_path / "studio" / "plans" / "cat" / "own"
    assert request.files == [own / "cat" / "picture.png", own / "look" / "picture.png"]
    assert sorted(path.name for path in own.iterdir()) == ["cat", "look"]


def test_a_picture_comes_back_under_a_free_name_where_another_has_its_own(tmp_path: Path) -> None:
    (tmp_path / "studio").mkdir()
    put_picture(tmp_path, "cat", 1)

    async def put_back() -> list[str]:
        async with opened(tmp_path) as studio:
            studio.throw_picture_away("cat")
            put_picture(tmp_path, "cat", 2)
            (thing,) = studio.trash.things()
            studio.trash.put_back(thing, studio.trash.free_name(thing))
            return studio.gallery.names()

    assert sorted(asyncio.run(put_back())) == ["cat", "cat-2"]
