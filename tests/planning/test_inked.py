"""What inks are asked to draw of a picture."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor

from maulstick.painting.brush import load_brush
from maulstick.painting.painting import Sheet
from maulstick.planning.from_picture import problem_of
from maulstick.planning.inked import inked, lines_of
from maulstick.planning.layout import Layout, lay_out_for
from maulstick.planning.lines import lines_for, lines_on
from maulstick.planning.losses import LossOptions
from maulstick.planning.objectives import towards_contours
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.tones import Tones
from maulstick.style import load_style

PEN = load_brush("fineliner")
BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
SHORT = Tones(veil=0.3, contrast=1.0, lightest=100.0, darkest=20.0, inks=(BLACK,), lines=0.6)


def layout_of(*, paper: tuple[float, float, float] = WHITE, light: bool = False) -> Layout:
    """A grey disc, darker than around or lighter."""
    y, x = np.mgrid[:80, :80] - 39.5
    disc = np.where(np.hypot(x, y) < 25, 0.3, 0.9)
    picture = np.repeat((1.2 - disc if light else disc)[..., None], 3, axis=2).astype(np.float32)
    return lay_out_for(picture, Sheet(width=0.1, height=0.1, paper=paper), PEN, "contain", 80)


def asked(layout: Layout, tones: Tones | None, *, contours: bool = True) -> tuple[Tensor, Tensor | None, Tensor]:
    """Target, pull, and the target in tones alone."""
    assert layout.target is not None
    picture, paper = (torch.from_numpy(each).permute(2, 0, 1) for each in (layout.target, layout.under))
    target = picture if tones is None else tones.apply(picture, paper)
    lines = lines_of(layout, PEN, (BLACK,) if tones is None else tones.inks) if contours else None
    return *inked(target, picture, paper, layout.sheet.paper, tones, lines), target


def test_lines_are_drawn_over_tones_and_ink_earns_on_them() -> None:
    layout = layout_of()
    target, pull, in_tones = asked(layout, SHORT)
    dark = torch.from_numpy(lines_on(layout, PEN))
    assert torch.allclose(target, in_tones * (1 - 0.6 * dark), atol=1e-6)
    plain = asked(layout, replace(SHORT, lines=0.0))[1]
    assert pull is not None
    assert plain is not None
    line, away = dark > 0.5, dark == 0
    assert (pull - plain)[:, line].min() > 0.2, "ink, which takes light away, earns"
    assert torch.equal(pull[:, away], plain[:, away])


def test_a_white_ink_draws_the_lines_of_what_is_light() -> None:
    night = layout_of(paper=BLACK, light=True)
    target, _, in_tones = asked(night, replace(SHORT, inks=(WHITE,)))
    dark = torch.from_numpy(lines_on(night, PEN, light=True))
    assert dark.max() > 0.5
    assert torch.allclose(target, in_tones + 0.6 * dark * (1 - in_tones), atol=1e-6)


@pytest.mark.parametrize("tones", [None, replace(SHORT, veil=0.0, lines=0.0)], ids=["none", "the picture's own"])
def test_of_enough_ink_contours_alone_are_asked_beside_tones_or_nothing(tones: Tones | None) -> None:
    layout = layout_of()
    target, pull, in_tones = asked(layout, tones)
    assert torch.equal(target, in_tones)
    assert pull is not None
    assert layout.target is not None
    assert torch.equal(pull, towards_contours(torch.from_numpy(layout.target).permute(2, 0, 1)))
    assert asked(layout, tones, contours=False)[1] is None


@pytest.mark.parametrize(
    ("contours", "paints", "given"), [(True, None, True), (False, None, False), (True, 4, False)],
    ids=["both", "tones", "paints"],
)  # fmt: skip
def test_the_planner_is_given_the_lines_that_ink_draws_and_no_others(
    *, contours: bool, paints: int | None, given: bool
) -> None:
    layout, settings = layout_of(), PlannerSettings(strokes=30, paints=paints)
    style = load_style("free", layout.canvas)
    problem = problem_of(layout, (PEN,), style, settings, LossOptions(contours=contours), tones=None)
    assert (problem.lines is not None) is given
    if problem.lines is not None:
        assert np.array_equal(problem.lines(), lines_on(layout, PEN))
        assert problem.lines() is problem.lines(), "looked for once"


def test_a_white_pen_draws_a_line_drawing_in_white() -> None:
    dark, night = layout_of(), layout_of(light=True)
    assert dark.target is not None
    assert night.target is not None
    sheet = Sheet(width=0.1, height=0.1)
    usual, white = (
        lines_for(layout.crop(layout.target), sheet, PEN, "contain", light=light)
        for layout, light in ((dark, False), (night, True))
    )
    assert np.abs(white - (1 - usual)).max() < 0.05
