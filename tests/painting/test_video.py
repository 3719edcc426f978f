import io
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image, ImageSequence

from maulstick.errors import InputError, how_to_add
from maulstick.painting import video
from maulstick.painting.video import Video

RED, GREEN, BLUE = np.eye(3, dtype=np.float32)
A_FRAME = 50  # milliseconds
LAST = 2000  # milliseconds that the last frame stays


def frame(colour: NDArray[np.float32], height: int = 24, width: int = 32) -> NDArray[np.float32]:
    return np.broadcast_to(colour, (height, width, 3))


def recorded(kind: str, *frames: NDArray[np.float32]) -> bytes:
    made = Video(kind)
    for one in frames:
        made.add(one)
    return made.encode()


def test_a_gif_shows_every_frame_in_turn_and_the_last_for_two_seconds() -> None:
    with Image.open(io.BytesIO(recorded("gif", frame(RED), frame(GREEN), frame(BLUE)))) as gif:
        assert (gif.format, gif.size) == ("GIF", (32, 24))
        shown = [(one.convert("RGB").getpixel((5, 5)), one.info["duration"]) for one in ImageSequence.Iterator(gif)]
    colours = [colour for colour, _ in shown]
    assert [colour for i, colour in enumerate(colours) if i == 0 or colour != colours[i - 1]] == [
        (255, 0, 0),
        (0, 255, 0),
        (0, 0, 255),
    ]
    assert sum(duration for _, duration in shown) == 3 * A_FRAME + LAST
    assert sum(duration for colour, duration in shown if colour == (0, 0, 255)) == A_FRAME + LAST


def test_the_same_frames_make_the_same_bytes() -> None:
    once = recorded("gif", frame(RED), frame(GREEN))
    assert recorded("gif", frame(RED), frame(GREEN)) == once
    assert recorded("gif", frame(GREEN), frame(RED)) != once


@pytest.mark.parametrize(("height", "width"), [(24, 32), (25, 33), (2, 3)])
def test_an_mp4_shows_every_frame_and_needs_no_even_sides(height: int, width: int) -> None:
    av = pytest.importorskip("av")
    data = recorded("mp4", *(frame(colour, height, width) for colour in (RED, GREEN, BLUE)))
    with av.open(io.BytesIO(data)) as container:
        stream = container.streams.video[0]
        assert (stream.width, stream.height) == (width + width % 2, height + height % 2)
        assert stream.average_rate == 20
        pictures = [picture.to_ndarray(format="rgb24") for picture in container.decode(stream)]
    assert len(pictures) == 3 + 40
    for colour, picture in zip((RED, GREEN, BLUE, BLUE), [*pictures[:3], pictures[-1]], strict=True):
        assert picture.mean((0, 1)) == pytest.approx(255 * colour, abs=40), "colours are halved and compressed"


@pytest.mark.parametrize(("height", "width", "size"), [(1000, 400, (288, 720)), (400, 2000, (1280, 256))])
def test_large_frames_are_recorded_small_and_never_stretched(height: int, width: int, size: tuple[int, int]) -> None:
    with Image.open(io.BytesIO(recorded("gif", frame(RED, height, width)))) as gif:
        assert gif.size == size


def test_another_format_is_refused_with_those_there_are() -> None:
    with pytest.raises(InputError) as caught:
        Video("avi")
    assert str(caught.value) == "there is no video format 'avi'; there are: gif, mp4"


def test_an_mp4_without_its_package_is_refused_before_anything_is_recorded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(video, "find_spec", lambda name: None)
    with pytest.raises(InputError) as caught:
        Video("mp4")
    assert str(caught.value) == f"an mp4 video needs the package av: ask for a gif, or {how_to_add('video')}"
    assert Video("gif").kind == "gif"


def test_grey_levels_are_rounded_to_the_nearest() -> None:
    levels = np.linspace(0, 1, 8, dtype=np.float32)
    made = Video("gif")
    made.add(np.repeat(levels[None, :, None], 3, axis=2))
    with Image.open(io.BytesIO(made.encode())) as gif:
        pixels = [cast(tuple[int, ...], gif.convert("RGB").getpixel((x, 0)))[0] for x in range(8)]
    assert pixels == [round(255 * level) for level in levels.tolist()]
