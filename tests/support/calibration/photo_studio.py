"""A sheet under the simulated camera, and what can lie on it."""

import numpy as np
from numpy.typing import NDArray

from maulstick.calibration.camera import CameraView, locate
from maulstick.calibration.chart import CHART
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.tag_frame import TagFrame
from maulstick.robot.simulated.camera import Optics, SimulatedCamera

Image = NDArray[np.float32]

CANVAS = Canvas(0.297, 0.210, 2000)
TAGS = TagFrame(CANVAS.width, CANVAS.height)
PAPER = 0.96


class Studio:
    """Studio of a sheet and a camera; sheet: the image that the camera sees, which may be replaced."""

    def __init__(self, sheet: Image, seed: int = 1, optics: Optics = Optics(size=(800, 600))) -> None:  # noqa: B008
        self.sheet = sheet
        self.camera = SimulatedCamera(lambda: self.sheet, CANVAS, np.random.default_rng(seed), optics)

    def look(self, margin: float = 0.0) -> tuple[Image, CameraView, Image]:
        photo = self.camera.photograph()
        view = locate(photo, TAGS)
        return photo, view, view.rectify(photo, CANVAS, margin)


def bare() -> Image:
    return np.full((CANVAS.height_px, CANVAS.width_px, 3), PAPER, dtype=np.float32)


def squares(colours: NDArray[np.float64], across: int, left: int, top: int, side: int, step: int) -> Image:
    """Draw colours (N, 3) as squares, so many per row; sizes in pixels."""
    sheet = bare()
    for number, colour in enumerate(colours):
        y, x = top + number // across * step, left + number % across * step
        sheet[y : y + side, x : x + side] = colour
    return sheet


def seen_squares(flat: Image, count: int, across: int, left: int, top: int, side: int, step: int) -> Image:
    """Return the colours (count, 3) in the middle of each square."""
    inner = side // 4
    rows, columns = np.divmod(np.arange(count), across)
    corners = zip(top + rows * step + inner, left + columns * step + inner, strict=True)
    return np.array([flat[y : y + 2 * inner, x : x + 2 * inner].mean(axis=(0, 1)) for y, x in corners])


def chart() -> Image:
    sheet = squares(CHART, 6, 110, 90, 50, 60)
    return np.asarray(sheet, dtype=np.float32)


CHART_CORNERS = np.array([(135, 115), (435, 115), (435, 295), (135, 295)]) / CANVAS.pixels_per_metre


def dots() -> tuple[Image, NDArray[np.float64]]:
    """Draw dots of 3 mm on a grid; returns the picture and their middles (N, 2), metres."""
    x, y = np.meshgrid(np.linspace(0.012, 0.285, 9), np.linspace(0.012, 0.198, 7))
    middles = np.stack([x.ravel(), y.ravel()], axis=1)
    down, across = np.mgrid[: CANVAS.height_px, : CANVAS.width_px] + 0.5
    sheet = bare()
    for at in middles * CANVAS.pixels_per_metre:
        cover = (3.5 - np.hypot(across - at[0], down - at[1])).clip(0, 1)[..., None]
        sheet = np.asarray(sheet * (1 - cover) + 0.05 * cover, dtype=np.float32)
    return sheet, middles


def seen_dots(flat: Image, middles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Find the dots in a flat image of the canvas, (N, 2), metres."""
    grey = flat.mean(axis=2).astype(np.float64)
    reach, found = 9, []
    for x, y in (middles * CANVAS.pixels_per_metre).round().astype(int):
        part = grey[y - reach : y + reach, x - reach : x + reach]
        dark = (np.median(part) * 0.9 - part).clip(min=0)
        down, across = np.mgrid[y - reach : y + reach, x - reach : x + reach] + 0.5
        found.append([np.average(across, weights=dark), np.average(down, weights=dark)])
    return np.array(found) / CANVAS.pixels_per_metre


def strokes(seed: int, count: int) -> Image:
    """Draw bold straight strokes at random places."""
    rng = np.random.default_rng(seed)
    down, across = np.mgrid[: CANVAS.height_px, : CANVAS.width_px]
    sheet = bare()
    for _ in range(count):
        start, end = rng.uniform(0.08, 0.92, (2, 2)) * (CANVAS.width_px, CANVAS.height_px)
        way = end - start
        share = (((across - start[0]) * way[0] + (down - start[1]) * way[1]) / (way @ way)).clip(0, 1)
        near = np.hypot(across - start[0] - share * way[0], down - start[1] - share * way[1])
        sheet = np.where(near[..., None] < 2.5, np.float32(0.1), sheet)
    return sheet
