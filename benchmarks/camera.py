"""How true the simulated webcam's photographs become: one JSON object per line, the mean over three cameras.

    .venv/bin/python benchmarks/camera.py

name: `places` on an A4 sheet, `one_tag_hidden` the same with three tags: rms_mm and worst_mm of 63 dots, and the
    error that was said.
`colours`: CIEDE2000 of 50 colours that are on no chart, as photographed, with a bare sheet known, with a grey card,
    with a chart.
`moved`: how far a move of the sheet by 8 mm and by 1 mm is missed, mm, blank and painted.
"""

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from skimage.color import deltaE_ciede2000, rgb2lab

from maulstick.calibration.chart import GREY_CARD, with_chart, with_grey_card
from maulstick.calibration.colour import lamp_of, whites_of
from maulstick.calibration.drift import MARGIN, shift_between
from maulstick.robot.simulated.camera import Optics

sys.path.append(str(Path(__file__).resolve().parents[1]))  # the tests are not installed
from tests.support.calibration.photo_studio import (
    CANVAS,
    CHART_CORNERS,
    PAPER,
    TAGS,
    Studio,
    bare,
    chart,
    dots,
    seen_dots,
    seen_squares,
    squares,
    strokes,
)

SEEDS = (1, 2, 3)
GRID = (10, 20, 15, 40, 57)
Row = dict[str, float]


def places(seed: int, hidden: tuple[int, ...] = ()) -> Row:
    sheet, middles = dots()
    studio = Studio(sheet, seed, Optics())
    studio.camera.cover(*hidden)
    _, view, flat = studio.look()
    misses = 1e3 * np.linalg.norm(seen_dots(flat, middles) - middles, axis=1)
    assert view.error is not None
    return {"rms_mm": np.sqrt(np.mean(misses**2)), "worst_mm": misses.max(), "said_mm": 1e3 * view.error[0]}


def colours(seed: int) -> Row:
    studio = Studio(bare(), seed, Optics())

    def seen(sheet: np.ndarray) -> tuple[np.ndarray, dict[int, np.ndarray]]:
        studio.sheet = sheet
        photo, view, flat = studio.look()
        return flat, whites_of(photo, view, TAGS)

    card = bare()
    high, wide = CANVAS.height_px, CANVAS.width_px
    card[high // 3 : 2 * high // 3, wide // 3 : 2 * wide // 3] = GREY_CARD
    area = (CANVAS.width / 3 + 5e-3, CANVAS.height / 3 + 5e-3, CANVAS.width / 3 - 10e-3, CANVAS.height / 3 - 10e-3)
    lamp = lamp_of(*seen(bare()), paper=(PAPER, PAPER, PAPER))
    charted, _ = with_chart(lamp, *seen(chart()), CANVAS, CHART_CORNERS)
    carded = with_grey_card(lamp, *seen(card), CANVAS, area)
    true = np.random.default_rng(4).uniform(0.1, 0.9, (50, 3))
    flat, whites = seen(squares(true, *GRID))
    ways = {"photographed": flat, **{name: known.correct(flat, whites) for name, known in
            {"bare_sheet": lamp, "grey_card": carded, "chart": charted}.items()}}  # fmt: skip
    lab = rgb2lab(true[None])
    return {name: deltaE_ciede2000(rgb2lab(seen_squares(f, 50, *GRID)[None]), lab).mean() for name, f in ways.items()}


def moved(seed: int) -> Row:
    row = {}
    for what, sheet in (("blank", bare()), ("painted", strokes(seed, 20))):
        for millimetres in (8, 1):
            studio = Studio(sheet, seed, Optics())
            before = studio.look(MARGIN)[2]
            studio.camera.move_paper(1e-3 * millimetres, 0.0)
            shift = shift_between(before, studio.look(MARGIN)[2], CANVAS)
            assert shift is not None
            row[f"{what}_{millimetres}_mm"] = abs(1e3 * shift.dx - millimetres) + abs(1e3 * shift.dy)
    return row


def mean(measure: Callable[[int], Row]) -> Row:
    rows = [measure(seed) for seed in SEEDS]
    return {name: round(float(np.mean([row[name] for row in rows])), 3) for name in rows[0]}


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    measures: dict[str, Callable[[int], Row]] = {
        "places": places,
        "one_tag_hidden": lambda seed: places(seed, (0,)),
        "colours": colours,
        "moved": moved,
    }
    for name, measure in measures.items():
        print(json.dumps({"name": name, **mean(measure)}), flush=True)
