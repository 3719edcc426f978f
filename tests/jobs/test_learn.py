import numpy as np
import pytest

from maulstick.jobs.learn import learn_style, strokes_of
from tests.support.drawn import as_strokes, hatching


def test_one_recording_lies_where_it_was_drawn() -> None:
    drawn = as_strokes(hatching(4, seed=0))
    assert np.array_equal(strokes_of([drawn]).poses, drawn.poses)


def test_no_stroke_of_a_recording_is_near_one_of_another() -> None:
    parts = [as_strokes(hatching(4, seed=seed)) for seed in range(3)]
    together = strokes_of(parts)
    arrangement = learn_style("patches", together, "exemplar").arrangement
    assert arrangement is not None
    assert [rows.tolist() for rows in arrangement.groups] == np.arange(96).reshape(12, 8).tolist()
    first, *later = np.split(together.placed()[..., 0], 3)
    for xs in later:
        assert xs.min() - first.max() >= max(part.lengths.max() for part in parts) - 1e-9
        first = xs


def test_strokes_of_a_recording_lie_to_each_other_as_before() -> None:
    parts = [as_strokes(hatching(4, seed=seed)) for seed in range(2)]
    moved = strokes_of(parts).poses[32:] - parts[1].poses
    assert moved == pytest.approx(np.tile(moved[:1], (32, 1)))
    assert moved[0, 1:].tolist() == [0, 0]
