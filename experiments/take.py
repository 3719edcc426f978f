"""Write what motion capture would see of a person who draws: a take and a pivot take, as Motive exports them.

    .venv/bin/python experiments/take.py take.csv pivot.csv

The strokes are those of the built-in hand `loops`, the pen and the cameras are simulated, with their noise and losses.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

from maulstick.style.cards import style_path
from maulstick.style.store import read_style

sys.path.append(str(Path(__file__).resolve().parents[1]))  # the tests are not installed
from tests.support.recording.motive_export import motive_csv
from tests.support.recording.simulated_take import paced, pivot_take, simulate

STROKES, COLUMNS = 30, 6
CELL = np.array([0.035, 0.033])  # metres of the sheet per stroke
SHORTEST = 3e-3  # metres: less is a dot


def main() -> None:
    """Write both."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("take", type=Path, help="CSV of the take to write")
    parser.add_argument("pivot", type=Path, help="CSV of the pivot take to write")
    parser.add_argument("--strokes", type=int, default=STROKES)
    chosen = parser.parse_args()
    paths = [path for path in read_style(style_path("loops")).hand.paths if np.ptp(path, axis=0).max() > SHORTEST]
    strokes = []
    for number, path in enumerate(paths[: chosen.strokes]):
        middle = (np.array([number % COLUMNS, number // COLUMNS]) + 0.6) * CELL
        smaller = min(1.0, 0.9 * CELL.min() / np.ptp(path, axis=0).max())
        strokes.append(paced((path - path.mean(axis=0)) * smaller + middle))
    chosen.take.write_bytes(motive_csv(simulate(strokes, 1).take))
    chosen.pivot.write_bytes(motive_csv(pivot_take(3)))


if __name__ == "__main__":
    main()
