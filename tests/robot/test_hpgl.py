import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.robot.export.hpgl import hpgl
from maulstick.robot.limits import Limits
from maulstick.storage.arrays import Floats
from tests.support.tolerances import HPGL_METRES

LIMITS = Limits(
    lower=(0, 0, -0.01), upper=(0.297, 0.21, 0.01), speed=0.4, climb=0.4, acceleration=2, varies_pressure=False
)


def drawn(text: str) -> list[tuple[int, Floats]]:
    """Read each stroke's pen and its points, metres, independently of the package."""
    pen, at, strokes = 0, "", []
    for command, numbers in re.findall(r"([A-Z]{2})([-\d,]*);", text):
        if command == "SP":
            pen = int(numbers)
        elif command == "PU" and numbers:
            at = numbers
        elif command == "PD":
            strokes.append((pen, np.array(f"{at},{numbers}".split(","), dtype=np.float64).reshape(-1, 2) / 40e3))
    return strokes


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(0, 5), points=st.integers(1, 9))
def test_a_plotter_draws_the_paths_to_half_a_unit_and_never_off_its_sheet(seed: int, count: int, points: int) -> None:
    rng = np.random.default_rng(seed)
    lower, upper = np.array(LIMITS.lower), np.array(LIMITS.upper)
    upper[:2] -= rng.uniform(0, 1e-4, 2)  # no whole number of units
    limits = LIMITS.model_copy(update={"upper": tuple(upper.tolist())})
    strokes = [(int(rng.integers(0, 3)), rng.uniform(lower, upper, (points, 3))) for _ in range(count)]
    edge = (0, np.stack([lower, upper]))
    *came, (_, corners) = drawn(hpgl([*strokes, edge], limits))
    assert np.all((corners >= lower[:2]) & (corners <= upper[:2]))
    assert [pen for pen, _ in came] == [paint + 1 for paint, _ in strokes]
    for (_, plotted), (_, path) in zip(came, strokes, strict=True):
        inside = np.minimum(path[:, :2], corners[1])  # the last whole unit
        np.testing.assert_allclose(plotted, inside if points > 1 else np.repeat(inside, 2, axis=0), atol=HPGL_METRES)
        assert np.all((plotted >= corners[0]) & (plotted <= corners[1]))


def test_a_pen_is_taken_once_for_all_strokes_in_a_row_and_put_back_at_the_end() -> None:
    line = np.array([[0.01, 0.02, 0.0], [0.03, 0.02, 0.0]])
    assert hpgl([(0, line), (0, line), (1, line)], LIMITS) == (
        "IN;\nPU;SP1;\nPU400,800;PD1200,800;\nPU400,800;PD1200,800;\nPU;SP2;\nPU400,800;PD1200,800;\nPU;SP0;\n"
    )


def test_a_stroke_off_the_sheet_is_refused_with_by_how_much() -> None:
    with pytest.raises(InputError, match=r"the machine's y is 220 mm; it must be 0 to 210 mm: 10 mm less far"):
        hpgl([(0, np.array([[0.01, 0.22, 0.0]]))], LIMITS)
