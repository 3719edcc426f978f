from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import torch

from maulstick.ordering.sequence import sequenced
from maulstick.painting.brush import Brush
from maulstick.painting.painting import Painting, Sheet
from maulstick.painting.raster import Canvas
from maulstick.planning.from_picture import as_painting, problem_of, provenance_of
from maulstick.planning.layout import Layout, lay_out_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.windows import Mural
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.state import State
from maulstick.planning.stroke_effects import TargetView, insertion_costs
from maulstick.rendering.traj2stroke import Marks, Traj2Stroke
from maulstick.storage.arrays import Image
from maulstick.style import load_style
from tests.support.nominal import nominal
from tests.support.tolerances import FILE_METRES

WANTED = PlannerSettings(strokes=40, paints=4, steps=60)
TONES = LossOptions(weights={"tone": 1.0, "likeness": 0.0})
SHEET = Sheet(width=0.12, height=0.1)


@pytest.fixture(scope="module")
def brushes() -> tuple[Brush, ...]:
    return (nominal("round"), nominal("marker"), nominal("fineliner"))


@pytest.fixture(scope="module")
def layout(portrait: Image, brushes: tuple[Brush, ...]) -> Layout:
    return lay_out_for(portrait, SHEET, brushes[0], "cover", 48)


@pytest.fixture(scope="module")
def states() -> list[State]:
    """States after each step of `planned`."""
    return []


@pytest.fixture(scope="module")
def planned(layout: Layout, brushes: tuple[Brush, ...], states: list[State]) -> PlanResult:
    def watch(progress: PlanProgress) -> bool:
        states.append(progress.state())
        return True

    style = load_style("free", layout.canvas)
    return plan(problem_of(layout, brushes, style, WANTED, TONES), WANTED, watch)


@pytest.fixture(scope="module")
def painting(planned: PlanResult, layout: Layout, brushes: tuple[Brush, ...]) -> Painting:
    return as_painting(planned, layout, brushes, load_style("free", layout.canvas), provenance_of(WANTED))


def brushes_of(painting: Painting) -> list[str]:
    return [painting.paints[stroke.paint].brush for stroke in painting.strokes]


def test_broad_brushes_paint_first_and_each_is_taken_up_once(painting: Painting, brushes: tuple[Brush, ...]) -> None:
    names = [brush.name for brush in brushes]
    order = [names.index(name) for name in brushes_of(painting)]
    assert order == sorted(order)
    assert len(set(order)) > 1


def test_all_brushes_share_the_colours_that_are_mixed(painting: Painting) -> None:
    assert len({paint.colour for paint in painting.paints}) <= 4
    assert len(set(painting.paints)) == len(painting.paints)
    assert {paint.brush for paint in painting.paints} == set(painting.brushes)


def test_a_machine_changes_brushes_no_more_often_than_there_are(painting: Painting) -> None:
    assert sequenced(painting, (0.0, 0.0)).brush_changes() == len(painting.brushes) - 1


def test_strokes_of_different_brushes_begin_all_over_the_picture(states: list[State], planned: PlanResult) -> None:
    first = states[0]
    counts = np.bincount(first["brush_of"])
    assert len(counts) == 3
    assert counts.sum() == 40
    assert counts[0] >= counts[1] > counts[2] > 0, "a pen that cannot fill its room gets fewer strokes"
    for number in range(2):
        reach = np.ptp(first["centres"][first["brush_of"] == number], axis=0)
        assert (reach > (0.06, 0.05)).all()


def test_a_stroke_that_is_moved_may_change_its_brush(states: list[State], planned: PlanResult) -> None:
    assert any((one["brush_of"] != other["brush_of"]).any() for one, other in pairwise(states))


def test_a_plan_of_several_brushes_goes_on_from_any_step(
    states: list[State], planned: PlanResult, layout: Layout, brushes: tuple[Brush, ...]
) -> None:
    problem = problem_of(layout, brushes, load_style("free", layout.canvas), WANTED, TONES)
    for step in (2, len(states) // 2):
        again = plan(problem, WANTED, resume=states[step])
        assert torch.equal(again.paint_of, planned.paint_of)
        for name, tensor in again.strokes.each().items():
            assert torch.equal(tensor, planned.strokes.each()[name]), name


def test_several_brushes_keep_to_the_margin(portrait: Image, brushes: tuple[Brush, ...]) -> None:
    margin = 0.01
    layout = lay_out_for(portrait, SHEET, brushes[0], "cover", 40, margin)
    style, wanted = load_style("free", layout.canvas), replace(WANTED, steps=15)
    found = as_painting(
        plan(problem_of(layout, brushes, style, wanted, TONES), wanted), layout, brushes, style, provenance_of(wanted)
    )
    for stroke, name in zip(found.strokes, brushes_of(found), strict=True):
        points, half_widths, _ = found.brushes[name].bare_mark(np.array(stroke.trajectory))
        half = half_widths.clip(min=0)[:, None]
        assert (points - half).min() >= margin - FILE_METRES
        assert ((SHEET.width, SHEET.height) - (points + half)).min() >= margin - FILE_METRES


def test_a_mural_is_painted_brush_by_brush_too(portrait: Image, brushes: tuple[Brush, ...]) -> None:
    mural = Mural(portrait, SHEET, Canvas(SHEET.width, SHEET.height, 800), "cover")
    style, wanted = load_style("free", mural.canvas), replace(WANTED, steps=12)
    found = plan_mural(mural, brushes, style, wanted, loss_options=TONES, window_px=48)
    order = found.strokes.brush_of.tolist()
    assert order == sorted(order)
    assert len(set(order)) > 1


def test_the_cost_of_a_stroke_that_is_not_there_yet_is_what_it_would_change() -> None:
    torch_rng = torch.Generator().manual_seed(3)
    path = torch.rand(6, 1, 2, generator=torch_rng) * 40 + torch.randn(6, 16, 2, generator=torch_rng).cumsum(1) * 2
    even = torch.ones(6)
    marks = Marks(path, torch.full((6, 16), 3.0), even, 0.5 * even, 0.9 * even)
    paper, target = torch.ones(3, 56, 56), torch.rand(3, 1, 1, generator=torch_rng).expand(3, 56, 56)
    colours = torch.cat([target[:, :1, 0].T.expand(3, 3), torch.ones(3, 3)])  # three suit the target, three do not
    view, new = TargetView(target, torch.ones(56, 56)), torch.tensor([True, False] * 3)

    costs = insertion_costs(view, paper, marks, colours, new, torch.Generator().manual_seed(0))
    assert costs[0] < 0
    assert costs[2] < 0
    assert costs[4] == pytest.approx(0, abs=1e-3), "white on white paper changes nothing"


def test_a_brush_for_each_row_is_the_brush_of_that_stroke() -> None:
    brushes = [nominal("round"), nominal("fineliner")]
    rows = torch.tensor([1, 0, 1])
    one, other = Traj2Stroke.of(brushes)[rows], Traj2Stroke.of([brushes[row] for row in rows.tolist()])
    assert all(torch.equal(tensor, vars(other)[name]) for name, tensor in vars(one).items())
