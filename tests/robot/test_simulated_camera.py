import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.camera import CameraError
from maulstick.robot.simulated.camera import Optics, SimulatedCamera

CANVAS = Canvas(0.297, 0.210, 1000)
SMALL = Optics(size=(400, 300))
GREY = np.full((CANVAS.height_px, CANVAS.width_px, 3), 0.7, dtype=np.float32)


def _camera(seed: int = 1, optics: Optics = SMALL) -> SimulatedCamera:
    return SimulatedCamera(lambda: GREY, CANVAS, np.random.default_rng(seed), optics)


def test_photographs_repeat_to_the_bit_for_the_same_seed_and_differ_for_another() -> None:
    camera, again, other = _camera(), _camera(), _camera(2)
    for _ in range(2):
        np.testing.assert_array_equal(camera.photograph(), again.photograph())
    assert (other.photograph() != _camera().photograph()).mean() > 0.5


def test_a_photograph_has_eight_bits_noise_a_drifting_exposure_and_a_lamp_to_one_side() -> None:
    camera = _camera(optics=Optics(size=(400, 300), drift=0.05))
    photos = [camera.photograph() for _ in range(6)]
    assert photos[0].shape == (300, 400, 3)
    np.testing.assert_allclose(photos[0] * 255, np.round(photos[0] * 255), atol=1e-4)
    means = [photo.mean() for photo in photos]
    assert np.ptp(means) > 0.01
    middle = photos[0][100:200, 130:270]
    assert 0.002 < (middle - middle.mean(axis=(0, 1))).std() < 0.05
    assert middle[:, :20].mean() > middle[:, -20:].mean() + 0.02


def test_the_sheet_is_seen_as_it_is_at_the_moment_and_never_changed() -> None:
    sheet = GREY.copy()
    camera = SimulatedCamera(lambda: sheet, CANVAS, np.random.default_rng(0), Optics((400, 300), drift=0, noise=0))
    before = camera.photograph()
    sheet[80:130, 120:180] = 0.1
    kept = sheet.copy()
    after = camera.photograph()
    np.testing.assert_array_equal(sheet, kept)
    darker = (before - after).max(axis=2) > 0.1
    assert 0.005 < darker.mean() < 0.03
    assert darker[140:160, 190:210].all()


def test_shrinking_keeps_the_light_of_what_is_finer_than_a_pixel() -> None:
    down, across = np.mgrid[:2100, :2970]
    for width in (1, 2):
        fine = ((down // width + across // width) % 2).astype(np.float32)[..., None].repeat(3, axis=2)
        scenes = iter([fine, np.full((10, 10, 3), 0.735357, dtype=np.float32)])  # half of the light
        optics = Optics((400, 300), drift=0, noise=0)
        camera = SimulatedCamera(lambda scenes=scenes: next(scenes), CANVAS, np.random.default_rng(0), optics)  # type: ignore[misc]
        pattern, even = camera.photograph()[100:200, 130:270], camera.photograph()[100:200, 130:270]
        assert np.abs(pattern - even).max() < 0.03
        assert np.abs(pattern.mean() - even.mean()) < 0.002


def test_an_unplugged_camera_takes_no_photograph_until_it_is_plugged_in() -> None:
    camera = _camera()
    camera.unplug()
    with pytest.raises(CameraError, match=r"^the simulated camera sends no picture; plug it in again, and go on$"):
        camera.photograph()
    camera.plug_in()
    assert camera.photograph().mean() > 0.1
    with camera:
        pass
    with pytest.raises(CameraError):
        camera.photograph()


def test_without_light_the_photograph_is_black_until_it_is_lit() -> None:
    camera = _camera()
    camera.black()
    with pytest.raises(CameraError, match=r"^the photograph is black"):
        camera.photograph()
    camera.black(off=False)
    assert camera.photograph().mean() > 0.1


def test_covered_tags_are_dark_and_those_that_are_none_are_refused() -> None:
    camera = _camera(optics=Optics((400, 300), drift=0, noise=0))
    before = camera.photograph()
    camera.cover(0)
    after = camera.photograph()
    changed = np.argwhere((before - after).max(axis=2) > 0.2)
    assert len(changed) > 200
    assert (changed < (100, 130)).all()
    with pytest.raises(InputError, match=r"^a tag is 7; it must be 0, 1, 2 or 3$"):
        camera.cover(7)


def test_the_sheet_moves_under_tags_that_stay_and_the_camera_moves_everything() -> None:
    optics = Optics((400, 300), drift=0, noise=0)
    camera = _camera(optics=optics)
    before = camera.photograph()
    corner = np.s_[:40, :50]
    camera.move_paper(0.008, 0.0)
    moved = camera.photograph()
    np.testing.assert_array_equal(before[corner], moved[corner])
    assert np.abs(before - moved).max() > 0.2
    camera.move_paper(-0.008, 0.0)
    np.testing.assert_allclose(camera.photograph(), before, atol=1.01 / 255)
    camera.bump(0.005, 0.0, 0.01)
    assert np.abs(before[corner] - camera.photograph()[corner]).max() > 0.2
