import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from maulstick.colour.srgb import light_of
from maulstick.errors import InputError
from maulstick.painting.edit import NO_EDIT, TURNS, WHOLE, Crop, PictureEdit
from maulstick.storage.arrays import Pixels
from tests.support.tolerances import FLOAT32_VALUE

PICTURES = st.tuples(st.integers(1, 9), st.integers(1, 9)).flatmap(
    lambda shape: arrays(np.float32, (*shape, 3), elements=st.floats(0, 1, width=32))
)
EDGES = st.tuples(st.floats(0, 1), st.floats(0, 1)).map(sorted).filter(lambda edges: edges[0] < edges[1])
CROPS = st.tuples(EDGES, EDGES).map(lambda edges: (edges[0][0], edges[1][0], edges[0][1], edges[1][1]))
EDITS = st.builds(
    PictureEdit,
    rotate=st.sampled_from(TURNS),
    straighten=st.floats(-15, 15),
    crop=CROPS,
    exposure=st.floats(-5, 5),
    contrast=st.floats(0.1, 10),
)


@given(PICTURES)
def test_no_edit_and_the_whole_as_crop_leave_every_bit(picture: Pixels) -> None:
    assert NO_EDIT.applied(picture).tobytes() == picture.tobytes()
    assert PictureEdit(crop=WHOLE).applied(picture).shape == picture.shape


@given(PICTURES, EDITS)
def test_what_an_edit_leaves_is_a_picture_of_the_shape_that_it_tells(picture: Pixels, edit: PictureEdit) -> None:
    edited = edit.applied(picture)
    assert edited.shape == (*edit.shape(picture.shape), 3)
    assert edited.dtype == np.float32
    assert edited.min() >= 0
    assert edited.max() <= 1


@given(PICTURES, EDITS)
def test_what_is_cut_out_of_a_straightened_picture_is_what_straightening_all_of_it_leaves_there(
    picture: Pixels, edit: PictureEdit
) -> None:
    of_place = replace(edit, exposure=0.0, contrast=1.0)
    assert of_place.applied(picture) == pytest.approx(edit.cut(edit.turned(picture)), abs=FLOAT32_VALUE)


@given(PICTURES, st.sampled_from([90, 180, 270]))
def test_four_turns_are_none(picture: Pixels, degrees: int) -> None:
    turned = picture
    for _ in range(4):
        turned = PictureEdit(rotate=degrees).applied(turned)
    assert turned.tobytes() == picture.tobytes()


def test_a_quarter_turn_is_clockwise() -> None:
    picture = np.zeros((2, 3, 3), np.float32)
    picture[0, 0] = 1  # the upper left corner
    turned = PictureEdit(rotate=90).applied(picture)
    assert turned.shape == (3, 2, 3)
    assert turned[0, 1].tolist() == [1, 1, 1]  # becomes the upper right one


@given(PICTURES, CROPS)
def test_a_crop_is_a_part_of_the_picture_and_has_a_pixel_at_least(picture: Pixels, crop: Crop) -> None:
    height, width = picture.shape[:2]
    kept = PictureEdit(crop=crop).applied(picture)
    assert min(kept.shape) >= 1
    left, top = min(round(crop[0] * width), width - 1), min(round(crop[1] * height), height - 1)
    assert (kept == picture[top : top + kept.shape[0], left : left + kept.shape[1]]).all()


@given(CROPS, st.integers(1, 500))
def test_a_picture_is_read_so_finely_that_its_crop_has_as_many_pixels_on_either_side(crop: Crop, pixels: int) -> None:
    side = PictureEdit(crop=crop).read_px(pixels)
    kept = PictureEdit(crop=crop).shape((side, side))
    assert min(kept) >= pixels - 1 or side == 100_000_000  # edges fall on pixels; no picture has longer sides
    assert PictureEdit(crop=WHOLE).read_px(pixels) == pixels


