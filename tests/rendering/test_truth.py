"""A mark on pixels is the bare mark averaged over each of them (docs/equations.md, Ink on a grid)."""

import math

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from maulstick.rendering.kernels import cpu
from maulstick.rendering.kernels.render import composite
from tests.support import tolerances
from tests.support.bare import mean_darkness

SIZE = 20
PROFILES = [(0.3, 0.0), (0.65, 0.53), (1.0, 0.0), (1.0, 0.5), (1.5, 0.2), (3.0, 0.0), (1.0, 0.9)]  # falloff, plateau
HALF_WIDTHS = [0.2, 0.35, 0.5, 1.0, 2.5, 5.0]
Array = NDArray[np.float64]


def turned(points: list[list[float]], rng: np.random.Generator) -> Array:
    """Put these points, turned to any direction, at any place within a pixel."""
    angle = rng.uniform(0, 2 * math.pi)
    rotation = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    return np.asarray(points) @ rotation + SIZE / 2 + rng.uniform(0, 1, 2)


def drawn(points: Array, half_width: Array | float, falloff: float, plateau: float) -> Array:
    thickness = np.broadcast_to(half_width, len(points))
    numbers = [torch.tensor([x], dtype=torch.float32) for x in (falloff, plateau, 1.0)]
    stroke = torch.from_numpy(points).float()[None], torch.from_numpy(thickness.copy()).float()[None]
    return cpu.darkness(*stroke, *numbers, height=SIZE, width=SIZE)[0].numpy().astype(float)


def errors(points: list[list[float]], half_width: float) -> tuple[float, float]:
    """The largest error of a pixel, and of the stroke's ink as a share, at some places and directions and profiles."""
    worst, ink = 0.0, 0.0
    for i, (falloff, plateau) in enumerate(PROFILES):
        path = turned(points, np.random.default_rng(i))
        truth = mean_darkness(path, np.full(len(path), half_width), falloff, plateau, SIZE)
        found = drawn(path, half_width, falloff, plateau)
        worst = max(worst, float(np.abs(found - truth).max()))
        ink = max(ink, float(abs(found.sum() / truth.sum() - 1)))
    return worst, ink


@pytest.mark.parametrize("half_width", HALF_WIDTHS)
@pytest.mark.parametrize(
    ("points", "pixel", "ink"),
    [
        pytest.param([[-40.0, 0.0], [40.0, 0.0]], tolerances.ALONG_A_LINE, tolerances.INK_OF_A_LINE, id="line"),
        pytest.param([[0.0, 0.0]], tolerances.AT_A_DOT, tolerances.INK_OF_A_DOT, id="dot"),
        pytest.param([[0.0, 0.0], [40.0, 0.0]], tolerances.AT_AN_END, tolerances.INK_OF_A_LINE, id="end"),
        pytest.param(
            [[-40.0, 0.0], [0.0, 0.0], [28.0, 28.0]], tolerances.AT_A_CORNER, tolerances.INK_OF_A_LINE, id="corner"
        ),
        pytest.param(
            [[-40.0, 0.0], [0.0, 0.0], [-20.0, 35.0]],
            tolerances.AT_A_CORNER,
            tolerances.INK_OF_A_LINE,
            id="sharp corner",
        ),
        pytest.param(
            [[-40.0, 0.0], [0.0, 0.0], [-39.0, 7.0]], tolerances.AT_A_HAIRPIN, tolerances.INK_OF_A_HAIRPIN, id="hairpin"
        ),
    ],
)
def test_a_pixel_is_the_mean_of_the_bare_mark_over_it(
    points: list[list[float]], half_width: float, pixel: float, ink: float
) -> None:
    worst, of_ink = errors(points, half_width)
    assert worst <= pixel
    assert of_ink <= ink or (len(points) == 1 and half_width < 0.5)


