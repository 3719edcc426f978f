"""How much several brushes in one plan gain over each of them alone: one JSON object per line.

    .venv/bin/python benchmarks/several_brushes.py [--seeds N] [--styles STYLE ...] [--brushes NAME,NAME ...]

400 strokes in 12 colours, tones alone, 256 pixels high: six photographs. psnr: at the truth.  counts: strokes of each
brush.  changes: of brush, as a machine paints it.  gain: psnr over the best of its brushes alone, of the same style,
photograph and seed. As many plans at a time as there are cores; how strokes are shared out among brushes was chosen on
three other photographs (china, flower and coins) and one seed.
"""

import argparse
import json
import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import product
from typing import Any

from photographs import HEIGHT, IMAGES, load

from maulstick.ordering.sequence import sequenced
from maulstick.painting.brush import load_brushes
from maulstick.painting.painting import Sheet
from maulstick.planning.from_picture import as_painting, metrics_of, problem_of, provenance_of
from maulstick.planning.layout import lay_out_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.style import load_style

PX = 256
SETS = ["wash,marker", "wash,marker,fineliner", "wash,round,fineliner"]


def planned(row: dict[str, Any]) -> dict[str, Any]:
    """The row with what its plan came to."""
    picture, brushes = load(row["image"]), load_brushes(row["brushes"])
    sheet = Sheet(width=HEIGHT * picture.shape[1] / picture.shape[0], height=HEIGHT)
    layout = lay_out_for(picture, sheet, brushes[0], "contain", PX)
    style = load_style(row["style"], layout.canvas)
    options = PlannerSettings(strokes=400, seed=row["seed"])
    found = plan(problem_of(layout, brushes, style, options, LossOptions()), options)
    painting = as_painting(found, layout, brushes, style, provenance_of(options))
    metrics = metrics_of(painting, layout)
    assert metrics is not None
    as_painted = sequenced(painting, (0.0, 0.0))
    used = [painting.paints[stroke.paint].brush for stroke in as_painted.strokes]
    return row | {
        "psnr": round(metrics.psnr, 3),
        "counts": {brush.name: used.count(brush.name) for brush in brushes},
        "changes": as_painted.brush_changes(),
    }


def with_gains(rows: Iterator[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """The rows, those of several brushes with their gain; their brushes alone come before them."""
    alone: dict[tuple[str, ...], float] = {}
    for row in rows:
        case = row["style"], row["image"], str(row["seed"])
        names = row["brushes"].split(",")
        if len(names) == 1:
            alone[(*case, row["brushes"])] = row["psnr"]
            yield row
        else:
            yield row | {"gain": round(row["psnr"] - max(alone[(*case, name)] for name in names), 3)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--styles", nargs="+", default=["free", "loops"])
    parser.add_argument("--brushes", nargs="+", default=SETS)
    asked = parser.parse_args()
    singles = dict.fromkeys(name for names in asked.brushes for name in names.split(","))
    rows = [
        {"style": style, "seed": seed, "image": image, "brushes": names}
        for style, seed, image, names in product(asked.styles, range(asked.seeds), IMAGES, [*singles, *asked.brushes])
    ]
    os.environ["OMP_NUM_THREADS"] = "1"
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        for row in with_gains(pool.map(planned, rows)):
            print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
