import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from maulstick.plots.contact import contact_plot, rows_of
from maulstick.recording.mocap.contact import Contact
from maulstick.recording.mocap.drawing import TakeInk
from maulstick.strokes.ink import Ink

STROKE, MERGED, DROPPED, BESIDE = (180, 224, 215), (245, 198, 105), (236, 147, 166), (217, 212, 202)


def drawing_for(seconds: float, rate: float = 240.0) -> TakeInk:
    """A touch every other second, and one part of each kind."""
    times = np.arange(round(seconds * rate)) / rate
    heights = np.clip(20e-3 * np.sin(np.pi * times), 0, None)
    starts = np.arange(1, int(seconds) - 1, 2)
    touches = np.stack([starts, starts + 1], axis=1) * int(rate)
    part = np.array([[0, 30]]) + 50
    contact = Contact(touches, part, part + 40, 0.4e-3, 0.8e-3)
    return TakeInk(Ink.of([], (0.2, 0.1)), times, heights, contact, part + 80, [])


def pixels(drawing: TakeInk) -> np.ndarray:
    with Image.open(io.BytesIO(contact_plot(drawing))) as image:
        assert image.format == "PNG"
        return np.asarray(image.convert("RGB")).astype(int)


def share(picture: np.ndarray, colour: tuple[int, int, int]) -> float:
    """Share of pixels of that colour, in the picture without its legend."""
    return float((np.abs(picture[80:] - colour).max(axis=2) <= 2).mean())


def dark_in_rows(drawing: TakeInk) -> int:
    return int((pixels(drawing)[80:, 90:1290] < 80).all(axis=2).sum())


def test_touches_and_what_was_merged_dropped_or_beside_are_marked() -> None:
    picture = pixels(drawing_for(10))
    assert share(picture, STROKE) > 0.15
    for colour in (MERGED, DROPPED, BESIDE):
        assert 0.001 < share(picture, colour) < share(picture, STROKE)
    bare = replace(drawing_for(10), contact=Contact(*[np.zeros((0, 2), dtype=np.int64)] * 3, 0.4e-3, 0.8e-3))
    assert share(pixels(bare), STROKE) == 0


@pytest.mark.parametrize(
    ("seconds", "rows", "each"),
    [(1, 1, 2), (10, 5, 2), (60, 6, 10), (61, 5, 15), (180, 6, 30), (3600, 120, 30), (10 * 3600, 120, 300)],
)
def test_a_row_is_short_enough_to_see_a_stroke_and_there_are_not_too_many(seconds: int, rows: int, each: int) -> None:
    assert rows_of(seconds) == (rows, each)


def test_a_long_take_makes_a_high_picture_of_the_same_width() -> None:
    short, long = (pixels(drawing_for(seconds, rate=30)).shape for seconds in (10, 400))
    assert long[1] == short[1]
    assert long[0] > 1.3 * short[0]


def test_the_lowest_of_many_samples_in_a_pixel_is_seen() -> None:
    drawing = drawing_for(25, rate=2000)
    high = np.full_like(drawing.heights, 0.05)
    high[:: round(2000 * 0.5)] = -0.2e-3
    out_of_sight = np.full_like(high, 0.05)
    dips, none = (dark_in_rows(replace(drawing, heights=heights)) for heights in (high, out_of_sight))
    assert dips > none + 25 * 80  # pixels: a line down and up for each


def test_unknown_heights_leave_gaps() -> None:
    drawing = drawing_for(10)
    unknown = np.full_like(drawing.heights, np.nan)
    assert dark_in_rows(replace(drawing, heights=unknown)) < 0.1 * dark_in_rows(drawing)
