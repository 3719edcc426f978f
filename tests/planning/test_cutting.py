import numpy as np
import pytest

from maulstick.painting.painting import Sheet
from maulstick.planning.cutting import cut_at_edges

SHEET = Sheet(width=0.2, height=0.1)


def line(*ends: tuple[float, float], points: int = 32) -> np.ndarray:
    """A path through these places, with even steps between two, a rising pressure and a speed."""
    at = np.linspace(0, len(ends) - 1, points)
    xy = np.stack([np.interp(at, range(len(ends)), column) for column in np.transpose(ends)], axis=1)
    return np.column_stack([xy, np.linspace(0, 1, points), np.full(points, 0.05)])


def test_what_lies_on_the_sheet_stays_to_the_bit_and_nothing_given_is_changed() -> None:
    paths = np.stack([line((0, 0), (0.2, 0.1)), line((-0.1, 0.05), (0.3, 0.05))])
    before = paths.copy()
    cut = cut_at_edges(paths, SHEET)
    assert np.array_equal(cut[0], paths[0])
    assert not np.array_equal(cut[1], paths[1])
    assert np.array_equal(paths, before)
    assert cut_at_edges(np.zeros((0, 32, 3)), SHEET).shape == (0, 32, 3)


def test_a_stroke_beyond_both_edges_keeps_its_middle_with_the_pressure_and_the_speed_there() -> None:
    (cut,) = cut_at_edges(line((-0.1, 0.05), (0.3, 0.05))[None], SHEET)
    assert cut.shape == (32, 4)
    assert cut[[0, -1], 0] == pytest.approx([0, 0.2], abs=3e-4)
    assert cut[:, 0].min() >= 0
    assert cut[:, 0].max() <= 0.2
    assert cut[[0, -1], 2] == pytest.approx([0.25, 0.75], abs=1e-3)
    assert (np.diff(cut[:, 0]) > 0).all()
    assert cut[:, 1:].T[[0, 2]] == pytest.approx(np.array([[0.05] * 32] * 2))


def test_of_a_stroke_that_leaves_and_comes_back_the_longer_piece_stays() -> None:
    there_and_back = line((0.18, 0.02), (0.25, 0.05), (0.05, 0.08))
    (cut,) = cut_at_edges(there_and_back[None], SHEET)
    assert cut[-1] == pytest.approx(there_and_back[-1])
    assert cut[0, 0] == pytest.approx(0.2, abs=3e-4)
    assert cut[:, :2].max() <= 0.2


def test_a_stroke_around_the_sheet_shrinks_to_a_dot_at_its_edge() -> None:
    around = line((-0.05, -0.03), (0.25, -0.03), (0.25, 0.13), (-0.05, 0.13))
    (cut,) = cut_at_edges(around[None], SHEET)
    assert np.ptp(cut[:, :2], axis=0).tolist() == [0, 0]
    assert SHEET.overhang(cut[None, :, :2])[0] <= 0
