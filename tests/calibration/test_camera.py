import json
import re
from pathlib import Path

import numpy as np
import pytest

from maulstick.calibration.camera import CameraView, locate, read_view, view_of_corners, write_view
from maulstick.calibration.tags import found_tags
from maulstick.errors import InputError
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.opencv import opencv
from maulstick.robot.camera.tag_frame import TagFrame
from maulstick.robot.simulated.camera import Optics
from tests.support.calibration.photo_studio import CANVAS, TAGS, Studio, bare, dots, seen_dots
from tests.support.tolerances import (
    RECTIFIED,
    RECTIFIED_ASKED,
    RECTIFIED_SMALL,
    RECTIFIED_WORST,
    ROUND_TRIP,
    TONES,
)


def _misses(studio: Studio, middles: np.ndarray) -> tuple[np.ndarray, CameraView]:
    _, view, flat = studio.look()
    return np.linalg.norm(seen_dots(flat, middles) - middles, axis=1), view


def test_a_photograph_is_made_flat_to_less_than_a_third_of_a_millimetre_and_says_how_well() -> None:
    sheet, middles = dots()
    misses, view = _misses(Studio(sheet, 1, Optics()), middles)
    rms = np.sqrt(np.mean(misses**2))
    assert rms < RECTIFIED
    assert misses.max() < RECTIFIED_WORST < RECTIFIED_ASKED
    assert view.error is not None
    assert rms / 3 < view.error[0] < 3 * rms
    assert view.error[0] < view.error[1] < RECTIFIED_ASKED
    assert view.hidden == ()


@pytest.mark.parametrize("bend", [(0.0, 0.0), (-0.2, 0.05)])
def test_lenses_that_bend_much_or_not_at_all_are_seen_through(bend: tuple[float, float]) -> None:
    sheet, middles = dots()
    misses, _ = _misses(Studio(sheet, 3, Optics(size=(800, 600), bend=bend)), middles)
    assert misses.max() < RECTIFIED_SMALL


@pytest.mark.parametrize("hidden", [0, 2])
def test_three_tags_do_and_the_hidden_one_is_named(hidden: int) -> None:
    sheet, middles = dots()
    studio = Studio(sheet)
    studio.camera.cover(hidden)
    misses, view = _misses(studio, middles)
    assert view.hidden == (hidden,)
    assert misses.max() < RECTIFIED_ASKED
    assert view.error is not None
    assert np.sqrt(np.mean(misses**2)) < 3 * view.error[0]


def test_with_fewer_tags_it_is_said_which_to_uncover() -> None:
    studio = Studio(bare())
    studio.camera.cover(0, 2)
    with pytest.raises(
        InputError, match=r"^only 2 of the 4 tags are seen \(1, 3\); uncover and light 0 \(upper left\)"
    ):
        studio.look()
    studio.camera.cover(1, 2, 3)
    with pytest.raises(InputError, match=r"^only 1 of the 4 tags is seen \(0\); uncover and light 1 \(upper right\)"):
        studio.look()
    studio.camera.cover(0, 1, 2, 3)
    with pytest.raises(InputError, match=r"^none of the 4 tags is seen; uncover and light 0"):
        studio.look()


def test_tags_that_are_there_twice_are_not_to_be_uncovered() -> None:
    photo = Studio(bare()).camera.photograph()
    with pytest.raises(InputError) as caught:
        locate(np.concatenate([photo, photo], axis=1), TAGS)
    assert str(caught.value) == (
        "more than one tag 0 (upper left) is seen; take away all but the four tags at the corners of the sheet"
    )


def test_a_mirrored_photograph_is_told_from_one_without_tags() -> None:
    photo = Studio(bare()).camera.photograph()
    with pytest.raises(InputError, match=r"^the photograph is mirrored; turn that off"):
        locate(photo[:, ::-1], TAGS)
    with pytest.raises(InputError, match=r"^none of the 4 tags is seen"):
        locate(np.full_like(photo, 0.5), TAGS)


def test_tags_that_lie_elsewhere_than_they_should_are_refused() -> None:
    photo = Studio(bare()).camera.photograph()
    assert sorted(found_tags(photo)) == [0, 1, 2, 3]
    with pytest.raises(InputError, match=r"mm off its place beside a sheet of 297 x 210 mm and tags of 30 mm"):
        locate(photo, TagFrame(CANVAS.width, CANVAS.height, side=30e-3))
    with pytest.raises(InputError, match=r"mm off its place beside a sheet of 210 x 297 mm and tags of 20 mm"):
        locate(photo, TagFrame(CANVAS.height, CANVAS.width))


def test_a_camera_that_was_knocked_sees_the_sheet_where_it_is() -> None:
    sheet, middles = dots()
    studio = Studio(sheet)
    _, before = _misses(studio, middles)
    studio.camera.bump(0.004, -0.003, 0.02)
    misses, after = _misses(studio, middles)
    assert misses.max() < RECTIFIED_SMALL
    assert np.linalg.norm(before.to_photo(middles) - after.to_photo(middles), axis=1).min() > 1


