"""Videos of a plan in progress: MP4 (with the video extra) or animated GIF."""

import io
from importlib.util import find_spec

import numpy as np
from PIL import Image

from maulstick.errors import InputError, how_to_add
from maulstick.storage.arrays import Pixels

FORMATS = ("gif", "mp4")
"""Kinds of video that can be written."""

FRAMES_PER_SECOND = 20
"""Speed of a video."""

LARGEST = (1280, 720)
"""Width and height of the largest frame, pixels: 160 frames hold less than half a gigabyte."""

_LAST_SECONDS = 2  # that the last frame stays


class Video:
    """Frames (H, W, 3) in [0, 1] of one size, and their encoding as GIF or MP4.

    Raises InputError for another kind, or for mp4 where the package av is missing.
    """

    def __init__(self, kind: str) -> None:
        if kind not in FORMATS:
            raise InputError.of_choice("video format", kind, FORMATS)
        if kind == "mp4" and find_spec("av") is None:
            raise InputError(f"an mp4 video needs the package av: ask for a gif, or {how_to_add('video')}")
        self.kind = kind
        self._frames: list[Image.Image] = []

    def add(self, frame: Pixels) -> None:
        """Add a frame, scaled down to at most 1280x720; all frames must be of one size."""
        image = Image.fromarray(np.round(frame * 255).astype(np.uint8))
        image.thumbnail(LARGEST)
        self._frames.append(image)

    def encode(self) -> bytes:
        """Return the file of the video, of at least one frame; the last stays for two seconds more."""
        return _gif(self._frames) if self.kind == "gif" else _mp4(self._frames)


def _gif(frames: list[Image.Image]) -> bytes:
    file = io.BytesIO()
    milliseconds = [1000 // FRAMES_PER_SECOND] * len(frames)
    milliseconds[-1] += 1000 * _LAST_SECONDS
    frames[0].save(file, format="GIF", save_all=True, append_images=frames[1:], duration=milliseconds, loop=0)
    return file.getvalue()


def _mp4(frames: list[Image.Image]) -> bytes:
    import av

    file = io.BytesIO()
    with av.open(file, "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=FRAMES_PER_SECOND)
        width, height = (side + side % 2 for side in frames[0].size)  # the format halves its colours
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        for image in frames + frames[-1:] * (FRAMES_PER_SECOND * _LAST_SECONDS):
            frame = av.VideoFrame.from_ndarray(np.asarray(image.resize((width, height))), format="rgb24")
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return file.getvalue()
