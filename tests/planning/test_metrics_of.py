"""Metrics of a plan are taken at the truth: beside marks drawn by their formula, at points, on far finer pixels."""

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
import torch

from maulstick.painting.brush import Brush
from maulstick.painting.metrics import PlanMetrics, compare
from maulstick.painting.painting import Painting, Sheet
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.planning.from_picture import as_painting, metrics_of, problem_of, provenance_of, with_metrics
from maulstick.planning.layout import Layout, lay_out_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlanningProblem
from maulstick.rendering import preview as rendering
from maulstick.rendering.traj2stroke import Traj2Stroke
from maulstick.storage.arrays import Image as Picture
from maulstick.style import load_style
from tests.planning.conftest import options
from tests.support.bare import darkness_at
from tests.support.nominal import nominal
from tests.support.tolerances import FINER_BANDS, PLANNED_DECIBELS, TRUE_DECIBELS, TRUE_SSIM

FINE = 16
WANTED = options(strokes=40, steps=60)


@pytest.fixture(scope="module", params=["round", "fineliner"])
def brush(request: pytest.FixtureRequest) -> Brush:
    """A brush with soft edges; and a pen whose marks are narrower than a pixel."""
    return nominal(request.param)


@pytest.fixture(scope="module")
def layout(portrait: Picture, brush: Brush) -> Layout:
    """The portrait on a square sheet, a small one for the pen, so that there is bare paper above and below."""
    side = 0.103 if brush.name == "round" else 0.04
    return lay_out_for(portrait, Sheet(width=side, height=side, paper=(1.0, 0.98, 0.9)), brush, height_px=48)


@pytest.fixture(scope="module")
def problem(layout: Layout, brush: Brush) -> PlanningProblem:
    style = load_style("free", layout.canvas)
    return problem_of(layout, (brush,), style, WANTED, LossOptions(weights={"likeness": 0.0}))


@pytest.fixture(scope="module")
def painting(problem: PlanningProblem, layout: Layout, brush: Brush) -> Painting:
    return as_painting(plan(problem, WANTED), layout, (brush,), problem.style, provenance_of(WANTED))


@pytest.fixture(scope="module")
def metrics(painting: Painting, layout: Layout) -> PlanMetrics:
    found = metrics_of(painting, layout)
    assert found is not None
    return found


def directly(painting: Painting, layout: Layout) -> Picture:
    """Return the painting out of the formula alone, at the centres of 16 times finer pixels, averaged."""
    canvas = layout.canvas
    fine = painting.sheet.image(canvas).repeat(FINE, axis=0).repeat(FINE, axis=1).astype(np.float64)
    brushes = Traj2Stroke.of([painting.brushes[painting.paints[stroke.paint].brush] for stroke in painting.strokes])
    marks = brushes.marks(torch.tensor(painting.trajectories(), dtype=torch.float32), FINE * canvas.pixels_per_metre)
    numbers = (marks.points, marks.thickness, marks.falloff, marks.plateau, marks.opacity)
    for stroke, points, thickness, falloff, plateau, opacity in zip(
        painting.strokes, *(each.double().numpy() for each in numbers), strict=True
    ):
        reach = thickness.max()
        low = np.floor(points.min(axis=0) - reach).astype(int).clip(0)
        high = np.ceil(points.max(axis=0) + reach).astype(int).clip(0)
        part = fine[low[1] : high[1], low[0] : high[0]]
        x, y = np.meshgrid(np.arange(low[0], low[0] + part.shape[1]), np.arange(low[1], low[1] + part.shape[0]))
        places = np.stack([x.ravel(), y.ravel()], axis=1) + 0.5
        dark = opacity * darkness_at(places, points, thickness, falloff, plateau).reshape(*part.shape[:2], 1)
        part[:] = part * (1 - dark) + np.array(painting.paints[stroke.paint].colour) * dark
    height, width = canvas.height_px, canvas.width_px
    return np.asarray(fine.reshape(height, FINE, width, FINE, 3).mean(axis=(1, 3)), dtype=np.float32)


def test_metrics_are_those_of_the_marks_themselves(painting: Painting, layout: Layout, metrics: PlanMetrics) -> None:
    assert layout.target is not None
    direct = compare(layout.crop(directly(painting, layout)), layout.crop(layout.target))
    assert metrics.psnr == pytest.approx(direct.psnr, abs=TRUE_DECIBELS)
    assert metrics.ssim == pytest.approx(direct.ssim, abs=TRUE_SSIM)
    assert abs(metrics.psnr - direct.psnr) < abs(metrics.psnr_planned - direct.psnr)


def test_what_was_planned_agrees_with_the_truth(metrics: PlanMetrics) -> None:
    assert metrics.psnr_planned == pytest.approx(metrics.psnr, abs=PLANNED_DECIBELS)


def test_bands_of_a_large_painting_join_to_what_one_band_shows(
    painting: Painting, layout: Layout, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = rendering.truth(painting, layout.canvas)
    assert whole.shape == layout.under.shape
    monkeypatch.setattr(rendering, "_BAND_PX", 7 * 16 * layout.canvas.width_px)
    assert np.abs(rendering.truth(painting, layout.canvas) - whole).max() < FINER_BANDS
    monkeypatch.setattr(rendering, "_BAND_PX", 1)
    assert np.abs(rendering.truth(painting, layout.canvas) - whole).max() < FINER_BANDS


def test_both_figures_are_in_the_file_and_one_without_the_second_reads(
    painting: Painting, layout: Layout, problem: PlanningProblem, metrics: PlanMetrics, tmp_path: Path
) -> None:
    file = tmp_path / "painting.json"
    write_painting(with_metrics(painting, layout, problem), file)
    told = dict(read_painting(file).provenance.metrics)
    assert {name: told[name] for name in asdict(metrics)} == asdict(metrics)
    del told["psnr_planned"]
    older = painting.model_copy(update={"provenance": painting.provenance.model_copy(update={"metrics": told})})
    write_painting(older, file)
    assert read_painting(file).provenance.metrics == told
