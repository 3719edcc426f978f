"""Plot of a fit: photographs, predictions and their differences, all at one scale."""

import io
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from maulstick.brush_fit.fit import Fit, HeldOutStroke
from maulstick.plots.brush_fit import fit_plot, measured
from tests.support.nominal import nominal

ERRORS = {"b_x": 2e-5, "opacity": 0.004, "alpha": 2e-4, "nib[0]": 0.01, "nib[1]": 0.02, "m_x": 0.0}
PHOTOGRAPH, PREDICTION = (0, 255, 0), (255, 0, 255)
LIGHTER, DARKER = (196, 69, 44), (47, 102, 144)


def a_view(name: str, size: tuple[int, int] = (20, 40), after: float = 0.0, predicted: float = 0.0) -> HeldOutStroke:
    """Make a view whose two pictures are each of one darkness."""
    shape = (*size, 1)
    return HeldOutStroke(name, np.full(shape, after, dtype=np.float32), np.full(shape, predicted, dtype=np.float32))


def a_fit(*views: HeldOutStroke) -> Fit:
    """Make a fit of the round brush."""
    brush = nominal("round").model_copy(update={"name": "twig", "nib": (0.1, -0.05), "b_x": -3e-4})
    return Fit(
        brush=brush,
        errors=ERRORS,
        warnings=("all strokes were drawn at pressure 0.50",),
        left_out=tuple(f"stroke {i} left no mark" for i in range(1, 13)),
        strokes=40,
        ink=(1.0,),
        place_scatter=3.1e-4,
        ink_scatter=0.08,
        l1=0.0042,
        l1_paper=0.0049,
        kept=("nib",),
        views=views or (a_view("stroke 1"),),
        pixels_per_metre=1000.0,
    )


def pixels(fit: Fit) -> NDArray[np.int64]:
    with Image.open(io.BytesIO(fit_plot(fit))) as image:
        return np.array(image.convert("RGB"), dtype=np.int64)


def where(plot: NDArray[np.int64], colour: tuple[int, int, int]) -> NDArray[np.int64]:
    return np.argwhere((np.abs(plot - colour) <= 2).all(axis=2))


def coloured(name: str, size: tuple[int, int]) -> HeldOutStroke:
    after, predicted = (
        np.ones((*size, 3), dtype=np.float32) * np.divide(c, 255, dtype=np.float32) for c in (PHOTOGRAPH, PREDICTION)
    )
    return HeldOutStroke(name, after, predicted)


def test_numbers_are_told_in_millimetres_as_far_as_they_are_known() -> None:
    assert measured(a_fit()) == {
        "m_x": "1.0000 ± 0.0000",
        "b_x": "-0.30 ± 0.02 mm",
        "alpha": "6.0 ± 0.2 mm",
        "opacity": "1.000 ± 0.004",
        "nib": "0.10 ± 0.01, -0.05 ± 0.02",
    }


def test_a_prediction_stands_below_its_photograph_at_the_same_scale() -> None:
    plot = pixels(a_fit(coloured("stroke 1", (30, 50))))
    photograph, prediction = where(plot, PHOTOGRAPH), where(plot, PREDICTION)
    assert np.ptp(photograph, axis=0) == pytest.approx(np.ptp(prediction, axis=0), abs=1)
    assert photograph[:, 1].min() == pytest.approx(prediction[:, 1].min(), abs=1)
    assert photograph[:, 0].max() < prediction[:, 0].min()
    high, wide = np.ptp(photograph, axis=0)
    assert high / wide == pytest.approx(30 / 50, rel=0.02)


def test_views_of_all_sizes_have_one_scale() -> None:
    small, large = (20, 30), (40, 90)
    plot = pixels(a_fit(coloured("a", small), a_view("b", large, 1.0, 1.0)))
    green = np.ptp(where(plot, PHOTOGRAPH), axis=0)
    black = where(plot[plot.shape[0] // 3 :], (0, 0, 0))
    assert green[1] / np.ptp(black, axis=0)[1] == pytest.approx(30 / 90, rel=0.05)


@pytest.mark.parametrize(
    ("after", "predicted", "colour"), [(0.8, 0.2, LIGHTER), (0.2, 0.8, DARKER), (0.0, 0.0, (255, 255, 255))]
)
def test_a_difference_is_red_where_the_prediction_is_too_light_and_blue_where_too_dark(
    after: float, predicted: float, colour: tuple[int, int, int]
) -> None:
    plot = pixels(a_fit(a_view("stroke 1", (30, 60), after, predicted)))[plot_rows()]
    for other in (LIGHTER, DARKER):
        assert (len(where(plot, other)) > 1000) == (other == colour)
    assert len(where(plot, colour)) > 1000


def plot_rows() -> slice:
    """Rows of pixels of a plot that show the views."""
    return slice(540, 1290)


@pytest.mark.parametrize(("size", "count"), [((400, 5), 1), ((5, 400), 12), ((3, 3), 12)])
def test_any_number_of_views_of_any_size_fits(size: tuple[int, int], count: int) -> None:
    views = [coloured(f"stroke {i}", size) for i in range(count)]
    found = where(pixels(a_fit(*views)), PREDICTION)
    assert len(found)
    assert plot_rows().start < found[:, 0].min()
    assert found[:, 0].max() < plot_rows().stop


def test_the_same_fit_is_the_same_picture() -> None:
    fit = a_fit()
    assert fit_plot(fit) == fit_plot(fit)
    assert fit_plot(fit) != fit_plot(replace(fit, l1=0.005))
