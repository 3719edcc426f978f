"""Cameras: what is on the easel now, as a photograph."""

import time
from abc import ABC, abstractmethod
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
"""A photograph whose mean is darker shows nothing."""

_STALE = 5
"""Frames that a driver may hold back: they were taken before anyone asked."""

_WIDEST = 10_000
"""Asked of a driver, which answers with the largest it has."""

_POLL = 0.1  # seconds
_ENDINGS = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".webp", ".bmp")


class CameraError(MachineError):
    """No photograph can be had; painting can wait until somebody has mended that."""


class Camera(ABC):
    """What sees the sheet. A context manager, which is closed when it is left."""

    @final
    def photograph(self) -> Image:
        """(H, W, 3) sRGB in [0, 1], taken after the call; raises CameraError where there is none, or a black one."""
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
        """Let the camera go; it takes no more photographs."""

    @abstractmethod
    def _take(self) -> Image:
        """A photograph as `photograph` says, black or not."""


@final
class UsbCamera(Camera):
    """A camera that OpenCV can open, at its full size.

    index: 0 for the first.  Raises CameraError where there is none.
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
        """Let other programs have it."""
        self._video.release()

    def _take(self) -> Image:
        came = all(self._video.grab() for _ in range(_STALE))
        came, frame = self._video.read() if came else (False, None)
        if not came or frame is None:
            raise CameraError(f"the camera usb:{self._index} sends no picture; plug it in again, and go on")
        return np.asarray(self._cv2.cvtColor(frame, self._cv2.COLOR_BGR2RGB), dtype=np.float32) / np.float32(255)


@final
class WatchedFolder(Camera):
    """Any camera that puts its pictures into a folder: a photograph is the next new file there.

    patience: seconds until one must be complete.  Raises InputError where there is no such folder.
    """

    def __init__(self, folder: str | Path, patience: float = 120.0) -> None:
        self._folder = Path(folder)
        self._patience = patience
        if not self._folder.is_dir():
            raise InputError(f"there is no folder {folder}; make it, and let the camera save its pictures there")

    def close(self) -> None:
        """Nothing is held."""

    def _take(self) -> Image:
        old, sizes = set(self._sizes()), dict[Path, int]()
        doubt = "let the camera save its pictures there"
        deadline = time.monotonic() + self._patience
        while time.monotonic() < deadline:
            time.sleep(_POLL)
            before, sizes = sizes, self._sizes()
            for path in sorted(sizes.keys() - old):
                if sizes[path] == before.get(path):  # else it is still being written
                    try:
                        return read_picture(path)
                    except InputError as error:
                        doubt = str(error)
        raise CameraError(f"no new picture came into {self._folder} within {self._patience:g} s; {doubt}")

    def _sizes(self) -> dict[Path, int]:
        try:
            files = list(self._folder.iterdir())
        except OSError as error:
            reason = f"{error.strerror}; make it again, and go on"
            raise CameraError(f"cannot look into the folder {self._folder}: {reason}") from error
        sizes = {}
        for path in files:
            if path.suffix.lower() in _ENDINGS and path.name[0] != ".":
                with suppress(OSError):  # it was renamed meanwhile
                    sizes[path] = path.stat().st_size
        return sizes


def open_camera(spec: str) -> Camera:
    """Open the camera that a spec names: ``usb:0`` or ``folder:PATH``.

    Raises InputError where it names none, and CameraError where the camera cannot be had.
    """
    kind, _, name = spec.partition(":")
    if kind == "usb" and name.isascii() and name.isdecimal() and len(name) < 4:
        return UsbCamera(int(name))
    if kind == "folder" and name:
        return WatchedFolder(name)
    raise InputError(f"{spec!r} is not a camera; write usb:0, or folder:PATH for one that saves its pictures there")
