import os
import shutil
import threading
import time
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from maulstick.errors import InputError
from maulstick.painting.picture import read_picture
from maulstick.robot.camera.camera import CameraError, UsbCamera, WatchedFolder, open_camera


class FakeVideo:
    """Driver that buffers four frames; frame n is all of grey n. It is unplugged after `frames`."""

    frames = 100

    def __init__(self, index: int) -> None:
        self.taken, self.released, self.there = 0, False, index == 0

    def isOpened(self) -> bool:  # noqa: N802
        return self.there

    def set(self, _: int, __: float) -> bool:
        return True

    def grab(self) -> bool:
        self.taken += 1
        return self.taken <= self.frames

    def read(self) -> tuple[bool, np.ndarray | None]:
        came = self.grab()
        frame = np.full((30, 40, 3), (10 * self.taken, 0, 200), dtype=np.uint8)
        return came, frame if came else None

    def release(self) -> None:
        self.released = True


@pytest.fixture
def video(monkeypatch: pytest.MonkeyPatch) -> type[FakeVideo]:
    monkeypatch.setattr(cv2, "VideoCapture", FakeVideo)
    monkeypatch.setattr(FakeVideo, "frames", 100)
    return FakeVideo


def test_a_photograph_of_a_usb_camera_is_newer_than_the_call_and_has_its_colours_in_order(
    video: type[FakeVideo],
) -> None:
    with open_camera("usb:0") as camera:
        photo = camera.photograph()
    assert photo.shape == (30, 40, 3)
    assert photo.dtype == np.float32
    np.testing.assert_allclose(photo[0, 0], [200 / 255, 0, 60 / 255], atol=1e-6)


def test_a_usb_camera_that_is_pulled_out_or_not_there_says_what_to_do(
    video: type[FakeVideo], monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(CameraError, match=r"^there is no camera usb:7, or another program has it; plug it in"):
        UsbCamera(7)
    camera = UsbCamera(0)
    camera.photograph()
    monkeypatch.setattr(video, "frames", 9)
    with pytest.raises(CameraError, match=r"^the camera usb:0 sends no picture; plug it in again, and go on$"):
        camera.photograph()


def _picture(grey: int) -> Image.Image:
    return Image.fromarray(np.full((60, 80, 3), grey, dtype=np.uint8))


def test_a_folders_photograph_is_the_next_new_picture_and_not_one_half_written(tmp_path: Path) -> None:
    _picture(10).save(tmp_path / "old.png")
    (tmp_path / "notes.txt").write_text("no picture")
    rng = np.random.default_rng(0)
    Image.fromarray(rng.integers(0, 255, (300, 400, 3), dtype=np.uint8)).save(tmp_path / ".whole.png")
    content = (tmp_path / ".whole.png").read_bytes()

    def copy_slowly() -> None:
        time.sleep(0.3)
        with (tmp_path / "new.png").open("wb") as file:
            for part in range(0, len(content), len(content) // 5 + 1):
                file.write(content[part : part + len(content) // 5 + 1])
                file.flush()
                time.sleep(0.15)

    writer = threading.Thread(target=copy_slowly)
    writer.start()
    try:
        photo = WatchedFolder(tmp_path, patience=30).photograph()
    finally:
        writer.join()
    np.testing.assert_array_equal(np.round(photo * 255), np.asarray(Image.open(tmp_path / ".whole.png")))


def test_a_folder_into_which_nothing_comes_or_only_half_a_picture_says_so(tmp_path: Path) -> None:
    _picture(100).save(tmp_path / "old.png")
    camera = WatchedFolder(tmp_path, patience=0.3)
    with pytest.raises(CameraError, match=r"^no new picture came into .* within 0\.3 s; let the camera save its pict"):
        camera.photograph()
    broken = threading.Timer(0.2, lambda: (tmp_path / "new.jpg").write_bytes(b"\xff\xd8\xff\xe0 half"))
    broken.start()
    with pytest.raises(CameraError, match=r"within 1 s; .*new\.jpg"):
        WatchedFolder(tmp_path, patience=1.0).photograph()
    broken.join()


def test_a_telephone_may_send_its_own_kind_of_picture_into_the_folder(tmp_path: Path) -> None:
    taken = Path(__file__).parent.parent / "painting" / "pictures" / "telephone.heic"

    def send(_: str) -> None:
        shutil.copy(taken, tmp_path / "IMG_0001.HEIC")

    np.testing.assert_array_equal(open_camera(f"folder:{tmp_path}", send).photograph(), read_picture(taken))


def test_a_camera_may_write_all_its_pictures_into_one_file(tmp_path: Path) -> None:
    latest = tmp_path / "latest.png"
    _picture(50).save(latest)
    os.utime(latest, (0, 0))
    camera = open_camera(f"folder:{tmp_path}", lambda _: _picture(51).save(latest))
    assert camera.photograph().mean() * 255 == pytest.approx(51)


def test_whoever_takes_the_picture_is_told_when_a_folder_waits_for_one(tmp_path: Path) -> None:
    said: list[str] = []

    def save(sentence: str) -> None:
        said.append(sentence)
        _picture(100).save(tmp_path / f"new-{len(said)}.png")

    camera = open_camera(f"folder:{tmp_path}", save)
    for _ in range(2):
        camera.photograph()
    assert said == [f"a new photograph of the sheet is waited for in {tmp_path}, for 120 s"] * 2


def test_a_folder_that_is_taken_away_is_a_lost_camera(tmp_path: Path) -> None:
    folder = tmp_path / "shots"
    folder.mkdir()
    camera = open_camera(f"folder:{folder}")
    folder.rmdir()
    with pytest.raises(CameraError, match=r"^cannot look into the folder .*shots: No such file"):
        camera.photograph()
    with pytest.raises(InputError, match=r"^there is no folder .*shots; make it"):
        WatchedFolder(folder)


def test_a_black_photograph_is_no_photograph(tmp_path: Path) -> None:
    camera = WatchedFolder(tmp_path, patience=30)
    writer = threading.Timer(0.3, lambda: _picture(2).save(tmp_path / "new.png"))
    writer.start()
    with pytest.raises(CameraError, match=r"^the photograph is black; take off the lens cap or switch on the light"):
        camera.photograph()
    writer.join()


@pytest.mark.parametrize("text", ["usb", "usb:", "usb:one", "usb:1234", "folder:", "webcam", "", "usb:²"])
def test_what_names_no_camera_is_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"is not a camera; write usb:0, or folder:PATH"):
        open_camera(text)
