import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.robot.export.hpgl import CarouselLoad, hpgl
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
    *came, (_, corners) = drawn(hpgl([*strokes, edge], limits, 3)[0].text)
    assert np.all((corners >= lower[:2]) & (corners <= upper[:2]))
    assert [pen for pen, _ in came] == [paint + 1 for paint, _ in strokes]
    for (_, plotted), (_, path) in zip(came, strokes, strict=True):
        inside = np.minimum(path[:, :2], corners[1])  # the last whole unit
        np.testing.assert_allclose(plotted, inside if points > 1 else np.repeat(inside, 2, axis=0), atol=HPGL_METRES)
        assert np.all((plotted >= corners[0]) & (plotted <= corners[1]))


def test_a_pen_is_taken_once_for_all_strokes_in_a_row_and_put_back_at_the_end() -> None:
    line = np.array([[0.01, 0.02, 0.0], [0.03, 0.02, 0.0]])
    (load,) = hpgl([(0, line), (0, line), (1, line)], LIMITS)
    assert load == CarouselLoad(
        "IN;\nPU;SP1;\nPU400,800;PD1200,800;\nPU400,800;PD1200,800;\nPU;SP2;\nPU400,800;PD1200,800;\nPU;SP0;\n",
        (0, 1),
    )


def test_a_stroke_off_the_sheet_is_refused_with_by_how_much() -> None:
    with pytest.raises(InputError, match=r"the machine's y is 220 mm; it must be 0 to 210 mm: 10 mm less far"):
        hpgl([(0, np.array([[0.01, 0.22, 0.0]]))], LIMITS)


def test_pens_come_in_loads_of_what_the_carousel_has_and_the_order_stays() -> None:
    line = np.array([[0.01, 0.02, 0.0], [0.03, 0.02, 0.0]])
    order = [4, 2, 4, 0, 1, 4, 3]
    strokes = [(paint, line + np.array([1e-3 * i, 0, 0])) for i, paint in enumerate(order)]
    loads = hpgl(strokes, LIMITS, carousel=2)
    assert [load.paints for load in loads] == [(4, 2), (0, 1), (4, 3)]
    came = [(load.paints[pen - 1], path) for load in loads for pen, path in drawn(load.text)]
    assert [paint for paint, _ in came] == order
    for (_, plotted), (_, path) in zip(came, strokes, strict=True):
        np.testing.assert_allclose(plotted, path[:, :2], atol=HPGL_METRES)
    for load in loads:
        assert load.text.startswith("IN;\nPU;SP1;\n")
        assert load.text.endswith("PU;SP0;\n")


@given(st.lists(st.integers(0, 20), max_size=30), st.integers(1, 9))
def test_no_load_has_more_pens_than_the_carousel(paints: list[int], carousel: int) -> None:
    line = np.array([[0.01, 0.02, 0.0], [0.03, 0.02, 0.0]])
    loads = hpgl([(paint, line) for paint in paints], LIMITS, carousel)
    assert all(len(load.paints) <= carousel for load in loads)
    assert [load.paints[pen - 1] for load in loads for pen, _ in drawn(load.text)] == paints


@pytest.mark.parametrize(("speed", "written"), [(0.05, "VS5"), (0.0599, "VS5"), (0.38, "VS38"), (9.0, "VS127")])
def test_the_speed_is_written_in_whole_centimetres_per_second(speed: float, written: str) -> None:
    (load,) = hpgl([], LIMITS, speed=speed)
    assert load.text == f"IN;{written};\nPU;SP0;\n"


def test_a_speed_slower_than_hpgl_says_is_refused() -> None:
    with pytest.raises(InputError, match="speed is 5 mm/s; it must be at least 10 mm/s for HPGL"):
        hpgl([], LIMITS, speed=0.005)


def test_a_drawing_beyond_hpgls_numbers_is_refused_or_drawn_smaller() -> None:
    wide = LIMITS.model_copy(update={"upper": (1.2, 0.9, 0.01)})
    strokes = [(0, np.array([[0.1, 0.1, 0.0], [1.2, 0.9, 0.0]]))]
    with pytest.raises(InputError, match="reaches 1200 mm from the plotter's origin, and HPGL counts up to 819 mm"):
        hpgl(strokes, wide)
    ((_, plotted),) = drawn(hpgl(strokes, wide, shrink=True)[0].text)
    assert np.abs(plotted).max() == pytest.approx(32_767 / 40e3)
    np.testing.assert_allclose(plotted, strokes[0][1][:, :2] * (32_767 / 48_000), atol=2 * HPGL_METRES)
