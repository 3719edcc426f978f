import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.painting.raster import Canvas
from maulstick.robot.simulated import mypaint
from maulstick.robot.simulated.mypaint import MEDIA, MyPaintPaper
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import resample
from tests.support.tolerances import MEDIUM_BLUR, MEDIUM_COLOUR, MEDIUM_END, MEDIUM_INK

SHEET = Canvas(0.03, 0.02, 5000)
RADII = {"acrylic": 1e-3, "brush": 0.3e-3, "marker": 1e-3, "marker_fat": 2e-3}  # marks of 0.5 to 1 mm at pressure 0.7
WIDEST = 3e-3  # half-width of any of them
MISSING = "libmypaint or its brushes are not installed; run: apt-get install libmypaint-1.5-1 mypaint-brushes"

media = pytest.mark.parametrize("medium", sorted(MEDIA))


def sheet(canvas: Canvas = SHEET) -> MyPaintPaper:
    try:
        return MyPaintPaper(canvas)
    except InputError as error:
        pytest.skip(str(error))


def darkness(trajectory: Floats, medium: str, canvas: Canvas = SHEET, speed: float = 0.05) -> Floats:
    paper = sheet(canvas)
    paper.draw(trajectory, medium, radius=RADII[medium], speed=speed)
    return 1 - paper.photograph().astype(np.float64).mean(axis=2)


def line(pressure: float, y: float = 0.01, end: float = 0.024) -> Floats:
    return np.array([[0.006, y, pressure], [end, y, pressure]])


def wave() -> Floats:
    t = np.linspace(0, 1, 32)
    return np.stack([0.004 + 0.022 * t, 0.01 + 0.004 * np.sin(9 * t), 0.5 + 0.4 * t], axis=1)


def distances(trajectory: Floats) -> Floats:
    """Return the distance of the middle of each pixel to the path, (height_px, width_px) metres."""
    middles = (np.indices((SHEET.height_px, SHEET.width_px))[::-1] + 0.5) / SHEET.pixels_per_metre
    points = resample(trajectory, 200)[:, :2]
    return np.min([np.hypot(middles[0] - x, middles[1] - y) for x, y in points], axis=0)


def test_a_fresh_sheet_is_white() -> None:
    picture = sheet().photograph()
    assert picture.shape == (100, 150, 3)
    assert picture.dtype == np.float32
    assert (picture == 1).all()


def test_strokes_on_a_laid_picture_are_those_on_the_sheet_that_it_shows() -> None:
    first, second = sheet(), sheet()
    for paper in (first, second):
        paper.draw(wave(), "acrylic", radius=1e-3, colour=(0.8, 0.1, 0.2))
    shown = first.photograph()
    first.draw(line(0.7), "brush", radius=0.3e-3)
    assert np.abs(first.photograph() - shown).max() > 0.1
    first.lay(shown)
    assert np.array_equal(first.photograph(), shown)
    for paper in (first, second):
        paper.draw(line(0.7, y=0.008), "marker", radius=1e-3, colour=(0.1, 0.2, 0.7))
    assert np.array_equal(first.photograph(), second.photograph())


@media
def test_a_stroke_leaves_ink_along_its_path_and_none_far_away(medium: str) -> None:
    trajectory = line(0.7)
    dark, away = darkness(trajectory, medium), distances(trajectory)
    assert dark[49:51, 31:119].min() > 0.5
    assert (dark[away > WIDEST] == 0).all()
    rows = np.arange(SHEET.height_px) + 0.5
    assert (dark.sum(axis=1) @ rows) / dark.sum() == pytest.approx(0.01 * SHEET.pixels_per_metre, abs=MEDIUM_BLUR)


@media
def test_the_same_strokes_make_the_same_picture_on_every_sheet(medium: str) -> None:
    first, second = darkness(wave(), medium), darkness(wave(), medium)
    assert np.array_equal(first, second)


@media
def test_a_stroke_is_the_same_whatever_was_drawn_before_it(medium: str) -> None:
    paper = sheet()
    paper.draw(line(0.9, y=0.004), medium, radius=RADII[medium])
    before = paper.photograph()
    paper.draw(line(0.7, y=0.015), medium, radius=RADII[medium])
    alone = darkness(line(0.7, y=0.015), medium)
    assert np.array_equal(before[:50], paper.photograph()[:50])
    assert np.array_equal(1 - paper.photograph()[50:].astype(np.float64).mean(axis=2), alone[50:])


@media
def test_more_pressure_never_makes_less_ink(medium: str) -> None:
    ink = [darkness(line(pressure), medium).sum() for pressure in (0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0)]
    assert (np.diff(ink) >= 0).all()
    assert ink[0] < 0.2 * ink[-1]


@media
@pytest.mark.parametrize("turned", [False, True])
def test_a_mark_reaches_both_ends_of_its_path(medium: str, turned: bool) -> None:
    dark = darkness(line(0.6)[::-1] if turned else line(0.6), medium)
    columns = (np.flatnonzero(dark.max(axis=0) > 0.5) + 0.5) / SHEET.pixels_per_metre
    assert columns[0] < 0.006 + MEDIUM_END
    assert columns[-1] > 0.024 - MEDIUM_END


