"""What is on the paper after painting was killed at random moments and went on with --resume; for robot.py.

Five machines: Grbl with a servo's pen and with one that it lifts by height, EiBotBoard (on pseudo-terminals), a
simulated arm, and the simulated easel. Four kills: SIGKILL of the program, Ctrl-C, the cable, and the power of the
machine, of which the EiBotBoard's is that of its motors; not every machine can suffer each. After each, the stroke
that was begun is answered by what is on the paper: "painted" where it is there from end to end, else "again".
"""

import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1]))  # the tests are not installed
from tests.support.robot.kills import killed, shares

KILLS, FEW, SEED = 200, 20, 1
Row = dict[str, object]


def rows(quick: bool) -> Iterator[Row]:
    """One row per machine and kind of kill; 20 kills in all where it must be quick.

    paintings: of six strokes each, whole in the end.  lost: strokes that are not on the paper.  doubled: strokes that
    are there twice, other than those that were under the pen.  stray: lines of the pen beside all strokes.
    pen_left_down_while_line_lives: kills after which the pen was down, although the program could still reach the
    machine; not after a SIGKILL, where the next run lifts it before it moves, or leaves a stray line.
    """
    rng = np.random.default_rng(SEED)
    for name, kill, share in shares(FEW if quick else KILLS):
        started = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            tally = killed(name, kill, share, rng, Path(folder))
        yield {
            "name": "kills",
            "machine": name,
            "kill": kill,
            "kills": tally.kills,
            "paintings": tally.paintings,
            "lost": tally.lost,
            "doubled": tally.doubled,
            "stray": tally.stray,
            "pen_left_down_while_line_lives": tally.left_down,
            "seconds": time.perf_counter() - started,
        }
