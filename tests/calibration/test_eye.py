from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from maulstick.calibration.chart import with_chart
from maulstick.calibration.colour import lamp_of, whites_of
from maulstick.calibration.eye import KIND, Eye
from maulstick.colour.srgb import colours_of, light_of
from maulstick.errors import InputError, MachineError, OutputError
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.camera import CameraError
from maulstick.robot.easel import Easel
from maulstick.robot.simulated.camera import Optics
from maulstick.storage.arrays import write_arrays
from tests.support.calibration.photo_studio import (
    CANVAS,
    CHART_CORNERS,
    PAPER,
    TAGS,
    Studio,
    bare,
    chart,
    seen_squares,
    squares,
)
from tests.support.tolerances import GREYS, MOVED, PICTURE, TURNED, WHITE

Image = NDArray[np.float32]

EASEL = Easel(corner=(0.1, 0.3, 0.0), right=(1, 0, 0), down=(0, -1, 0))
SHADES = np.repeat(np.linspace(0.1, 0.9, 12)[:, None], 3, axis=1)
PLACES = (12, 6, 110, 90, 50, 60)  # of the shades
PAINTED = squares(SHADES, *PLACES[1:])


def opened(studio: Studio) -> Eye:
    return Eye.opened(studio.camera, CANVAS, TAGS, (PAPER,) * 3)


@pytest.fixture
def studio() -> Studio:
    return Studio(bare())


@pytest.fixture
def eye(studio: Studio) -> Eye:
    """Eye that has seen the bare sheet, which has been painted since."""
    seeing = opened(studio)
    studio.sheet = PAINTED
    return seeing


def away(image: Image, painted: Image = PAINTED) -> float:
    return float(np.abs(image - painted).mean())


def test_a_bare_sheet_is_seen_in_its_own_white(studio: Studio) -> None:
    seen = opened(studio).look()
    assert seen.image.shape == (CANVAS.height_px, CANVAS.width_px, 3)
    assert np.abs(seen.image.mean(axis=(0, 1)) - PAPER).max() < WHITE
    assert (seen.shift, seen.notes) == (None, ())


def test_greys_are_true_in_every_photograph(eye: Eye) -> None:
    for _ in range(2):
        shades = seen_squares(eye.look().image, *PLACES)
        assert np.abs(shades - SHADES).max() < GREYS


def test_with_a_chart_other_colours_are_true_too(studio: Studio) -> None:
    photo, view, bare_sheet = studio.look()
    lamp = lamp_of(bare_sheet, whites_of(photo, view, TAGS), (PAPER,) * 3)
    studio.sheet = chart()
    photo, view, flat = studio.look()
    learnt, _ = with_chart(lamp, flat, whites_of(photo, view, TAGS), CANVAS, CHART_CORNERS)
    studio.sheet = bare()
    greys_only = opened(studio)
    eye = Eye.opened(studio.camera, CANVAS, TAGS, (PAPER,) * 3, learnt)
    colours = np.random.default_rng(0).uniform(0.1, 0.9, (12, 3))
    studio.sheet = squares(colours, *PLACES[1:])
    near, far = (np.abs(seen_squares(each.look().image, *PLACES) - colours).mean() for each in (eye, greys_only))
    assert near < GREYS < far


def test_one_hidden_tag_is_a_note(studio: Studio, eye: Eye) -> None:
    studio.camera.cover(2)
    seen = eye.look()
    assert seen.notes == ("tag 2 is hidden; the other three do",)
    assert away(seen.image) < PICTURE


def test_a_camera_that_does_not_move_needs_no_tags_and_misses_none(studio: Studio) -> None:
    studio.camera.cover(2)
    view = studio.look()[1]
    studio.camera.cover(0, 1, 2, 3)
    seen = Eye.opened(studio.camera, CANVAS, TAGS, (PAPER,) * 3, view=view).look()
    assert seen.notes == ()
    assert away(seen.image, bare()) < PICTURE


def test_two_hidden_tags_are_named_and_nothing_goes_on(studio: Studio, eye: Eye) -> None:
    studio.camera.cover(1, 2)
    with pytest.raises(MachineError) as caught:
        eye.look()
    assert str(caught.value) == (
        "only 2 of the 4 tags are seen (0, 3); uncover and light 1 (upper right), 2 (lower right), and go on"
    )
    studio.camera.cover()
    assert away(eye.look().image) < PICTURE


