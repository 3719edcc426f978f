"""Margins: no ink lies there, by marks on pixels that are finer than anything that planned them."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from maulstick.painting.painting import Painting, Sheet
from maulstick.painting.raster import Canvas
from maulstick.planning.from_picture import as_painting, problem_of, provenance_of
from maulstick.planning.initialise import Initialiser
from maulstick.planning.layout import Layout, lay_out_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.windows import Mural
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.result import PlanProgress
from maulstick.planning.room import Room, check_room, kept_in
from maulstick.rendering.preview import truth
from maulstick.storage.arrays import Bools, Floats, Image
from maulstick.strokes.refine import refine
from maulstick.style import load_style
from tests.support.nominal import nominal

SHEET, MARGIN = Sheet(width=0.1, height=0.08), 0.012
INK = PlannerSettings(strokes=20, exact=True, paints=None, steps=12)
NO_NETWORK = LossOptions(weights={"tone": 1.0})
ROUNDING = 1e-5  # darkness that single precision may leave beside a mark, whose average is a difference of integrals
DRAGGED = nominal("marker").model_copy(
    update={"m_x": 1.04, "m_y": 0.97, "b_x": 4e-4, "b_y": -3e-4, "lag": 1e-3, "touch": (5e-4, 2e-4), "nib": (0.3, 0.2)}
)


def black(height: int = 60, width: int = 60) -> Image:
    """A picture that wants ink everywhere."""
    return np.zeros((height, width, 3), np.float32)


def bare(layout: Layout, canvas: Canvas) -> Bools:
    """Which pixels of a canvas lie wholly outside the room of a layout, (H, W)."""
    assert layout.room is not None
    left, top, right, bottom = (edge * canvas.pixels_per_metre for edge in layout.room)
    row, column = np.indices((canvas.height_px, canvas.width_px))
    outside: Bools = (column + 1 <= left) | (column >= right) | (row + 1 <= top) | (row >= bottom)
    return outside


def inked_beyond(painting: Painting, layout: Layout) -> int:
    """Return how many pixels of the margin have ink, at 5 pixels per millimetre, each the mean of 4 by 4."""
    canvas = Canvas(SHEET.width, SHEET.height, 5000)
    inked = (truth(painting, canvas) < 1).any(axis=2)
    assert inked.any()
    return int((inked & bare(layout, canvas)).sum())


@pytest.mark.parametrize("fit", ["contain", "cover"])
@pytest.mark.parametrize(("style", "brush"), [("contour", "fineliner"), ("scribble", "marker"), ("free", "round")])
def test_no_ink_lies_in_a_margin_even_of_strokes_that_are_longer_than_the_picture(
    style: str, brush: str, fit: str
) -> None:
    pen = nominal(brush)
    layout = lay_out_for(black(), SHEET, pen, fit, 40, MARGIN)
    hand, seen = load_style(style, layout.canvas).scaled(2.0), []

    def watch(progress: PlanProgress) -> bool:
        painted = progress.canvas.permute(1, 2, 0).numpy() < layout.under - ROUNDING
        seen.append(int((painted.any(axis=2) & bare(layout, layout.canvas)).sum()))
        return True

    planned = plan(problem_of(layout, (pen,), hand, INK, NO_NETWORK), INK, watch)
    assert set(seen) == {0}, "ink was in the margin while it was planned"
    painting = as_painting(planned, layout, (pen,), hand, provenance_of(INK))
    assert inked_beyond(painting, layout) == 0


def test_without_the_margin_the_same_plan_has_ink_there() -> None:
    pen = nominal("marker")
    layout = lay_out_for(black(), SHEET, pen, "cover", 40)
    hand = load_style("scribble", layout.canvas)
    painting = as_painting(
        plan(problem_of(layout, (pen,), hand, INK, NO_NETWORK), INK), layout, (pen,), hand, provenance_of(INK)
    )
    assert inked_beyond(painting, replace(layout, room=(MARGIN, MARGIN, 0.1 - MARGIN, 0.08 - MARGIN))) > 1000


@pytest.mark.parametrize("fit", ["contain", "cover"])
def test_no_ink_lies_in_the_margin_of_a_mural(fit: str) -> None:
    pen, settings_ = nominal("marker"), replace(INK, paints=2, steps=6, strokes=40)
    mural = Mural(black(), SHEET, Canvas(SHEET.width, SHEET.height, 960), fit, MARGIN)
    layout = mural.overview(96)
    hand = load_style("scribble", layout.canvas)
    planned = plan_mural(mural, (pen,), hand, settings_, loss_options=NO_NETWORK, window_px=48)
    assert inked_beyond(as_painting(planned, layout, (pen,), hand, provenance_of(settings_)), layout) == 0


def test_strokes_of_a_text_begin_in_the_room() -> None:
    pen = nominal("fineliner")
    layout = lay_out_for(None, SHEET, pen, "contain", 40, MARGIN)
    paper, weights = torch.ones(3, 40, 50), torch.ones(40, 50)
    problem = PlanningProblem(
        None, paper, weights, layout.canvas, (pen,), load_style("free", layout.canvas), (), room=layout.room
    )
    strokes, _ = Initialiser(problem, INK, False, np.random.default_rng(0), torch.Generator().manual_seed(0)).first()
    pixel = 1 / layout.canvas.pixels_per_metre
    away = strokes.centres.numpy()
    assert away.min() >= MARGIN - pixel
    assert (away - (SHEET.width, SHEET.height)).max() <= pixel - MARGIN


def extents(paths: Floats, brush: Brush) -> Floats:
    """Return left, top, right and lower end of what the refined strokes leave on paper, (N, 4)."""
    found = []
    for path in refine(list(paths)):
        points, half, _ = brush.bare_mark(path)
        half = half.clip(min=0)[:, None]
        found.append([*(points - half).min(axis=0), *(points + half).max(axis=0)])
    return np.array(found)


@given(st.integers(0, 2**32 - 1), st.sampled_from([nominal("fineliner"), nominal("marker"), DRAGGED]))
@settings(max_examples=40)
def test_any_stroke_of_any_brush_is_kept_in_any_room_that_is_wide_enough(seed: int, brush: Brush) -> None:
    rng = np.random.default_rng(seed)
    x, y, width, height = rng.uniform(0, 0.05), rng.uniform(0, 0.05), *rng.uniform(0.02, 0.1, 2)
    room: Room = (x, y, x + width, y + height)
    steps = rng.normal(0, rng.choice([2e-4, 3e-3, 2e-2]), (6, 12, 2)).cumsum(axis=1)
    paths = np.concatenate([steps + rng.uniform(0, 0.15, (6, 1, 2)), rng.uniform(0, 1, (6, 12, 1))], axis=2)
    ends = extents(kept_in(room, paths, brush), brush)
    assert (ends[:, :2] >= room[:2]).all()
    assert (ends[:, 2:] <= room[2:]).all()


def test_a_stroke_that_fits_is_moved_as_a_whole_and_one_that_is_inside_stays() -> None:
    brush, room = nominal("marker"), (0.02, 0.02, 0.08, 0.06)
    paths = np.zeros((2, 12, 3))
    paths[..., 0] = np.linspace(0, 0.01, 12)
    paths[0, :, :2] += (0.03, 0.03)
    kept = kept_in(room, paths, brush)
    assert kept[0] == pytest.approx(paths[0], abs=1e-6)
    assert np.diff(kept[1], axis=0) == pytest.approx(np.diff(paths[1], axis=0), abs=2e-6)
    assert extents(kept, brush)[1, :2] == pytest.approx(room[:2], abs=1e-5)


def test_a_brush_that_is_wider_than_what_a_margin_leaves_is_refused() -> None:
    brush = nominal("round")
    check_room(None, [brush])
    with pytest.raises(InputError) as caught:
        check_room((0.0, 0.0, 0.1, brush.widest), [brush])
    assert "for the picture, and the brush" in str(caught.value)
    assert "choose a smaller margin, a larger sheet or a thinner brush" in str(caught.value)
