import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.plots.rows import largest_scale, rows_of


@given(st.lists(st.floats(0, 100), max_size=40), st.floats(0.5, 20))
def test_every_stroke_lies_in_one_row_beside_the_others_and_none_reaches_out(widths: list[float], gap: float) -> None:
    sizes = np.array(widths, dtype=np.float64)
    rows = rows_of(sizes, 100, gap)
    assert [index for row in rows for index in row.strokes] == list(range(len(widths)))
    for row in rows:
        ends = row.left + sizes[row.strokes]
        assert row.left[0] == pytest.approx(0, abs=1e-9)
        assert ends[-1] <= 100 + 1e-9
        assert (row.left[1:] - ends[:-1] >= gap - 1e-9).all()


def test_strokes_fill_a_row_and_those_of_the_last_stay_together() -> None:
    full, last = rows_of(np.array([30.0, 30, 30, 30, 30]), 100, 4.0)
    assert full.left.tolist() == [0, 35, 70]
    assert last.left.tolist() == [0, 38]


def test_the_largest_scale_that_fits_is_found() -> None:
    assert largest_scale(lambda scale: scale <= 3.7, 10) == pytest.approx(3.7, abs=1e-7)
    assert largest_scale(lambda scale: True, 10) == pytest.approx(10, abs=1e-7)
