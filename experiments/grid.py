"""Five hands draw three photographs, and texts where there is a CLIP for them: the paper's figure of example drawings.

    .venv/bin/python experiments/grid.py grid.png [--quick] [--clip-weights FILE --text "a boat" --text "a cat"]

A column is a hand, whose own strokes stand on top. All is drawn in black with one marker.
"""

import argparse
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from skimage import data

from maulstick.plots.rows import Row, largest_scale, rows_of
from maulstick.style.cards import style_path
from maulstick.style.store import read_style

Pixels = NDArray[np.float32]

STYLES = ("hatching", "loops", "scribble", "contour", "marks")
PICTURES = ("astronaut", "chelsea", "coffee")
BRUSH = "marker"
SIDE, SIDE_PX = 0.32, 640  # SIDE in metres
STROKES = {"hatching": 2000, "loops": 2500, "scribble": 400, "contour": 500, "marks": 6000}
"""As many as the hand's longer or shorter strokes need to reach the darks of a picture."""
STEPS, QUICK_STEPS = 1500, 200
AT_A_TIME = 2
GAP_PX, PEN_PX, FINER = 16, 2, 4
"""Of a hand's own strokes: between them, how thick, and how much finer they are drawn than shown."""


def load(image: str) -> Pixels:
    """A photograph (H, W, 3) in [0, 1] out of the scikit-image package."""
    return (getattr(data, image)() / 255).astype(np.float32)


def own_strokes(style: str) -> Pixels:
    """A hand's own strokes in rows, the tallest first, as large as lets all of them into (SIDE_PX, SIDE_PX, 3)."""
    paths = read_style(style_path(style)).hand.paths
    low, size = paths.min(axis=1), np.ptp(paths, axis=1)
    order, room = np.argsort(-size[:, 1], kind="stable"), SIDE_PX - 2 * GAP_PX

    def rows_at(scale: float) -> list[tuple[Row, float]]:
        """Rows, and how tall each is, pixels."""
        rows = rows_of(size[order, 0] * scale, room, GAP_PX)
        return [(row, size[order[row.strokes], 1].max() * scale + GAP_PX) for row in rows]

    scale = largest_scale(lambda scale: sum(tall for _, tall in rows_at(scale)) <= room, room / size[:, 0].max())
    sheet = Image.new("L", (FINER * SIDE_PX, FINER * SIDE_PX), "white")
    draw, top = ImageDraw.Draw(sheet), float(GAP_PX)
    for row, tall in rows_at(scale):
        for stroke, left in zip(order[row.strokes], row.left, strict=True):
            beside = (tall - size[stroke, 1] * scale) / 2
            path = (paths[stroke] - low[stroke]) * scale + (GAP_PX + left, top + beside)
            draw.line([tuple(point) for point in FINER * path], fill="black", width=FINER * PEN_PX, joint="curve")
        top += tall
    drawn = np.asarray(sheet.resize((SIDE_PX, SIDE_PX), Image.Resampling.LANCZOS).convert("RGB"))
    return (drawn / 255).astype(np.float32)


def side_by_side(titles: list[str], rows: list[list[Pixels]], height: int) -> Image.Image:
    """Pictures (H, W, 3) in [0, 1] in rows of this height, with a title over each column."""
    line, gap = height // 12, height // 32
    pictures = [[_of_height(pixels, height) for pixels in row] for row in rows]
    widths = [max(picture.width for picture in column) for column in zip(*pictures, strict=True)]
    lefts = np.cumsum([gap, *(width + gap for width in widths)]).tolist()
    together = Image.new("RGB", (lefts[-1], line + len(rows) * (height + gap)), "white")
    draw, font = ImageDraw.Draw(together), ImageFont.load_default(line // 2)
    for title, left, width in zip(titles, lefts, widths, strict=False):
        draw.text((left + width // 2, line // 2), title, fill="black", font=font, anchor="mm")
    for number, row in enumerate(pictures):
        for picture, left, width in zip(row, lefts, widths, strict=False):
            together.paste(picture, (left + (width - picture.width) // 2, line + number * (height + gap)))
    return together


def _of_height(pixels: Pixels, height: int) -> Image.Image:
    picture = Image.fromarray(np.round(pixels * 255).astype(np.uint8))
    return picture.resize((round(picture.width * height / picture.height), height), Image.Resampling.LANCZOS)


def draw_all(wanted: list[tuple[str, ...]], quick: bool) -> list[list[Pixels]]:
    """What each of these arguments of ``maulstick plan`` asks for, drawn by all hands."""
    size = f"{SIDE * 1e3:g}x{SIDE * 1e3:g}mm"
    maulstick = Path(sys.executable).with_name("maulstick")
    with TemporaryDirectory() as folder, ThreadPoolExecutor(AT_A_TIME) as pool:

        def draw(number: int, arguments: tuple[str, ...], style: str) -> Pixels:
            out = Path(folder) / f"{number}-{style}"
            options = ["--brush", BRUSH, "--ink", "black", "--size", size, "--fit", "cover", "--style", style]
            effort = ["--strokes", str(STROKES[style]), "--steps", str(QUICK_STEPS if quick else STEPS)]
            subprocess.run([maulstick, "plan", *arguments, *options, *effort, "--out", out], check=True)
            with Image.open(out / "preview.png") as preview:
                return np.asarray(preview.convert("RGB"), dtype=np.float32) / 255

        drawn = [[pool.submit(draw, number, each, style) for style in STYLES] for number, each in enumerate(wanted)]
        return [[drawing.result() for drawing in row] for row in drawn]


def main() -> None:
    """Draw all and save them as one picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", help="the picture to write, as in grid.png")
    parser.add_argument("--quick", action="store_true", help="far fewer steps")
    parser.add_argument("--clip-weights", metavar="FILE", help="of the CLIP that knows what texts mean")
    parser.add_argument("--text", action="append", default=[], help="a row of what it says; again for another row")
    asked = parser.parse_args()
    if asked.text and asked.clip_weights is None:
        parser.error("--text needs --clip-weights")
    texts = [("--text", text, "--clip-weights", asked.clip_weights) for text in asked.text]
    pictures = [(str(files("skimage.data").joinpath(f"{image}.png")),) for image in PICTURES]
    drawn = draw_all([*pictures, *texts], asked.quick)
    side_by_side(list(STYLES), [[own_strokes(style) for style in STYLES], *drawn], SIDE_PX).save(asked.out)


if __name__ == "__main__":
    main()