def test_a_sheet_that_has_moved_is_seen_as_it_lies_and_said(studio: Studio, eye: Eye) -> None:
    studio.camera.move_paper(0.008, -0.003, 0.01)
    for _ in range(2):
        seen = eye.look()
        assert seen.shift is not None
        assert (seen.shift.dx, seen.shift.dy) == pytest.approx((0.008, -0.003), abs=MOVED)
        assert seen.shift.dtheta == pytest.approx(0.01, abs=TURNED)
        assert seen.notes == ("the sheet has moved by 10.1 mm; painting goes on where it lies now",)
        assert away(seen.image) < PICTURE


def test_the_easel_goes_with_the_sheet(studio: Studio, eye: Eye) -> None:
    assert eye.look().easel(EASEL, CANVAS) == EASEL
    studio.camera.move_paper(0.008, -0.003, 0.01)
    easel = eye.look().easel(EASEL, CANVAS)
    middle = np.array([CANVAS.width, CANVAS.height]) / 2
    for place in ((0.0, 0.0), (CANVAS.width, 0.0), (CANVAS.width, CANVAS.height)):
        x, y = place - middle
        turned = np.array([x * np.cos(0.01) - y * np.sin(0.01), x * np.sin(0.01) + y * np.cos(0.01)])
        there = EASEL.canvas_to_machine(np.array([*(turned + middle + (0.008, -0.003)), 0.0]))
        assert easel.canvas_to_machine(np.array([*place, 0.0])) == pytest.approx(there, abs=2 * MOVED)


def test_a_sheet_that_lies_nearly_as_it_did_has_not_moved(studio: Studio, eye: Eye) -> None:
    studio.camera.move_paper(0.0003, 0.0)
    assert (eye.look().shift, eye.look().notes) == (None, ())


def test_a_sheet_that_is_far_off_is_to_be_put_back(studio: Studio, eye: Eye) -> None:
    eye.look()
    studio.camera.move_paper(0.0, 0.0, 0.3)
    with pytest.raises(MachineError, match=r"the sheet has moved by 5\d mm; put it back, and go on"):
        eye.look()
    studio.camera.move_paper(0.0, 0.0, -0.3)
    assert eye.look().shift is None


def test_a_sheet_that_is_gone_is_not_taken_to_lie_still(studio: Studio, eye: Eye) -> None:
    studio.camera.move_paper(0.4, 0.0)
    with pytest.raises(MachineError) as caught:
        eye.look()
    assert str(caught.value) == (
        "the sheet is not seen where it lay; put it back, or take away what hides it, and go on"
    )


def test_a_camera_that_is_bumped_sees_the_same(studio: Studio, eye: Eye) -> None:
    before = eye.look()
    studio.camera.bump(0.012, -0.008, 0.02)
    after = eye.look()
    assert (after.shift, after.notes) == (before.shift, ()) == (None, ())
    assert away(after.image, before.image) < PICTURE


def bed_coloured(marks: bool) -> Image:
    """A sheet that is as dark as the bed, so that its edges cannot be seen, with crosses on it or none."""
    sheet = np.empty_like(bare())
    sheet[:] = BED
    if marks:
        for y, x in ((80, 90), (300, 120), (150, 300), (90, 480), (330, 430)):
            sheet[y - 4 : y + 4, x - 30 : x + 30] = 0.95
            sheet[y - 30 : y + 30, x - 4 : x + 4] = 0.95
    return sheet


BED = (0.37, 0.30, 0.25)


def test_without_edges_a_sheet_that_has_moved_is_known_by_its_strokes_ever_after() -> None:
    studio = Studio(bed_coloured(False))
    eye = Eye.opened(studio.camera, CANVAS, TAGS, BED)
    assert eye.look().notes == (
        "neither the edges of the sheet nor anything on it can be seen, so it is taken to lie still",
    )
    studio.sheet = bed_coloured(True)
    eye.look()
    studio.camera.move_paper(0.008, 0.0)
    for _ in range(2):
        shift = eye.look().shift
        assert shift is not None
        assert (shift.dx, shift.dy) == pytest.approx((0.008, 0.0), abs=4 * MOVED)


def test_an_unplugged_camera_and_a_dark_room_say_what_to_do(studio: Studio, eye: Eye) -> None:
    studio.camera.black()
    with pytest.raises(CameraError, match="the photograph is black; take off the lens cap or switch on the light"):
        eye.look()
    studio.camera.black(off=False)
    studio.camera.unplug()
    with pytest.raises(CameraError, match="sends no picture; plug it in again, and go on"):
        eye.look()
    studio.camera.plug_in()
    assert away(eye.look().image) < PICTURE


