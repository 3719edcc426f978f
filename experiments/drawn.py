"""Draw three photographs in the hands of six drawings, each beside the drawing itself: the picture docs/drawn.jpg.

    .venv/bin/python experiments/drawn.py docs/drawn.jpg [--paints 12] [--measure-only] [--quick]

A row is a Wacom drawing, and all of its strokes are learned from. Photographs are drawn in black with a fineliner, and
the drawing is shown with that pen, too. Plans are kept in out/drawn, and an interrupted run goes on where it stopped.
With --measure-only (and PYTHONPATH=benchmarks), rows are human drawings that must not ship: write that into out.
"""

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np
import torch
from PIL import Image
from skimage import data
from wacom import wacom_hands

import maulstick as ms
from maulstick.painting.painting import Painting, Stroke
from maulstick.painting.raster import Canvas
from maulstick.rendering.preview import truth
from maulstick.strokes.strokes import Strokes
from maulstick.style import Style

DRAWINGS = ("elephant", "moscow", "animal", "wine", "sydney_opera", "ship")
MEASURE_ONLY = ("Koala04", "giacometti", "house", "fruit")
PHOTOGRAPHS = {"chelsea": np.s_[:, :], "astronaut": np.s_[:280, 20:440], "camera": np.s_[50:350, 60:510]}
"""Rows and columns that are drawn: a face as large as a person would draw it."""
SHEET, STROKES = (0.24, 0.16), 1000
STEPS, QUICK_STEPS = 500, 50
JOB = {"brush": "fineliner", "strokes": STROKES, "size": "240x160mm", "fit": "cover", "px": 320, "device": "cpu"}
MARGIN = 0.006
"""Metres around a drawing."""
CELL_PX, GAP_PX, QUALITY = 320, 10, 50
"""Height of a cell, between cells, and of the JPEG."""
KEPT = Path(__file__).resolve().parents[1] / "out" / "drawn"


def planned(drawing: str, strokes: Strokes, photograph: str, paints: int | None, steps: int) -> Painting:
    """The plan of a photograph in the hand of a drawing, made unless it is kept."""
    colours: dict[str, Any] = {"ink": "black"} if paints is None else {"paints": paints}
    path = KEPT / f"{drawing}-{photograph}-{STROKES}-{paints or 'ink'}-{steps}.json"
    if not path.exists():
        style = ms.fit_style(strokes, drawing.lower().replace("_", "-"))
        part = getattr(data, photograph)()[PHOTOGRAPHS[photograph]] / 255
        picture = (part if part.ndim == 3 else np.repeat(part[..., None], 3, axis=2)).astype(np.float32)
        path.parent.mkdir(parents=True, exist_ok=True)
        ms.plan(picture, style=style, hand_size=size_of(style), steps=steps, **JOB, **colours).save(path)
        print(path.stem, file=sys.stderr, flush=True)
    return ms.read_painting(path)


def size_of(style: Style) -> float:
    """Times a hand's size, at most 1, at which a plan's strokes lie on the sheet as densely as in the drawing."""
    return 1.0 if style.arrangement is None else style.arrangement.size_for(STROKES, SHEET[0] * SHEET[1])


def as_drawn(strokes: Strokes, like: Painting) -> Painting:
    """A drawing, as large as goes on the sheet of a painting, with its pen."""
    paths = strokes.placed()[..., :2]
    low, high = paths.min(axis=(0, 1)), paths.max(axis=(0, 1))
    scale = ((np.array(SHEET) - 2 * MARGIN) / (high - low)).min()
    paths = (paths - (low + high) / 2) * scale + np.array(SHEET) / 2
    drawn = [Stroke(id=i, paint=0, trajectory=[(x, y, 0.5) for x, y in path]) for i, path in enumerate(paths.tolist())]
    return like.model_copy(update={"strokes": tuple(drawn)})


def shown(painting: Painting) -> Image.Image:
    """A cell."""
    pixels = truth(painting, Canvas.of_height(SHEET, CELL_PX))
    return Image.fromarray(np.round(pixels * 255).astype(np.uint8))


def main() -> None:
    """Draw all, and save them as one picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", help="the picture to write, as in drawn.jpg")
    parser.add_argument("--paints", type=int, help="so many colours instead of black ink")
    parser.add_argument("--measure-only", action="store_true", help="drawings that must not ship")
    parser.add_argument("--quick", action="store_true", help="far fewer steps")
    asked = parser.parse_args()
    steps = QUICK_STEPS if asked.quick else STEPS
    torch.set_num_threads(1)
    if asked.measure_only:
        from recordings import human_drawings

        hands = {drawing: human_drawings()[drawing] for drawing in MEASURE_ONLY}
    else:
        hands = {drawing: wacom_hands()[drawing] for drawing in DRAWINGS}
    rows = []
    for drawing, strokes in hands.items():
        plans = [planned(drawing, strokes, photograph, asked.paints, steps) for photograph in PHOTOGRAPHS]
        rows.append([shown(each) for each in (as_drawn(strokes, plans[0]), *plans)])
    width, height = rows[0][0].size
    across, down = width + GAP_PX, height + GAP_PX
    together = Image.new("RGB", (across * len(rows[0]) + GAP_PX, down * len(rows) + GAP_PX), (210,) * 3)
    for line, row in enumerate(rows):
        for column, cell in enumerate(row):
            together.paste(cell, (GAP_PX + across * column, GAP_PX + down * line))
    together.save(asked.out, quality=QUALITY, optimize=True)


if __name__ == "__main__":
    main()