@media
def test_a_medium_has_the_same_size_at_every_resolution(medium: str) -> None:
    fine = Canvas(SHEET.width, SHEET.height, 4 * SHEET.pixels_per_metre)
    coarse_ink = darkness(wave(), medium, speed=0.1).sum() / SHEET.pixels_per_metre**2
    assert coarse_ink == pytest.approx(
        darkness(wave(), medium, fine, speed=0.1).sum() / fine.pixels_per_metre**2, rel=MEDIUM_INK
    )


def test_ink_has_its_colour_and_covers_what_lies_below() -> None:
    paper = sheet()
    paper.draw(line(1.0), "brush", radius=0.3e-3, colour=(0.9, 0.5, 0.1))
    assert paper.photograph()[50, 75] == pytest.approx((0.9, 0.5, 0.1), abs=MEDIUM_COLOUR)
    paper.draw(line(1.0), "brush", radius=0.3e-3, colour=(0.2, 0.3, 0.8))
    assert paper.photograph()[50, 75] == pytest.approx((0.2, 0.3, 0.8), abs=MEDIUM_COLOUR)


metres = st.floats(-0.05, 0.08)
points = st.lists(st.tuples(metres, metres, st.floats(0, 1)), min_size=1, max_size=5)


@given(points, st.sampled_from(sorted(MEDIA)))
@settings(max_examples=30, deadline=None)
def test_a_stroke_beyond_the_edge_does_no_harm(path: list[tuple[float, float, float]], medium: str) -> None:
    trajectory = np.array(path)
    kept = trajectory.copy()
    dark = darkness(trajectory, medium)
    assert np.array_equal(trajectory, kept)
    assert dark.shape == (100, 150)
    assert 0 <= dark.min() <= dark.max() <= 1


@media
def test_what_lies_beside_the_sheet_is_lost(medium: str) -> None:
    assert (darkness(line(0.8, y=0.03), medium) == 0).all()
    away = np.array([[0.006, 0.01, 0.8], [1e9, 0.01, 0.8]])
    dark = darkness(away, medium)
    assert dark[50, 40:].min() > 0.5
    assert (dark[:30] == 0).all()


def test_a_medium_that_does_not_exist_is_refused() -> None:
    with pytest.raises(InputError) as caught:
        sheet().draw(line(0.5), "crayon", radius=1e-3)
    assert str(caught.value) == "there is no medium 'crayon'; there are: acrylic, brush, marker, marker_fat"


@pytest.mark.parametrize(
    ("trajectory", "radius", "speed", "text"),
    [
        (line(0.5), 0.0, 0.05, "the radius is 0.0; it must be above 0 metres"),
        (line(0.5), float("nan"), 0.05, "the radius is nan; it must be above 0 metres"),
        (line(0.5), 1e-3, 0.0, "the speed is 0.0; it must be at least 0.001 metres per second"),
        (line(1.5), 1e-3, 0.05, "pressure is 1.5 to 1.5; it must be in [0, 1]"),
        (line(0.5, end=np.inf), 1e-3, 0.05, "a point of the trajectory is not a finite number"),
        (line(0.5)[:0], 1e-3, 0.05, "a trajectory has shape (0, 3); it must be (n, 3) with n of at least 1"),
        (line(0.5)[:, :2], 1e-3, 0.05, "a trajectory has shape (2, 2); it must be (n, 3) with n of at least 1"),
    ],
)
def test_numbers_that_cannot_be_drawn_are_refused_and_leave_the_sheet_as_it_was(
    trajectory: Floats, radius: float, speed: float, text: str
) -> None:
    paper = sheet()
    with pytest.raises(InputError) as caught:
        paper.draw(trajectory, "brush", radius=radius, speed=speed)
    assert str(caught.value) == text
    assert (paper.photograph() == 1).all()


def test_where_the_library_is_missing_one_sentence_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mypaint, "_LIBRARY", "libmypaint-0.0.so.0")
    with pytest.raises(InputError) as caught:
        MyPaintPaper(SHEET)
    assert str(caught.value) == MISSING


def test_where_the_brushes_are_missing_one_sentence_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    sheet()
    monkeypatch.setattr(mypaint, "_BRUSHES", tmp_path)
    with pytest.raises(InputError) as caught:
        MyPaintPaper(SHEET)
    assert str(caught.value) == MISSING


def test_what_c_prints_while_a_sheet_is_drawn_on_is_not_among_what_python_prints() -> None:
    script = """
import ctypes

from maulstick.painting.raster import Canvas
from maulstick.robot.simulated.mypaint import MyPaintPaper

print("before")
MyPaintPaper(Canvas(0.02, 0.02, 2000.0))
ctypes.CDLL(None).puts(b"Time is running backwards!")
print("after")
"""
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert ran.stdout.splitlines() == ["before", "after"]
