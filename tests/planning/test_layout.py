import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.painting.brush import Brush, load_brush
from maulstick.painting.painting import Sheet
from maulstick.painting.picture import encode_png
from maulstick.planning.layout import lay_out_for
from maulstick.storage.arrays import Image as Picture
from tests.support.nominal import nominal
from tests.support.tolerances import FILE_METRES

WIDE = Sheet(width=0.2, height=0.1)


def test_the_planning_resolution_shows_the_thinnest_mark_with_a_pixel_at_least(portrait: Picture) -> None:
    for name in ("round", "marker", "fineliner"):
        brush = load_brush(name)
        found = lay_out_for(portrait, Sheet(width=0.2, height=0.16), brush).canvas
        assert brush.thinnest * found.pixels_per_metre >= 1 - 1e-9
        assert found.height_px >= 256
        assert found.width_px <= 2048


def test_a_resolution_is_bounded_on_a_large_sheet_whatever_the_pen(portrait: Picture) -> None:
    found = lay_out_for(portrait, Sheet(width=1.0, height=0.8), nominal("fineliner")).canvas
    assert (found.width_px, found.height_px) == (2048, round(2048 * 0.8))


@pytest.mark.parametrize(("fit", "shown"), [("contain", (64, 80)), ("cover", (64, 128))])
def test_a_resolution_on_request_is_of_the_picture_s_height_on_the_sheet(
    portrait: Picture, round_brush: Brush, fit: str, shown: tuple[int, int]
) -> None:
    found = lay_out_for(portrait, WIDE, round_brush, fit, height_px=64)
    assert found.target is not None
    assert found.crop(found.target).shape == (*shown, 3)
    assert found.target.shape == (found.canvas.height_px, found.canvas.width_px, 3)


def test_what_cannot_be_laid_out_is_refused(portrait: Picture, round_brush: Brush) -> None:
    with pytest.raises(InputError, match="there is no fit 'stretch'; there are: contain, cover"):
        lay_out_for(portrait, WIDE, round_brush, "stretch", height_px=32)
    with pytest.raises(InputError, match="the height of the picture is 0 pixels; it must be at least 1"):
        lay_out_for(portrait, WIDE, round_brush, height_px=0)
    with pytest.raises(InputError, match="at most 6144 in one piece"):
        lay_out_for(portrait, WIDE, round_brush, height_px=5000)
    with pytest.raises(InputError, match="the sheet in pixels is 2048 x 1; it must be at least 2 x 2"):
        lay_out_for(portrait, Sheet(width=10.0, height=0.005), round_brush)


def test_around_the_picture_the_sheet_is_as_it_was(portrait: Picture, round_brush: Brush) -> None:
    cream = (1.0, 0.9, 0.8)
    found = lay_out_for(portrait, WIDE.model_copy(update={"paper": cream}), round_brush, height_px=40)
    assert found.target is not None
    assert found.under.shape == found.target.shape == (40, 80, 3)
    assert found.under == pytest.approx(np.broadcast_to(cream, found.under.shape))
    assert found.area == pytest.approx((0.0375, 0.0, 0.125, 0.1), abs=FILE_METRES)
    assert np.array_equal(found.target[:, :15], found.under[:, :15])
    assert np.array_equal(found.target[:, 65:], found.under[:, 65:])
    assert np.abs(found.target[:, 15:65] - found.under[:, 15:65]).mean() > 0.2


def test_a_photograph_of_the_sheet_is_what_lies_under_and_around_the_picture(
    portrait: Picture, round_brush: Brush
) -> None:
    begun = np.ones((20, 40, 3), dtype=np.float32)
    begun[:, :10] = 0.2
    sheet = WIDE.model_copy(update={"picture": encode_png(begun)})
    found = lay_out_for(portrait, sheet, round_brush, height_px=20)
    assert found.target is not None
    assert np.array_equal(found.under, begun)
    assert np.array_equal(found.target[:, :7], begun[:, :7])


def test_without_a_picture_all_of_the_sheet_is_planned(round_brush: Brush) -> None:
    found = lay_out_for(None, WIDE, round_brush, height_px=50)
    assert found.target is None
    assert found.area == (0.0, 0.0, 0.2, 0.1)
    assert (found.canvas.width_px, found.canvas.height_px) == (100, 50)
    assert found.crop(found.under).shape == (50, 100, 3)
    assert lay_out_for(None, WIDE, round_brush).canvas.height_px >= 256