def test_many_strokes_are_as_they_are_on_a_grid_four_times_as_fine() -> None:
    rng = np.random.default_rng(0)
    count, px = 60, 64
    headings = rng.uniform(0, 2 * math.pi, (count, 1)) + rng.normal(0, 0.3, (count, 32)).cumsum(axis=1)
    steps = np.stack([np.cos(headings), np.sin(headings)], axis=2) * 0.6
    points = torch.from_numpy(rng.uniform(0, px, (count, 1, 2)) + steps.cumsum(axis=1)).float()
    thickness = torch.from_numpy(rng.uniform(0.3, 3, (count, 1)).repeat(32, axis=1)).float()
    colours = torch.from_numpy(rng.uniform(0, 1, (count, 3))).float()
    numbers = [torch.from_numpy(rng.uniform(*bounds, count)).float() for bounds in ((0.5, 2), (0, 0.7), (0.5, 1))]
    coarse = composite(torch.ones(3, px, px), points, thickness, colours, *numbers)
    fine = composite(torch.ones(3, 4 * px, 4 * px), 4 * points, 4 * thickness, colours, *numbers)
    mean = fine.reshape(3, px, 4, px, 4).mean(dim=(2, 4))
    assert (coarse - mean).abs().mean() <= tolerances.MANY_STROKES
    assert (mean - 1).abs().mean() > 0.1


@pytest.mark.parametrize("name", ["falloff", "plateau", "half-width", "place"])
@pytest.mark.parametrize("half_width", [0.25, 0.7, 2.0])
def test_no_pixel_jumps_while_a_number_moves(name: str, half_width: float) -> None:
    path = turned([[-12.0, 0.0], [0.0, 0.0], [3.0, 4.0], [1.0, 9.0]], np.random.default_rng(4))
    frames, truths = [], []
    for step in np.arange(150):
        numbers = {"falloff": 0.8, "plateau": 0.3, "half-width": half_width, "place": 0.0}
        numbers[name] += step * {"falloff": 1e-3, "plateau": 1e-3, "half-width": 0.01, "place": 0.01}[name]
        moved = path + numbers["place"] * np.array([0.8, 0.6])
        frames.append(drawn(moved, numbers["half-width"], numbers["falloff"], numbers["plateau"]))
        thickness = np.full(len(path), numbers["half-width"])
        truths.append(mean_darkness(moved, thickness, numbers["falloff"], numbers["plateau"], SIZE))
    steps, true_steps = (np.abs(np.diff(x, axis=0)).max(axis=(1, 2)) for x in (np.array(frames), np.array(truths)))
    assert steps.max() <= 1.5 * true_steps.max() + tolerances.JUMP


def test_the_gradient_by_places_leads_where_the_bare_mark_changes() -> None:
    rng = np.random.default_rng(1)
    y, x = np.mgrid[:SIZE, :SIZE]
    weights = np.sin(0.6 * x + 1) + np.cos(0.5 * y + 0.3) + np.sin(0.4 * (x + y))
    for half_width in (1.0, 2.0, 3.0):
        path = turned([[-5.0, 0.0], [0.0, 1.0], [4.0, -1.0], [6.0, 3.0]], rng)
        points = torch.from_numpy(path).float()[None].requires_grad_()
        numbers = [torch.tensor([x]) for x in (1.0, 0.4, 1.0)]
        image = cpu.darkness(points, torch.full((1, 4), half_width), *numbers, height=SIZE, width=SIZE)[0]
        (found,) = torch.autograd.grad((image * torch.from_numpy(weights).float()).sum(), points)
        true = np.zeros((4, 2))
        for place in np.ndindex(4, 2):
            ends = []
            for sign in (-1, 1):
                moved = path.copy()
                moved[place] += sign * 0.05
                ends.append((mean_darkness(moved, np.full(4, half_width), 1.0, 0.4, SIZE) * weights).sum())
            true[place] = (ends[1] - ends[0]) / 0.1
        error = np.linalg.norm(found[0].numpy() - true) / np.linalg.norm(true)
        assert error <= tolerances.GRADIENT_OF_THE_TRUTH
