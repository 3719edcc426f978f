"""In which order strokes are drawn, beside the order of the hand, as one JSON object per line.

    .venv/bin/python benchmarks/order.py

What is drawn, `strokes`: those of the 8 plans of each of `held` and `arranged` that `arrangement.py --quick` keeps;
and, of eight hands and four splits into halves, those of `other_half`, at their own places: the half that judges.

In which `order`: `tour`, little travel of the lifted pen; `nearest`, always the nearest end; `random`; `hand`, as the
hand would draw them by what it drew in the half that was learned from. Strokes are drawn backwards where that leaves
the same mark, but not in a random order. `own`: the half that was learned from, as it was drawn.

`order_nats`: surprise at each next stroke of a logit that was fitted on the half that judges, see `succession.py`.
`energy`: energy distance of the logit's numbers of each stroke and the next, in units of their spread, to those of the
half that judges.  `followed`: share of the strokes of `other_half` behind which comes the one that the hand drew next.
`metres`: travel of the lifted pen; `tour_metres`, that of the tour.
"""

import argparse
import json
from collections.abc import Iterator

import numpy as np
from arrangement import cases, planned
from drawings import HANDS, SPLITS, Floats, drawings, halves, placed
from scipy.spatial import cKDTree
from succession import Succession, steps

from maulstick.ordering.sequence import reversible
from maulstick.ordering.succession import drawn_by
from maulstick.ordering.tour import Tour, pen_up, tour
from maulstick.storage.arrays import Bools
from maulstick.style.arrangement.order import succession_of
from maulstick.style.compare import energy_distance

START = (0.0, 0.0)
Row = dict[str, str | int | float | None]


def main() -> None:
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    for row in rows():
        print(json.dumps({key: round(x, 4) if isinstance(x, float) else x for key, x in row.items()}), flush=True)


def rows() -> Iterator[Row]:
    for hand in HANDS:
        for split in range(len(SPLITS)):
            learned, judging = parts(hand, split)
            case: Row = {"hand": hand, "split": split, "photograph": None}
            own = Tour(np.arange(len(learned)), np.zeros(len(learned), dtype=np.bool_))
            whole = np.ones(len(learned), dtype=np.bool_)
            quick = tour(learned[:, [0, -1]], whole, START)
            yield {"strokes": "people", "order": "own", **case, **measured(learned, own, quick, judging)}
            for row in orders(judging, np.ones(len(judging), dtype=np.bool_), hand, split):
                yield {"strokes": "other_half", **case, **row}
    for strokes in ("held", "arranged"):
        for of in cases(strokes, quick=True):
            painting = planned(of)
            case = {"hand": of.hand, "split": of.split, "photograph": of.photograph}
            for row in orders(painting.trajectories()[..., :2], reversible(painting), of.hand, of.split):
                yield {"strokes": strokes, **case, **row}


def parts(hand: str, split: int) -> tuple[Floats, Floats]:
    """Strokes (N, n, 2) of a drawing that are learned from, and those that judge."""
    paths = placed(drawings()[hand])
    learned, judging = halves(len(paths), split)
    return paths[learned], paths[judging]


def orders(paths: Floats, may: Bools, hand: str, split: int) -> Iterator[Row]:
    """Rows of strokes (N, n, 2) in each order; `may`: whether each may be drawn backwards, (N,)."""
    learned, judging = parts(hand, split)
    ends = paths[:, [0, -1]]
    quick = tour(ends, may, START)
    ways = {
        "tour": quick,
        "nearest": nearest(ends, may),
        "random": Tour(np.random.default_rng(0).permutation(len(paths)), np.zeros_like(may)),
        "hand": drawn_by(succession_of(learned), paths, may, quick),
    }
    for order, way in ways.items():
        followed = float((np.diff(way.order) == 1).mean()) if np.array_equal(paths, judging) else None
        yield {"order": order, **measured(paths, way, quick, judging), "followed": followed}


def measured(paths: Floats, way: Tour, quick: Tour, judging: Floats) -> Row:
    """What is measured of strokes (N, n, 2) that are drawn on this way."""
    ends, drawn = paths[:, [0, -1]], paths[way.order]
    drawn = np.where(way.turned[:, None, None], drawn[:, ::-1], drawn)
    theirs = steps(judging)
    return {
        "order_nats": Succession.of(judging).nats(drawn),
        "energy": energy_distance(steps(drawn) / theirs.std(axis=0), theirs / theirs.std(axis=0)),
        "metres": pen_up(ends, way, START),
        "tour_metres": pen_up(ends, quick, START),
    }


def nearest(ends: Floats, may: Bools) -> Tour:
    """The tour through strokes that begin and end at (N, 2, 2) that always goes on where the nearest begins."""
    begins = np.flatnonzero(np.column_stack([np.ones_like(may), may]))
    points, drawn, at = ends.reshape(-1, 2), [], np.array(START)
    while len(begins):
        way = begins[cKDTree(points[begins]).query(at)[1]]
        drawn.append(way)
        at, begins = points[way ^ 1], begins[begins // 2 != way // 2]
    return Tour(np.array(drawn) // 2, np.array(drawn) % 2 == 1)


if __name__ == "__main__":
    main()
