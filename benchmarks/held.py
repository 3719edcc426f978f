"""Whether a plan's strokes are still the hand's: eleven hands, three brushes, one ink or twelve paints.

    .venv/bin/python benchmarks/held.py                # 66 rows, and 108 of three hands with other pictures and seeds
    .venv/bin/python benchmarks/held.py lia hatching   # the rows of these hands

Strokes of the finished painting are compared with all strokes that the style was fitted on; dots are left out.
`ks_*` are Kolmogorov-Smirnov distances; 500 draws from the hand itself have about 0.03. Lengths are compared by their
90 % quantile, by the mean of the longest tenth, and by the longest. `edge_ink_ratio` is the share of the ink within
3 mm of the picture's edge less 2 %, over the share of the picture's darkness there. `novelty` is the mean distance of
a stroke to the hand's nearest, in units of other hands' (`few_shot.py`). `psnr_blurred` is of one ink, after a blur of
2 mm, beside the picture in the tones that strokes can give, whose L* are `lightest` and `darkest`. Rows of plans
`before` lengths were held are kept as they were measured (commit d1b2b56).
"""

import argparse
import json
import multiprocessing
import time
from dataclasses import dataclass
from itertools import product

import numpy as np
import torch
from kept import rows_of
from numpy.typing import NDArray
from photographs import load
from recordings import LEAST, MOCAP, mocap_hands
from scipy.stats import ks_2samp

import maulstick as ms
from maulstick.painting.painting import Painting
from maulstick.planning.layout import lay_out_for
from maulstick.rendering.preview import truth
from maulstick.strokes.strokes import path_lengths
from maulstick.style.cards import style_path
from maulstick.style.compare import describe, distance_to_nearest
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from maulstick.style.store import load_hands, read_style

Floats = NDArray[np.float64]
BUILT_IN = ("contour", "cursive", "hatching", "loops", "marks", "scribble")
HANDS = MOCAP + BUILT_IN
BRUSHES = ("fineliner", "marker", "round")
PAINTS = (None, 12)
SHEET, PX, STROKES = (0.24, 0.16), 320, 500
MORE_HANDS, MORE_PICTURES, SEEDS = ("lia", "cat", "hatching"), ("astronaut", "coffee"), (0, 1, 2)
COLUMNS = {"ks_chord": 1, "ks_turning": 2, "ks_roughness": 12}
"""Columns of a description."""
EDGE = 3e-3
"""Metres."""
PROCESSES = 2


@dataclass(frozen=True)
class Wanted:
    """One row."""

    hand: str
    brush: str
    paints: int | None
    picture: str = "chelsea"
    seed: int = 0


def style_of(hand: str) -> Exemplar:
    """A built-in style, or one of all strokes of a session."""
    if hand in BUILT_IN:
        style = read_style(style_path(hand))
        assert isinstance(style, Exemplar)
        return style
    return Exemplar.fit(hand, Hand.of(mocap_hands()[hand]), load_hands())


def row(wanted: Wanted) -> dict[str, object]:
    """Plan, and measure."""
    torch.set_num_threads(1)
    style = style_of(wanted.hand)
    colours = {"ink": "black"} if wanted.paints is None else {"paints": wanted.paints}
    picture, size = load(wanted.picture), f"{SHEET[0] * 1e3:g}x{SHEET[1] * 1e3:g}mm"
    options = {"strokes": STROKES, "size": size, "px": PX, "seed": wanted.seed, "device": "cpu", **colours}
    started = time.perf_counter()
    painting = ms.plan(picture, style=style, brush=wanted.brush, **options)
    seconds = time.perf_counter() - started
    paths = painting.trajectories()[..., :2].astype(np.float64)
    found = painting.provenance.metrics
    return (
        {**vars(wanted), "plan": "now", "strokes": len(paths)}
        | of_strokes(paths, style.hand.paths)
        | {"novelty": novelty(paths, wanted.hand), "edge_ink_ratio": edge_ink_ratio(painting, picture)}
        | {key: found.get(key) for key in ("psnr", "psnr_blurred", "lightest", "darkest")}
        | {"seconds": seconds}
    )


def of_strokes(paths: Floats, hand: Floats) -> dict[str, object]:
    """How far strokes (N, 32, 2) are from a hand's, (M, 32, 2)."""
    paths = paths[path_lengths(paths) >= LEAST]
    lengths, own = path_lengths(paths), path_lengths(hand)
    described, of_hand = describe(paths), describe(hand)
    return {
        "ks_length": ks_2samp(lengths, own).statistic,
        **{name: ks_2samp(described[:, at], of_hand[:, at]).statistic for name, at in COLUMNS.items()},
        "p90_ratio": np.quantile(lengths, 0.9) / np.quantile(own, 0.9),
        "top_tenth_ratio": longest_tenth(lengths) / longest_tenth(own),
        "longest_ratio": lengths.max() / own.max(),
    }


def longest_tenth(lengths: Floats) -> float:
    """Mean length of the longest tenth."""
    return float(np.sort(lengths)[-max(1, len(lengths) // 10) :].mean())


def novelty(paths: Floats, name: str) -> float:
    """Mean distance to the hand's nearest stroke, in units of other hands'."""
    described = {hand: describe(style_of(hand).hand.paths) for hand in HANDS}
    together = np.concatenate(list(described.values()))
    spread = together.std(axis=0)
    own = described.pop(name) / spread
    others = np.mean([distance_to_nearest(other / spread, own) for other in described.values()])
    return distance_to_nearest(describe(paths) / spread, own) / float(others)


def edge_ink_ratio(painting: Painting, picture: Floats) -> float:
    """Share of the ink near the edge of the picture's area less 2 %, over the share of its darkness there."""
    layout = lay_out_for(picture, painting.sheet, painting.brushes[painting.paints[0].brush], "contain", PX)
    assert layout.target is not None
    bare, true = layout.crop(layout.under), layout.crop(truth(painting, layout.canvas))
    depth = round(EDGE * layout.canvas.pixels_per_metre)
    edge = np.ones(bare.shape[:2], dtype=bool)
    edge[depth:-depth, depth:-depth] = False
    ink, dark = (np.abs(bare - image).mean(axis=2) for image in (true, layout.crop(layout.target)))
    return float((ink[edge].sum() / ink.sum() - 0.02) / (dark[edge].sum() / dark.sum()))


def main() -> None:
    """Make the rows of the hands that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("hands", nargs="*", metavar="HAND", help=f"of {', '.join(HANDS)}; all by default")
    names = parser.parse_args().hands or HANDS
    if unknown := set(names) - set(HANDS):
        parser.error(f"there is no hand {min(unknown)}; there are: {', '.join(HANDS)}")
    wanted = [Wanted(hand, brush, paints) for brush, paints, hand in product(BRUSHES, PAINTS, names)]
    wanted += [
        Wanted(*each)
        for each in product([name for name in names if name in MORE_HANDS], BRUSHES, PAINTS, MORE_PICTURES, SEEDS)
    ]
    for kept in rows_of("held"):
        if kept["plan"] == "before":
            print(json.dumps(kept), flush=True)
    with multiprocessing.get_context("spawn").Pool(PROCESSES) as pool:
        for found in pool.imap(row, wanted):
            print(json.dumps({key: round(x, 3) if isinstance(x, float) else x for key, x in found.items()}), flush=True)


if __name__ == "__main__":
    main()
