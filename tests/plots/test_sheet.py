import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.plots.sheet import length_text, round_length


@given(st.floats(1e-6, 1e6))
def test_a_scale_bar_is_as_long_as_fits_and_a_round_number(most: float) -> None:
    length = round_length(most)
    assert most / 2.5 * (1 - 1e-6) <= length <= most * (1 + 1e-6)
    assert length / 10 ** np.floor(np.log10(length * 1.001)) == pytest.approx(1) or str(f"{length:.0e}")[0] in "25"


def test_lengths_are_told_in_the_unit_that_suits_them() -> None:
    told = [length_text(metres) for metres in (0, 5e-4, 0.02, 0.9, 1, 20, 331.4)]
    assert told == ["0 mm", "0.5 mm", "20 mm", "900 mm", "1 m", "20 m", "331 m"]
