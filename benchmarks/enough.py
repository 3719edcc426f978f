"""How many strokes one ink needs: `--strokes auto` beside bisecting, as one JSON object per line.

    .venv/bin/python benchmarks/enough.py            # how many of a fineliner
    .venv/bin/python benchmarks/enough.py --tones    # how near so many come, of three pens

A plan of so many strokes, whose tones are not compressed, reaches a picture where its mean ink is 97 % of that.
Bisecting finds the fewest that do, to 3 %, with plans of 300 steps; `ratio` is what `--strokes auto` takes over that.
--tones: `psnr_blurred`, dB after a blur of 2 mm, of usual plans of so many strokes beside the picture in the tones that
    they can give, whose L* are `lightest` and `darkest`. pressed: as many strokes, pressed hardest, give that ink.
    in_colours: dB, in the same way, of what the ink can show beside the picture in its colours: no plan comes nearer.
"""

import argparse
import json
from collections.abc import Iterator
from itertools import product

import numpy as np
import torch
from held import BRUSHES, PX, SHEET, style_of
from photographs import load

import maulstick as ms
from maulstick.painting.brush import load_brush
from maulstick.painting.metrics import blurred_psnr
from maulstick.painting.painting import Sheet
from maulstick.planning.from_picture import as_painting, problem_of, provenance_of
from maulstick.planning.layout import Layout, lay_out_for
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.tones import InkSupply
from maulstick.rendering.preview import truth

HANDS, PICTURES = ("lia", "contour", "scribble"), ("chelsea", "astronaut")
STEPS, REACHED, FINE = 300, 0.97, 1.03
BLACK = (0.0, 0.0, 0.0)
BLUR = 2e-3  # metres


def fewest(hand: str, picture: str) -> tuple[int, int]:
    """What is taken, and what bisecting finds."""
    style, brush = style_of(hand), load_brush("fineliner")
    layout, supply = supply_of(hand, picture, "fineliner")

    def reaches(strokes: int) -> bool:
        options = PlannerSettings(strokes=strokes, exact=True, paints=None, steps=STEPS)
        found = plan(problem_of(layout, (brush,), style, options), options)
        painting = as_painting(found, layout, (brush,), style, provenance_of(options))
        ink = 1 - truth(painting, layout.canvas).mean(axis=2)
        return bool(ink.mean() >= REACHED * supply.amounts.mean())

    low, high = supply.enough // 2, 2 * supply.enough
    while high > FINE * low:
        middle = round(np.sqrt(low * high))
        low, high = (low, middle) if reaches(middle) else (middle, high)
    return supply.enough, high


def numbers() -> Iterator[dict[str, object]]:
    """What is taken beside what is needed: a row for each hand and picture."""
    for hand, picture in product(HANDS, PICTURES):
        taken, found = fewest(hand, picture)
        yield {"hand": hand, "picture": picture, "auto": taken, "bisected": found, "ratio": round(taken / found, 3)}


def supply_of(hand: str, picture: str, brush: str) -> tuple[Layout, InkSupply]:
    """The picture on the sheet, and the ink that it needs and that a stroke gives."""
    pen = load_brush(brush)
    layout = lay_out_for(load(picture), Sheet(width=SHEET[0], height=SHEET[1]), pen, "contain", PX)
    supply = InkSupply.of(layout, pen, style_of(hand), (BLACK,), with_lines=False)
    assert supply is not None
    return layout, supply


def tones() -> Iterator[dict[str, object]]:
    """How near plans of what is taken come: a row for each brush, hand and picture."""
    size = "x".join(f"{side * 1e3:g}" for side in SHEET) + "mm"
    for brush, hand, picture in product(BRUSHES, HANDS, PICTURES):
        style = style_of(hand)
        layout, supply = supply_of(hand, picture, brush)
        shown, target = layout.crop(layout.under * (1 - supply.amounts[..., None])), layout.crop(layout.target)
        in_colours = blurred_psnr(shown, target, BLUR * layout.canvas.pixels_per_metre)
        found = ms.plan(load(picture), style=style, brush=brush, strokes="auto", ink="black", size=size, px=PX, seed=0)
        metrics = {key: round(found.provenance.metrics[key], 1) for key in ("psnr_blurred", "lightest", "darkest")}
        row = {"brush": brush, "hand": hand, "picture": picture, "auto": supply.enough, "pressed": supply.fewest}
        yield row | metrics | {"in_colours": round(in_colours, 1)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tones", action="store_true", help="how near plans of so many strokes come to their tones")
    torch.set_num_threads(1)
    for row in tones() if parser.parse_args().tones else numbers():
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
