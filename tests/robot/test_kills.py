"""Painting that is killed at random moments and goes on by its journal (benchmarks/robot.py kills)."""

from pathlib import Path

import numpy as np
import pytest

from tests.support.robot.kills import Tally, killed, shares
from tests.support.robot.mortal_machines import Kill

KILLS = 20


@pytest.mark.timeout(120)
@pytest.mark.parametrize(("name", "kill", "share"), list(shares(KILLS)))
def test_whatever_kills_it_no_stroke_is_lost_or_doubled_and_the_pen_is_up(
    tmp_path: Path, name: str, kill: Kill, share: int
) -> None:
    tally = killed(name, kill, share, np.random.default_rng(0), tmp_path)
    assert tally == Tally(kills=share, paintings=tally.paintings)


def test_kills_are_shared_among_all_machines() -> None:
    given = [share for _, _, share in shares(KILLS)]
    assert sum(given) == KILLS
    assert max(given) - min(given) <= 1
