"""Corrections of a picture, in all that sees the picture of a plan."""

from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest
from PIL import Image

import maulstick as ms
from maulstick.errors import InputError
from maulstick.jobs.paint import camera_loop
from maulstick.jobs.paint.camera_loop import replanned
from maulstick.jobs.plan.inputs import picture_of
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.prepared import Prepared
from maulstick.jobs.plan.request import PlanRequest, demo_picture
from maulstick.painting.edit import PictureEdit
from maulstick.painting.painting import Painting
from maulstick.painting.picture import READ_PX, read_picture
from maulstick.planning.layout import Layout
from maulstick.rendering.likeness import likeness

EDIT = {"rotate": 90, "straighten": 4.0, "crop": (0.1, 0.3, 0.7, 0.9), "exposure": -0.5, "contrast": 1.3}
PLAN = {"strokes": 12, "exact": True, "paints": 2, "steps": 4, "px": 32, "brush": "marker", "margin": "10mm"}
QUICK = PlanOptions(**PLAN, **EDIT)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def prepared() -> Prepared:
    return prepare(PlanRequest(demo_picture(), QUICK))


@pytest.fixture(scope="module")
def painting(prepared: Prepared) -> Painting:
    return prepared.painting(prepared.plan(lambda progress: True, None))


def test_a_plan_is_that_of_the_corrected_picture_with_the_same_metrics(painting: Painting) -> None:
    before = read_picture(demo_picture(), READ_PX)
    corrected = PictureEdit.of(EDIT).applied(before)
    assert corrected.shape != before.shape
    beside = ms.plan(corrected, **PLAN)  # type: ignore[arg-type]
    assert beside.strokes == painting.strokes
    assert beside.provenance.metrics == painting.provenance.metrics


@pytest.mark.parametrize(("px", "kept"), [(None, (3, 4096)), (3000, (4, 5120))])
@pytest.mark.parametrize("rotate", [0, 90])
def test_what_a_crop_keeps_is_read_as_finely_as_its_file_and_the_canvas_are(
    tmp_path: Path, px: int | None, kept: tuple[int, int], rotate: int
) -> None:
    Image.new("RGB", (20480, 8)).save(tmp_path / "wide.png")
    crop = (0.5, 0.5, 0.75, 1) if rotate == 0 else (0.5, 0.5, 1, 0.75)
    options = PlanOptions(rotate=rotate, crop=crop, px=px)
    picture = picture_of(PlanRequest(tmp_path / "wide.png", options), None)
    assert picture is not None
    assert picture.shape[:2] == (kept if rotate == 0 else kept[::-1])
    assert picture.base is None  # the rest is not kept in memory


@pytest.mark.parametrize(
    ("options", "high"),
    [
        ({}, 1600),
        ({"px": 512}, 1536),
        ({"px": 512, "size": "100x300mm-auto"}, 1536),
        ({"px": 512, "fit": "contain"}, 800),
    ],
)
def test_a_picture_that_covers_a_sheet_of_another_shape_is_read_as_finely_as_the_canvas_is(
    tmp_path: Path, options: dict[str, Any], high: int
) -> None:
    Image.new("L", (8192, 1600)).save(tmp_path / "wide.png")
    asked = PlanOptions(**{"size": "300x100mm", "fit": "cover", **options})
    picture = picture_of(PlanRequest(tmp_path / "wide.png", asked), None)
    assert picture is not None
    assert picture.shape[0] == high


def test_a_crop_is_compared_with_all_of_its_pixels(tmp_path: Path, painting: Painting) -> None:
    fine = np.random.default_rng(0).integers(0, 2, (8, 8192, 3), np.uint8) * 255
    Image.fromarray(fine).save(tmp_path / "fine.png")
    options = {**painting.provenance.options, "crop": [0.0, 0.0, 0.01, 1.0], "straighten": 0.0}
    provenance = painting.provenance.model_copy(update={"options": options})
    small = painting.model_copy(update={"provenance": provenance})
    assert ms.compare(small, tmp_path / "fine.png") == likeness(small, read_picture(tmp_path / "fine.png"))


def test_its_provenance_has_the_photograph_and_the_corrections(painting: Painting) -> None:
    made = painting.provenance
    assert made.image == demo_picture().name
    assert PictureEdit.of(made.options) == PictureEdit.of(EDIT)
    assert made.options["margin"] == "10mm"


def test_it_is_compared_with_the_corrected_picture(painting: Painting) -> None:
    plain = painting.provenance.model_copy(update={"options": {}})
    found = ms.compare(painting, demo_picture())
    assert found.psnr == pytest.approx(painting.provenance.metrics["psnr"], abs=1)  # on other pixels
    assert found.psnr != ms.compare(painting.model_copy(update={"provenance": plain}), demo_picture()).psnr


def test_what_is_left_is_planned_again_from_the_corrected_picture_within_the_margin(
    painting: Painting, prepared: Prepared, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[Layout] = []

    def stop(layout: Layout, *_: object, **__: object) -> NoReturn:
        seen.append(layout)
        raise InterruptedError

    monkeypatch.setattr(camera_loop, "problem_of", stop)
    sheet = np.ones((32, 40, 3), np.float32)
    with pytest.raises(InterruptedError):
        replanned(painting, {painting.strokes[0].id}, sheet, read_picture(demo_picture(), READ_PX))
    assert seen[0].room == prepared.layout.room is not None
    assert seen[0].target == pytest.approx(prepared.layout.target)


def test_a_request_keeps_the_corrections_and_those_of_earlier_versions_have_none(tmp_path: Path) -> None:
    request = PlanRequest(demo_picture(), QUICK)
    plain = request.as_json()
    assert PlanRequest.from_json(plain, tmp_path) == request
    options: Any = plain["options"]
    for name in (*EDIT, "margin"):
        del options[name]
    before = PlanRequest.from_json(plain, tmp_path).options
    assert before.edit == PictureEdit()
    assert before.margin == "0mm"


@pytest.mark.parametrize("shape", [(40, 60), (60, 40), (50, 50)])
def test_a_sheet_is_turned_as_the_picture_is_after_its_corrections(tmp_path: Path, shape: tuple[int, int]) -> None:
    Image.new("RGB", shape[::-1], "grey").save(tmp_path / "grey.png")
    for rotate in (0, 90):
        options = PlanOptions(size="200x160mm-auto", rotate=rotate, px=32)
        sheet = prepare(PlanRequest(tmp_path / "grey.png", options)).layout.sheet
        height, width = shape if rotate == 0 else shape[::-1]
        assert (sheet.width, sheet.height) == ((0.16, 0.2) if height > width else (0.2, 0.16))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"crop": (0, 0, 0.5, 1), "text": "a boat"}, "crop corrects a picture, and there is none; name one, or leave"),
        ({"contrast": 2.0, "text": "a boat"}, "contrast corrects a picture, and there is none"),
    ],
)
def test_corrections_of_no_picture_are_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as caught:
        prepare(PlanRequest(None, PlanOptions(**given)))
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"margin": "80mm"}, "margin is 80mm; it must be at most 77.5mm on a sheet of 200 x 160 mm"),
        ({"margin": "10"}, "'10' is not a length; write a number and a unit"),
        ({"exposure": 9}, "exposure is 9; it must be from -5 to 5"),
        (
            {"size": "A4-auto", "background": "sheet.jpg"},
            "background shows how the sheet lies, and size A4-auto turns it as the picture; leave out -auto",
        ),
    ],
)
def test_margins_and_sheets_that_cannot_be_are_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as caught:
        PlanOptions(**given)
    assert str(caught.value).startswith(said)
