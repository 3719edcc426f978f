"""Plot of a brush: its charts agree with what is drawn."""

import io

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from maulstick.painting.brush import Brush, load_brush
from maulstick.plots import brush as module
from maulstick.plots.brush import brush_plot, profile
from maulstick.plots.sheet import Plot
from maulstick.rendering.kernels.reference import darkness
from maulstick.rendering.traj2stroke import Traj2Stroke
from tests.support.nominal import nominal

PX = 480
FULL = {
    "nib": (0.1, -0.05),
    "lag": 2e-3,
    "touch": (1e-3, -2e-3),
    "faint": 0.6,
    "solid": 0.8,
    "lightest": 0.05,
}


def pixels(brush: Brush, px: int = PX) -> NDArray[np.int64]:
    with Image.open(io.BytesIO(brush_plot(brush, "", px))) as image:
        assert image.height == px
        return np.array(image.convert("RGB"), dtype=np.int64)


def mark(plot: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the part of the plot with the mark."""
    return plot[round(0.15 * PX) : round(0.38 * PX), 20:-20]


@given(
    pressure=st.floats(0, 1),
    c=st.floats(1, 3),
    plateau=st.floats(0, 0.9),
    opacity=st.floats(0.1, 1),
    faint=st.floats(0.1, 1),
    solid=st.floats(0.1, 2),
)
def test_the_profile_is_what_the_renderer_averages_over_pixels(
    pressure: float, c: float, plateau: float, opacity: float, faint: float, solid: float
) -> None:
    brush = Brush(
        name="twig",
        source="a test",
        alpha=0.01,
        beta=0.01,
        falloff=c,
        plateau=plateau,
        opacity=opacity,
        faint=faint,
        solid=solid,
    )
    path = torch.tensor([[[-0.1, 0.0205, pressure], [0.1, 0.0205, pressure]]])
    marks = Traj2Stroke.of([brush]).marks(path, 1000.0)
    column = darkness(marks.points, marks.thickness, marks.falloff, marks.plateau, marks.opacity, height=41, width=1)[
        0, :, 0
    ].numpy()
    distances = (np.arange(41 * 500) + 0.5) / 500 / 1000 - 0.0205
    averaged = profile(brush, pressure, distances).reshape(41, 500).mean(axis=1)  # over each pixel
    assert averaged == pytest.approx(column, abs=1e-3)


@pytest.mark.parametrize("px", [240, 480])
@pytest.mark.parametrize("name", ["round", "marker", "fineliner"])
def test_a_brush_has_a_plot_at_any_size(name: str, px: int) -> None:
    plot = pixels(load_brush(name), px)
    assert (plot[round(0.15 * px) : round(0.38 * px), px // 10 : -px // 10].max(axis=2) < 128).any()


def test_a_mark_lies_on_its_sheet_however_far_the_machine_is_off() -> None:
    brush = nominal("round")
    off = brush.model_copy(update={"m_x": 1.3, "m_y": 0.8, "b_x": 0.5, "b_y": -0.5})
    assert np.array_equal(mark(pixels(off)), mark(pixels(brush)))


def test_only_numbers_beyond_the_paper_that_do_anything_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []

    class Listening(Plot):
        def text(self, x: float, y: float, text: str, *options: object, **more: object) -> None:
            told.append(text)

    monkeypatch.setattr(module, "Plot", Listening)
    brush_plot(nominal("round"), "", PX)
    assert not {*FULL} & {*told}
    brush_plot(nominal("round").model_copy(update=FULL), "", PX)
    assert {
        *FULL,
        "0.1, -0.05",
        "2 mm",
        "1, -2 mm",
        "0.6",
        "0.8",
        "0.05",
    } <= {*told}


def test_a_lighter_touch_that_leaves_no_mark_has_a_plot() -> None:
    dry = nominal("round").model_copy(update={"beta": -0.005})
    assert profile(dry, 0.0, np.array([0.0, 1e-3])).tolist() == [1.0, 0.0]
    assert (mark(pixels(dry)).max(axis=2) < 128).any()
