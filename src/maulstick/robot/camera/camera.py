"""Cameras that photograph the sheet: over USB, or by a folder of new pictures."""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self, final

import numpy as np

from maulstick.errors import InputError, MachineError
from maulstick.painting.picture import read_picture
from maulstick.robot.camera.opencv import opencv
from maulstick.storage.arrays import Image

_BLACK = 0.02
"""Mean below which a photograph counts as black: the lens is covered, or there is no light."""

_STALE = 5
"""Frames dropped before each photograph: drivers buffer some that were taken before the call."""

_WIDEST = 10_000
"""Width and height in pixels that a driver is asked for; it takes the largest that it has."""

_POLL = 0.1  # seconds between two looks into a folder; a file that is the same twice is complete
_ENDINGS = (".jpg", ".jpeg", ".png", ".heic", ".heif", ".tif", ".tiff", ".webp", ".bmp")  # of pictures


class CameraError(MachineError):
    """Error of a camera that takes no photograph; painting can wait until the operator has mended that."""


class Camera(ABC):
    """Camera over the sheet: a context manager, which is closed when it is left."""

    @final
    def photograph(self) -> Image:
        """Take a photograph now, (H, W, 3) sRGB in [0, 1]. Raises CameraError where none comes, or a black one."""
        picture = self._take()
        if picture.mean() < _BLACK:
            raise CameraError("the photograph is black; take off the lens cap or switch on the light, and go on")
        return picture

    @final
    def __enter__(self) -> Self:
        return self

    @final
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @abstractmethod
    def close(self) -> None:
        """Release the camera; it takes no more photographs."""

    @abstractmethod
    def _take(self) -> Image:
        """Take a photograph as `photograph` does, black or not."""


@final
class UsbCamera(Camera):
    """USB camera that OpenCV can open, at its full size.

    index: number of the camera, 0 for the first.  Raises CameraError where there is none.
    """

    def __init__(self, index: int) -> None:
        self._cv2 = opencv()
        self._index = index
        self._video = self._cv2.VideoCapture(index)
        if not self._video.isOpened():
            self._video.release()
            raise CameraError(f"there is no camera usb:{index}, or another program has it; plug it in, or close that")
        self._video.set(self._cv2.CAP_PROP_FRAME_WIDTH, _WIDEST)
        self._video.set(self._cv2.CAP_PROP_FRAME_HEIGHT, _WIDEST)

    def close(self) -> None:
        """Release the camera for other programs."""
        self._video.release()

    def _take(self) -> Image:
        came = all(self._video.grab() for _ in range(_STALE))
        came, frame = self._video.read() if came else (False, None)
        if not came or frame is None:
            raise CameraError(f"the camera usb:{self._index} sends no picture; plug it in again, and go on")
        return np.asarray(self._cv2.cvtColor(frame, self._cv2.COLOR_BGR2RGB), dtype=np.float32) / np.float32(255)


@final
class WatchedFolder(Camera):
    """Any camera that saves its pictures into a folder: a photograph is the next file that is new or written anew.

    patience: seconds until a file must be there and complete.  tell: called with a sentence for whoever takes the
    picture, once it is waited for.  Raises InputError where there is no such folder.
    """

    def __init__(
        self, folder: str | Path, patience: float = 120.0, tell: Callable[[str], None] = lambda sentence: None
    ) -> None:
        self._folder = Path(folder)
        self._patience = patience
        self._tell = tell
        if not self._folder.is_dir():
            raise InputError(f"there is no folder {folder}; make it, and let the camera save its pictures there")

    def close(self) -> None:
        """Do nothing: a folder is not held open."""

    def _take(self) -> Image:
        old = before = self._saved()
        doubt = "let the camera save its pictures there"
        self._tell(f"a new photograph of the sheet is waited for in {self._folder}, for {self._patience:g} s")
        deadline = time.monotonic() + self._patience
        while time.monotonic() < deadline:
            time.sleep(_POLL)
            saved = self._saved()
            for path, _ in sorted((saved.items() & before.items()) - old.items()):  # not while it is written
                try:
                    return read_picture(path)
                except InputError as error:
                    doubt = str(error)
            before = saved
        raise CameraError(f"no new picture came into {self._folder} within {self._patience:g} s; {doubt}")

    def _saved(self) -> dict[Path, tuple[int, int]]:
        """Return the pictures in the folder, with their sizes in bytes, and when each was written, nanoseconds."""
        try:
            files = list(self._folder.iterdir())
        except OSError as error:
            reason = f"{error.strerror}; make it again, and go on"
            raise CameraError(f"cannot look into the folder {self._folder}: {reason}") from error
        saved = {}
        for path in files:
            if path.suffix.lower() in _ENDINGS and path.name[0] != ".":
                with suppress(OSError):  # it was renamed meanwhile
                    found = path.stat()
                    saved[path] = found.st_size, found.st_mtime_ns
        return saved


def open_camera(spec: str, tell: Callable[[str], None] = lambda sentence: None) -> Camera:
    """Open the camera that a spec names: ``usb:0`` or ``folder:PATH``.

    tell: called with a sentence each time that a person may have to take the picture.
    Raises InputError where it names none, and CameraError where the camera cannot be had.
    """
    kind, _, name = spec.partition(":")
    if kind == "usb" and name.isascii() and name.isdecimal() and len(name) < 4:
        return UsbCamera(int(name))
    if kind == "folder" and name:
        return WatchedFolder(name, tell=tell)
    raise InputError(f"{spec!r} is not a camera; write usb:0, or folder:PATH for one that saves its pictures there")
