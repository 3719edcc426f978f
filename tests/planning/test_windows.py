from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.painting.fit import lay_out
from maulstick.painting.painting import Sheet
from maulstick.painting.picture import encode_png
from maulstick.painting.raster import Canvas
from maulstick.planning.mural.windows import Box, Mural, Windows, enlarged
from maulstick.storage.arrays import Image as Picture
from tests.support.tolerances import FLOAT32_VALUE


@pytest.fixture(scope="module")
def sheet() -> Sheet:
    """A sheet with something painted on it already."""
    y, x = np.mgrid[:30, :40] / 30
    picture = np.stack([0.5 + 0.3 * np.sin(4 * x), 0.5 + 0.3 * np.cos(5 * y), x * y / 2], axis=2).astype(np.float32)
    return Sheet(width=0.2, height=0.15, picture=encode_png(picture))


@pytest.mark.parametrize("fit", ["contain", "cover"])
@pytest.mark.parametrize(("finer", "margin"), [(1, 0), (8, 0), (1, 0.02), (8, 0.0213)])
def test_parts_of_a_mural_are_those_of_the_picture_laid_out_whole(
    portrait: Picture, sheet: Sheet, finer: int, margin: float, fit: str
) -> None:
    picture = np.repeat(np.repeat(portrait[:, :50], finer, axis=0), finer, axis=1)
    mural = Mural(picture, sheet, Canvas(0.2, 0.15, 1000), fit, margin)
    under = sheet.image(mural.canvas)
    target, _ = lay_out(mural.picture, mural.canvas, fit, under, margin)
    for box in ((0, 0, 200, 150), (0, 0, 60, 150), (30, 40, 130, 120), (150, 90, 200, 150)):
        rows, columns = slice(box[1], box[3]), slice(box[0], box[2])
        assert mural.under(box) == pytest.approx(under[rows, columns], abs=FLOAT32_VALUE)
        assert mural.target(box) == pytest.approx(target[rows, columns], abs=FLOAT32_VALUE)


def test_a_part_beside_the_picture_shows_the_sheet(portrait: Picture) -> None:
    mural = Mural(portrait, Sheet(width=0.4, height=0.1, paper=(0.2, 0.4, 0.6)), Canvas(0.4, 0.1, 500))
    beside = mural.target((0, 0, 40, 50))
    assert beside.reshape(-1, 3) == pytest.approx(np.tile((0.2, 0.4, 0.6), (2000, 1)))
    assert np.ptp(mural.target((80, 0, 120, 50))) > 0.5


@pytest.mark.parametrize("size", [(0.2, 0.15), (0.1004, 0.1006)])
def test_a_part_has_its_pixels_and_ends_where_the_sheet_does(portrait: Picture, size: tuple[float, float]) -> None:
    mural = Mural(portrait, Sheet(width=size[0], height=size[1]), Canvas(*size, 1000))
    right, bottom = mural.canvas.width_px, mural.canvas.height_px
    found = mural.part((60, 70, right, bottom))
    assert (found.width_px, found.height_px) == (right - 60, bottom - 70)
    assert found.width + 0.06 <= size[0] + 1e-12
    assert found.height + 0.07 <= size[1] + 1e-12


def test_a_part_has_its_pixels_where_the_sheet_ends_in_the_middle_of_one(portrait: Picture) -> None:
    for height_px in range(2049, 2099, 2):
        mural = Mural(portrait, Sheet(width=0.3, height=0.2), Canvas(0.3, 0.2, height_px / 0.2))
        right = mural.canvas.width_px
        for left in (2000, 2001):
            assert mural.part((left, 0, right, height_px)).width_px == right - left


def test_an_overview_is_the_whole_sheet_and_never_finer_than_the_mural(portrait: Picture) -> None:
    mural = Mural(portrait, Sheet(width=0.2, height=0.15), Canvas(0.2, 0.15, 1000))
    small = mural.overview(40)
    assert small.under.shape == (30, 40, 3)
    assert small.canvas.width == 0.2
    assert mural.overview(500).under.shape == (150, 200, 3)


def test_cores_tile_the_canvas_and_windows_stay_on_it() -> None:
    canvas = Canvas(0.205, 0.1, 1000)
    windows = Windows.of(canvas, 60, 7)
    assert len(windows) == 4 * 2
    y, x = np.mgrid[:100, :205] + 0.5
    owner = windows.owner(x, y)
    for index in range(len(windows)):
        left, top, right, bottom = windows.box(index)
        rows, columns = np.nonzero(owner == index)
        assert left == max(columns.min() - 7, 0)
        assert top == max(rows.min() - 7, 0)
        assert right == min(columns.max() + 8, 205)
        assert bottom == min(rows.max() + 8, 100)
        assert np.ptp(columns) < 60
        assert np.ptp(rows) < 60
        assert len(rows) == (np.ptp(rows) + 1) * (np.ptp(columns) + 1)


def apart(one: Box, other: Box) -> bool:
    return one[2] < other[0] or other[2] < one[0] or one[3] < other[1] or other[3] < one[1]


@given(width=st.integers(2, 900), height=st.integers(2, 900), core=st.integers(20, 400), margin=st.integers(0, 500))
def test_each_window_is_in_one_round_in_which_no_box_touches_another(
    width: int, height: int, core: int, margin: int
) -> None:
    windows = Windows.of(Canvas(width / 1000, height / 1000, 1000), core, margin)
    rounds = windows.rounds()
    assert sorted(index for each in rounds for index in each) == list(range(len(windows)))
    for each in rounds:
        assert each == sorted(each)
        assert all(apart(windows.box(one), windows.box(other)) for one, other in combinations(each, 2))


def test_windows_wider_than_their_margins_are_planned_in_four_rounds_by_even_and_odd_rows_and_columns() -> None:
    windows = Windows.of(Canvas(0.4, 0.3, 1000), 100, 49)
    assert windows.rounds() == [[0, 2, 8, 10], [1, 3, 9, 11], [4, 6], [5, 7]]


def test_margins_wider_than_half_a_core_take_more_rounds() -> None:
    windows = Windows.of(Canvas(0.5, 0.1, 1000), 100, 50)
    assert windows.rounds() == [[0, 3], [1, 4], [2]]


def test_a_place_beside_the_canvas_belongs_to_the_nearest_core() -> None:
    windows = Windows.of(Canvas(0.2, 0.1, 1000), 100, 5)
    assert windows.owner(np.array([-3.0, 203.0]), np.array([50.0, 120.0])).tolist() == [0, 1]


def test_a_field_keeps_its_places_when_it_is_enlarged() -> None:
    canvas = Canvas(0.2, 0.1, 1000)
    x = (np.arange(20) + 0.5) / 20
    field = np.tile(x, (10, 1))
    found = enlarged(field, canvas, (50, 20, 150, 80))
    assert found.shape == (60, 100)
    inner = (np.arange(50, 150) + 0.5)[10:-10] / 200
    assert found[30, 10:-10] == pytest.approx(inner, abs=1e-6)


def test_a_fit_that_is_none_is_refused(portrait: Picture) -> None:
    with pytest.raises(InputError, match="there is no fit 'stretch'; there are: contain, cover"):
        Mural(portrait, Sheet(width=0.2, height=0.1), Canvas(0.2, 0.1, 100), "stretch")
