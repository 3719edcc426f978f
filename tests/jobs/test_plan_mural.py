"""Pictures of murals, as fine as the canvas."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import maulstick as ms
from maulstick.errors import InputError
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.picture import READ_PX

STRIPES = np.zeros((6000, 60, 3), dtype=np.uint8)
STRIPES[::2] = 255
OPTIONS = PlanOptions(size="5x500mm", px=len(STRIPES), strokes=5, steps=1, device="cpu")


def test_a_mural_is_planned_from_as_much_of_its_picture_as_its_canvas_shows(tmp_path: Path) -> None:
    Image.fromarray(STRIPES).save(tmp_path / "stripes.png")
    mural = prepare(PlanRequest(tmp_path / "stripes.png", OPTIONS)).mural
    assert mural is not None
    assert mural.target((0, 5000, 60, 5010))[:, 30, 0] == pytest.approx([1, 0] * 5, abs=0.01)


@pytest.mark.parametrize("shape", [(1000, 8000), (8000, 1000)])
def test_a_long_picture_is_read_as_finely_as_its_canvas(tmp_path: Path, shape: tuple[int, int]) -> None:
    columns = np.zeros((*shape, 3), dtype=np.uint8)
    columns[:, ::2] = 255
    Image.fromarray(columns).save(tmp_path / "columns.png")
    size = f"{shape[1] / 20:g}x{shape[0] / 20:g}mm"
    mural = prepare(PlanRequest(tmp_path / "columns.png", replace(OPTIONS, size=size, px=shape[0]))).mural
    assert mural is not None
    assert mural.target((500, 500, 510, 510))[5, :, 0] == pytest.approx([1, 0] * 5, abs=0.01)


def test_a_picture_in_memory_is_as_fine(monkeypatch: pytest.MonkeyPatch) -> None:
    shapes: list[tuple[int, ...]] = []

    def stop(request: PlanRequest, image: np.ndarray[tuple[int, ...], np.dtype[np.float32]], **_: object) -> None:
        shapes.append(image.shape)
        raise InputError("seen")

    monkeypatch.setattr("maulstick.api.planning.prepare", stop)
    wide = STRIPES.swapaxes(0, 1)
    for picture, options in ((STRIPES, OPTIONS), (STRIPES, PlanOptions()), (wide, PlanOptions(px=60))):
        with pytest.raises(InputError, match="seen"):
            ms.plan(picture, options=options)
    assert shapes == [STRIPES.shape, (READ_PX, 41, 3), wide.shape]


@pytest.mark.parametrize(("px", "read"), [(None, READ_PX), (2048, READ_PX), (8192, 16384)])
def test_a_picture_is_read_at_twice_the_height_of_the_canvas_or_more(px: int | None, read: int) -> None:
    assert PlanOptions(px=px).read_px == read
