"""FRIDA's curves are planned by the published way and by ours."""

from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import torch

from maulstick.painting.brush import load_brush
from maulstick.painting.painting import Sheet
from maulstick.planning.from_picture import problem_of
from maulstick.planning.layout import lay_out_for
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem

SETTINGS = PlannerSettings(strokes=6, exact=True, paints=2, steps=3)


@pytest.fixture
def frida(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[2] / "experiments"))
    return import_module("frida")


@pytest.fixture
def problem(frida: ModuleType) -> PlanningProblem:
    brush = load_brush("marker")
    picture = np.random.default_rng(0).random((24, 24, 3)).astype(np.float32)
    layout = lay_out_for(picture, Sheet(width=0.08, height=0.08), brush, "contain", 24)
    return problem_of(layout, (brush,), frida.Bezier(), SETTINGS)


def test_bezier_curves_are_planned_as_any_style(problem: PlanningProblem) -> None:
    assert len(plan(problem, SETTINGS).strokes) == 6


def test_bezier_curves_are_planned_from_a_random_start(frida: ModuleType, problem: PlanningProblem) -> None:
    start = frida.anywhere(problem, 6, torch.Generator().manual_seed(0))
    planned = frida.plan_plainly(
        problem, start, lambda canvas: (canvas - problem.target).square().mean(), steps=3, paints=2
    )
    assert len(planned.strokes) == 6


def test_bezier_curves_take_the_lengths_that_they_are_given(frida: ModuleType) -> None:
    style = frida.Bezier()
    codes, _ = style.sample(5, torch.Generator().manual_seed(0))
    chords = torch.tensor([0.02, 0.025, 0.03, 0.035, 0.04])
    style.resize(codes, chords, chords)
    assert style.decode(codes)[:, -1, 0].numpy() == pytest.approx(chords.numpy(), rel=1e-4)