def test_a_sheet_that_reaches_out_of_the_photograph_is_refused() -> None:
    """It hangs by one corner, which is cut off; the other three tags would say where it is."""
    photo = np.pad(Studio(bare()).camera.photograph(), ((250, 250), (150, 150), (0, 0)))
    hung = opencv().warpAffine(photo, opencv().getRotationMatrix2D((550, 550), 45, 1.0), (1100, 1100))
    assert locate(hung, TAGS).tags == (0, 1, 2, 3)
    with pytest.raises(InputError) as caught:
        locate(hung[:800], TAGS)
    assert re.fullmatch(
        r"the lower left corner of the sheet is at \d+,\d+, outside the photograph of 1100 x 800 pixels; "
        "let the camera see all of it",
        str(caught.value),
    )


def test_places_and_pixels_are_each_others_inverse() -> None:
    _, view, _ = Studio(bare()).look()
    places = np.random.default_rng(0).uniform(-0.03, 0.3, (5, 7, 2))
    np.testing.assert_allclose(view.to_canvas(view.to_photo(places)), places, atol=ROUND_TRIP)


def test_a_flat_photograph_has_the_tones_of_the_picture_whatever_its_resolution() -> None:
    down, across = np.mgrid[: CANVAS.height_px, : CANVAS.width_px]
    fine = ((down + across) % 2 * 0.6 + 0.2).astype(np.float32)[..., None].repeat(3, axis=2)
    view = view_of_corners(
        np.array([[40, 30], [560, 30], [560, 400], [40, 400]], dtype=float),
        (0.297, 0.210),
        (CANVAS.width_px, CANVAS.height_px),
    )
    coarse = view.rectify(fine, Canvas(0.297, 0.210, 200))
    assert coarse.shape == (42, 59, 3)
    assert np.abs(coarse - 0.5).mean() < TONES


def test_a_margin_adds_whole_pixels_around_the_same_sheet() -> None:
    photo, view, flat = Studio(dots()[0]).look()
    wide = view.rectify(photo, CANVAS, 0.010)
    assert wide.shape == (CANVAS.height_px + 40, CANVAS.width_px + 40, 3)
    np.testing.assert_allclose(wide[20:-20, 20:-20], flat, atol=1e-3)


def test_a_photograph_of_another_size_is_refused() -> None:
    _, view, _ = Studio(bare()).look()
    with pytest.raises(InputError, match=r"^the photograph has 80 x 60 pixels, and .* with 800 x 600; do it again$"):
        view.rectify(np.zeros((60, 80, 3), dtype=np.float32), CANVAS)


def test_clicked_corners_are_the_sheets_corners_and_their_error_is_unknown() -> None:
    corners = np.array([[100, 80], [700, 100], [680, 520], [90, 500]], dtype=float)
    view = view_of_corners(corners, (0.297, 0.210), (800, 600))
    sheet = np.array([[0, 0], [0.297, 0], [0.297, 0.210], [0, 0.210]])
    np.testing.assert_allclose(view.to_canvas(corners), sheet, atol=1e-6)
    assert view.error is None
    assert view.hidden == ()


@pytest.mark.parametrize("order", [(1, 0, 3, 2), (0, 2, 1, 3), (0, 0, 2, 3)])
def test_corners_that_do_not_go_round_the_sheet_are_refused(order: tuple[int, ...]) -> None:
    corners = np.array([[100, 80], [700, 100], [680, 520], [90, 500]], dtype=float)
    with pytest.raises(InputError, match=r"upper left, upper right, lower right, lower left; give them so$"):
        view_of_corners(corners[list(order)], (0.297, 0.210), (800, 600))


def test_a_view_survives_its_file_and_another_file_is_refused(tmp_path: Path) -> None:
    _, view, _ = Studio(bare()).look()
    write_view(view, tmp_path / "camera.json")
    assert read_view(tmp_path / "camera.json") == view
    (tmp_path / "other.json").write_text('{"size": [800, 600]}')
    with pytest.raises(InputError, match="is not a camera's view: homography"):
        read_view(tmp_path / "other.json")


@pytest.mark.parametrize("row", [[0, 0, 0], [2, 0, 0]])
def test_a_view_that_shows_the_sheet_as_a_line_is_refused(tmp_path: Path, row: list[float]) -> None:
    view = {"size": [800, 600], "homography": [[1, 0, 0], row, [0, 0, 1]]}
    (tmp_path / "camera.json").write_text(json.dumps(view))
    with pytest.raises(InputError, match="homography: it shows the sheet as a line; look at the sheet again"):
        read_view(tmp_path / "camera.json")
