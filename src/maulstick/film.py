"""A film of a plan as it is made: an MP4 (with the film extra) or an animated GIF."""

import io
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from maulstick.errors import InputError

FORMATS = ("gif", "mp4")
_FRAMES_A_SECOND = 20


class Film:
    """Collects frames (H, W, 3) in [0, 1] and returns the film as bytes."""

    def __init__(self, kind: str) -> None:
        if kind not in FORMATS:
            raise InputError.of_choice("film format", kind, FORMATS)
        if kind == "mp4" and find_spec("av") is None:
            raise InputError("an mp4 film needs the package av; install maulstick[film], or ask for a gif")
        self.kind = kind
        self._frames: list[Image.Image] = []

    def add(self, frame: NDArray[np.float32]) -> None:
        """The next frame; all of one film are of one size."""
        self._frames.append(Image.fromarray(np.round(frame * 255).astype(np.uint8)))

    def encode(self) -> bytes:
        """The whole film; its last frame stays for two seconds."""
        frames = self._frames + self._frames[-1:] * (2 * _FRAMES_A_SECOND)
        return _gif(frames) if self.kind == "gif" else _mp4(frames)


def _gif(frames: list[Image.Image]) -> bytes:
    file = io.BytesIO()
    frames[0].save(
        file, format="GIF", save_all=True, append_images=frames[1:], duration=1000 // _FRAMES_A_SECOND, loop=0
    )
    return file.getvalue()


def _mp4(frames: list[Image.Image]) -> bytes:
    import av

    file = io.BytesIO()
    with av.open(file, "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=_FRAMES_A_SECOND)
        width, height = (side - side % 2 for side in frames[0].size)  # the format halves its colours
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        for image in frames:
            frame = av.VideoFrame.from_ndarray(np.asarray(image.crop((0, 0, width, height))), format="rgb24")
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return file.getvalue()
