"""Fixtures for tests of planning: a picture that is small enough to plan in a test, and its problem and settings."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from PIL import Image
from skimage.data import astronaut
from torch import Tensor

from maulstick.painting.brush import Brush
from maulstick.painting.raster import Canvas
from maulstick.planning.objectives import Halftone, Tone, towards_contours
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem, Weighted
from maulstick.planning.result import PlanProgress
from maulstick.planning.state import State
from maulstick.storage.arrays import Image as Picture
from maulstick.style import load_style
from tests.support.nominal import nominal

QUICK = PlannerSettings(strokes=30, paints=4, steps=80)


def options(**changes: object) -> PlannerSettings:
    return replace(QUICK, **changes)  # type: ignore[arg-type]


def problem_for(picture: Picture, brush: Brush, *, halftone: bool = False) -> PlanningProblem:
    """Return the problem of painting a picture (H, W, 3) on all of a sheet that is 6 cm high."""
    target = torch.from_numpy(np.ascontiguousarray(picture.transpose(2, 0, 1)))
    weights = torch.ones_like(target[0])
    canvas = Canvas(0.06 * picture.shape[1] / picture.shape[0], 0.06, picture.shape[0] / 0.06)
    paper, style = torch.ones_like(target), load_style("free", canvas)
    if not halftone:
        tone = Weighted(Tone(target, weights), 1.0)
        return PlanningProblem(target, paper, weights, canvas, (brush,), style, (tone,))
    pull = towards_contours(target)
    tone = Weighted(Halftone(target, weights, 2.0, pull), 1.0)
    return PlanningProblem(target, paper, weights, canvas, (brush,), style, (tone,), pull=pull)


def state_after(problem: PlanningProblem, settings: PlannerSettings, steps: int) -> State:
    """Return the state of a plan after so many steps, of which it takes more."""
    states: list[State] = []

    def watch(progress: PlanProgress) -> bool:
        if len(states) < steps:
            states.append(progress.state())
        return True

    plan(problem, settings, watch)
    return states[-1]


def mse(canvas: Tensor, target: Tensor) -> float:
    return (canvas - target).square().mean().item()


@pytest.fixture(scope="session")
def portrait() -> Picture:
    """A face on a bright ground, (48, 60, 3), sRGB in [0, 1]."""
    face = Image.fromarray(astronaut()[0:240, 80:380]).resize((60, 48), Image.Resampling.LANCZOS)
    return np.asarray(face, dtype=np.float32) / 255


@pytest.fixture(scope="session")
def round_brush() -> Brush:
    return nominal("round")