def test_a_crop_is_of_the_picture_as_it_is_turned() -> None:
    picture = np.zeros((4, 8, 3), np.float32)
    picture[0, 7] = 1
    assert PictureEdit(crop=(0.5, 0, 1, 0.5)).applied(picture)[0, 3, 0] == 1
    assert PictureEdit(rotate=90, crop=(0.5, 0.5, 1, 1)).applied(picture)[3, 1, 0] == 1


@given(arrays(np.float32, (2, 2, 3), elements=st.floats(0, 1, width=32)))
def test_a_stop_doubles_the_light_until_it_is_white(picture: Pixels) -> None:
    lighter = light_of(PictureEdit(exposure=1).applied(picture).astype(np.float64))
    assert lighter == pytest.approx((2 * light_of(picture.astype(np.float64))).clip(0, 1), abs=FLOAT32_VALUE)


@given(PICTURES, st.floats(-5, 5))
def test_exposure_keeps_what_is_lighter_lighter(picture: Pixels, stops: float) -> None:
    order = picture.ravel().argsort(kind="stable")
    assert (np.diff(PictureEdit(exposure=stops).applied(picture).ravel()[order]) >= -FLOAT32_VALUE).all()


@given(st.floats(0.1, 10))
def test_contrast_leaves_mid_grey_and_moves_what_is_off_it(times: float) -> None:
    picture = np.array([0.5, 0.45, 0.55], np.float32).reshape(1, 1, 3)
    grey, darker, lighter = PictureEdit(contrast=times).applied(picture).ravel().tolist()
    assert grey == 0.5
    assert 0.5 - darker == pytest.approx(min(0.05 * times, 0.5), abs=FLOAT32_VALUE)
    assert lighter - 0.5 == pytest.approx(min(0.05 * times, 0.5), abs=FLOAT32_VALUE)


@pytest.mark.parametrize("degrees", [-15, -3.5, 2, 15])
def test_straightening_turns_about_the_middle_and_leaves_no_empty_corner(degrees: float) -> None:
    down, across = np.mgrid[:101, :161].astype(np.float32)
    line = (np.abs(down - 50) < 2).astype(np.float32)
    turned = PictureEdit(straighten=degrees).applied(np.repeat(line[..., None], 3, axis=2))
    y = (turned[..., 0] * down).sum(axis=0) / turned[..., 0].sum(axis=0)
    assert np.polyfit(across[0, 10:-10], y[10:-10], 1)[0] == pytest.approx(np.tan(np.radians(degrees)), abs=0.02)
    assert PictureEdit(straighten=degrees).applied(np.ones((40, 70, 3), np.float32)).min() > 0.99


@given(EDITS)
def test_an_edit_comes_back_from_the_options_in_a_file(edit: PictureEdit) -> None:
    options = json.loads(json.dumps({"strokes": 4, **vars(edit)}))
    assert PictureEdit.of(options) == edit
    assert PictureEdit.of({"strokes": 4}) == NO_EDIT


@pytest.mark.parametrize(
    ("given_", "said"),
    [
        ({"rotate": 45}, "rotate is 45; it must be 0, 90, 180 or 270"),
        ({"straighten": 16}, "straighten is 16; it must be from -15 to 15"),
        ({"exposure": float("nan")}, "exposure is nan; it must be from -5 to 5"),
        ({"contrast": 0}, "contrast is 0; it must be from 0.1 to 10"),
        ({"crop": (0.5, 0, 0.5, 1)}, "crop is 0.5,0,0.5,1; it must be the left, top, right and lower edge"),
        ({"crop": (0, 0, 1.1, 1)}, "as shares of the picture from 0 to 1, as in 0.1,0,0.9,1"),
        ({"crop": "all"}, "crop is 'all'; it must be"),
    ],
)
def test_an_edit_that_cannot_be_is_refused(given_: dict[str, object], said: str) -> None:
    with pytest.raises(InputError) as caught:
        PictureEdit.of(given_)
    assert said in str(caught.value)