def test_a_camera_that_does_not_move_is_refused_for_a_sheet_that_it_does_not_see_all_of(studio: Studio) -> None:
    larger = Canvas(2 * CANVAS.width, 2 * CANVAS.height, CANVAS.pixels_per_metre)
    with pytest.raises(
        InputError, match=r"corner of the sheet is at .* outside the photograph .*; let the camera see all of it"
    ):
        Eye.opened(studio.camera, larger, TAGS, (PAPER,) * 3, view=studio.look()[1])


def test_a_photograph_of_another_size_is_taken_again_as_any_that_fails(
    studio: Studio, monkeypatch: pytest.MonkeyPatch
) -> None:
    eye = Eye.opened(studio.camera, CANVAS, TAGS, (PAPER,) * 3, view=studio.look()[1])
    take = studio.camera._take
    monkeypatch.setattr(studio.camera, "_take", lambda: np.ascontiguousarray(np.rot90(take())))
    with pytest.raises(MachineError, match=r"^the photograph has 600 x 800 pixels, and .* do it again, and go on$"):
        eye.look()


@pytest.mark.parametrize("painted", [PAINTED, bare() * np.float32(0.1)], ids=["some", "all"])
@pytest.mark.parametrize("lamp", [(-0.6, 0.4, 3.0), (-0.6, 0.4, 8.0), (0.0, 0.0, 20.0)])
@pytest.mark.parametrize(("gain", "is_seen"), [(1.3, True), (2.0, False), (4.0, False)])
def test_light_that_has_grown_too_bright_stops_painting_however_even_it_is(
    monkeypatch: pytest.MonkeyPatch, gain: float, is_seen: bool, lamp: tuple[float, float, float], painted: Image
) -> None:
    studio = Studio(bare(), optics=Optics(size=(800, 600), lamp=lamp))
    eye = opened(studio)
    studio.sheet = painted
    take = studio.camera._take
    monkeypatch.setattr(studio.camera, "_take", lambda: colours_of(np.float32(gain) * light_of(take())))
    if is_seen:
        assert away(eye.look().image, painted) < PICTURE
        return
    with pytest.raises(MachineError) as caught:
        eye.look()
    assert str(caught.value) == (
        "the photograph is overexposed; lower the camera's exposure or dim the lamp, and go on"
    )


def test_it_opens_only_over_a_sheet_with_its_tags_that_is_bare(studio: Studio) -> None:
    studio.sheet = np.where(np.arange(CANVAS.width_px)[:, None] % 90 < 40, np.float32(0.1), bare())
    with pytest.raises(InputError, match="photograph it bare and whole"):
        opened(studio)
    studio.camera.cover(0, 1, 2, 3)
    with pytest.raises(InputError, match="none of the 4 tags is seen; uncover and light 0"):
        opened(studio)


def test_an_eye_is_written_and_opened_again_and_still_knows_where_the_sheet_lay(
    studio: Studio, eye: Eye, tmp_path: Path
) -> None:
    eye.write(tmp_path / "eye.npz")
    again = Eye.opened_again(studio.camera, CANVAS, TAGS, tmp_path / "eye.npz")
    assert away(again.look().image) < PICTURE
    studio.camera.move_paper(0.008, 0.0)
    shift = again.look().shift
    assert shift is not None
    assert (shift.dx, shift.dy) == pytest.approx((0.008, 0.0), abs=MOVED + 0.5 / 255 / CANVAS.pixels_per_metre)


def test_an_eye_that_is_not_there_of_another_sheet_or_damaged_is_one_sentence(
    studio: Studio, eye: Eye, tmp_path: Path
) -> None:
    path = tmp_path / "eye.npz"
    with pytest.raises(OutputError):
        eye.write(tmp_path / "none" / "eye.npz")
    with pytest.raises(InputError, match="there is no eye"):
        Eye.opened_again(studio.camera, CANVAS, TAGS, path)
    eye.write(path)
    with pytest.raises(InputError, match="is of a sheet of another size; begin again on a bare one"):
        Eye.opened_again(studio.camera, Canvas(0.1, 0.1, 2000), TAGS, path)
    start = np.zeros((CANVAS.height_px + 60, CANVAS.width_px + 60, 3), dtype=np.uint8)
    write_arrays(path, KIND, {"colours": np.array('{"lamp": 3}'), "start": start})
    with pytest.raises(InputError, match=r"is damaged: lamp: .*; begin again on a bare sheet"):
        Eye.opened_again(studio.camera, CANVAS, TAGS, path)
    path.write_bytes(b"PK\x03\x04 and nothing more")
    with pytest.raises(InputError, match="is not a file of eye, or it is damaged"):
        Eye.opened_again(studio.camera, CANVAS, TAGS, path)
