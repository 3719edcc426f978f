"""Drawings in several inks beside the same pens used as paints, as one JSON object per line.

    .venv/bin/python benchmarks/inks.py

1,000 strokes of a fineliner on 240 x 160 mm, hands at half their size, two of them, three photographs, two seeds.
psnr_blurred, ssim: beside the picture in its own colours, at the truth; psnr_blurred after a blur of 2 mm.
energy: unbiased energy distance of how strokes lie, whatever their ink, to the drawing that the hand was learned from,
by the numbers of descriptors.py that need no order; others: the mean of the 41 other drawings.
"""

import argparse
import csv
import json
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np
from drawings import drawings
from judge import Described
from photographs import load

import maulstick as ms
from maulstick.painting.metrics import blurred_psnr, compare
from maulstick.painting.painting import Painting
from maulstick.planning.layout import lay_out_for
from maulstick.rendering.preview import truth
from maulstick.style.compare import energy_distance

HANDS, SEEDS = ("elephant", "moscow"), (0, 1)
PENS = {
    "chelsea": ("#000000", "#8a4b2a", "#d09a5a", "#5a7f96"),
    "astronaut": ("#000000", "#d2691e", "#1f5fa8", "#c8a07a", "#b02a30"),
    "coffee": ("#000000", "#b5651d", "#c0392b", "#e0c48a"),
}
STROKES, HAND_SIZE, SIZE, FIT, BRUSH = 1000, 0.5, "240x160mm", "cover", "fineliner"
BLUR = 2e-3  # metres


def beside_picture(painting: Painting, picture: np.ndarray) -> dict[str, float]:
    """How near it comes to the picture in its own colours."""
    brush = next(iter(painting.brushes.values()))
    layout = lay_out_for(picture, painting.sheet, brush, FIT, 320)
    assert layout.target is not None
    true, target = layout.crop(truth(painting, layout.canvas)), layout.crop(layout.target)
    blurred = blurred_psnr(true, target, BLUR * layout.canvas.pixels_per_metre)
    return {"psnr_blurred": round(blurred, 2), "ssim": round(compare(true, target).ssim, 3)}


def rows() -> Iterator[dict[str, object]]:
    """A row for each hand, photograph, seed, and way to use the pens."""
    judge = Described.all(drawings(), lambda paths: paths)
    usual = {"brush": BRUSH, "strokes": STROKES, "hand_size": HAND_SIZE, "size": SIZE, "fit": FIT}
    with TemporaryDirectory() as folder:
        for hand, (picture, pens), seed in product(HANDS, PENS.items(), SEEDS):
            tubes = Path(folder, f"{picture}.csv")
            with tubes.open("w", newline="") as file:
                csv.writer(file).writerows([("name", "colour"), *((f"pen {pen}", pen) for pen in pens)])
            others = [energy_distance(each, judge.of[hand]) for name, each in judge.of.items() if name != hand]
            for way, asked in {"inks": {"ink": ",".join(pens)}, "paints": {"paints_from": tubes}}.items():
                began = perf_counter()
                found = ms.plan(load(picture), style=hand, seed=seed, **usual, **asked)
                seconds = round(perf_counter() - began)
                paths = np.array([stroke.trajectory for stroke in found.strokes])[..., :2]
                row = {"hand": hand, "picture": picture, "seed": seed, "way": way, "strokes": len(found.strokes)}
                lies = {"energy": round(energy_distance(judge.new(paths), judge.of[hand]), 3)}
                ends = {"others": round(float(np.mean(others)), 3), "seconds": seconds}
                yield row | beside_picture(found, load(picture)) | lies | ends


def main() -> None:
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    for row in rows():
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
