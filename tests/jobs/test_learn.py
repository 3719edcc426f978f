from pathlib import Path

import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.jobs.learn import learn_style, strokes_of
from maulstick.strokes.ink import Ink, write_ink
from maulstick.strokes.strokes import Strokes, write_strokes
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


def test_a_recording_counts_once_whatever_its_file_is_called(tmp_path: Path) -> None:
    ink = Ink.of([np.array([[0.0, 0.01, 0.01 * i, 0.5], [1.0, 0.05, 0.02, 0.6]]) for i in range(6)], (0.1, 0.1))
    ink_file, strokes_file = tmp_path / "me.ink.npz", tmp_path / "me.strokes.npz"
    write_ink(ink, ink_file)
    write_strokes(Strokes.of(ink), strokes_file)
    for twice in ([ink, ink], [ink_file, str(ink_file)], [ink_file, strokes_file]):
        with pytest.raises(InputError, match="a recording, or its copy, is named twice, and its strokes would count"):
            strokes_of(twice)
    nothing = Ink.of([], (0.1, 0.1))
    assert len(strokes_of([nothing, ink, nothing])) == 6


def test_strokes_of_a_recording_lie_to_each_other_as_before() -> None:
    parts = [as_strokes(hatching(4, seed=seed)) for seed in range(2)]
    moved = strokes_of(parts).poses[32:] - parts[1].poses
    assert moved == pytest.approx(np.tile(moved[:1], (32, 1)))
    assert moved[0, 1:].tolist() == [0, 0]


def test_strokes_of_another_number_of_points_are_refused_also_beside_others() -> None:
    drawn = as_strokes(hatching(2, seed=0))
    coarse = Strokes(drawn.trajectories[:, ::2], drawn.times[:, ::2], drawn.poses)
    with pytest.raises(InputError, match=r"^the number of points of a stroke is 16; it must be 32$"):
        strokes_of([drawn, coarse])
