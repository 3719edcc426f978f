import numpy as np
import pytest
import torch

from maulstick.brush_fit.mosaic import Mosaic
from maulstick.brush_fit.window import Window, look
from maulstick.painting.brush import Brush
from maulstick.rendering.kernels.render import composite
from maulstick.rendering.traj2stroke import Traj2Stroke
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import resample
from tests.support.brush_fit.simulated_trials import INK, SCALE, Faults, draw_darkness, draw_trials
from tests.support.tolerances import FLOAT32_VALUE_FAR, MARK_REACH

MARKER = Brush(name="truth", source="a test", alpha=1e-3, beta=0.7e-3, falloff=0.9, opacity=0.9)
BRUSHES = [
    MARKER,
    MARKER.model_copy(update={"plateau": 0.6, "b_x": 3e-4}),
    MARKER.model_copy(update={"nib": (0.3, -0.1), "lag": 1e-3, "touch": (2e-4, 1e-4)}),
    MARKER.model_copy(update={"opacity": 0.4, "faint": 0.5, "m_x": 1.01}),
    MARKER.model_copy(update={"beta": 0.0}),
]
COLOUR = torch.tensor(INK)


@pytest.fixture(scope="module")
def windows() -> list[Window]:
    return [look(trial, SCALE, 4e-3) for trial in draw_trials(MARKER, len(BRUSHES), 0, Faults(specks=2))]


@pytest.fixture(scope="module")
def paths(windows: list[Window]) -> list[Floats]:
    return [resample(window.path, 20) for window in windows]


@pytest.fixture(scope="module")
def mosaic(windows: list[Window], paths: list[Floats]) -> Mosaic:
    return Mosaic.of_windows(windows, paths, SCALE)


def alone(window: Window, path: Floats, brush: Brush) -> torch.Tensor:
    """What a brush leaves on the paper of one window, (C, h, w)."""
    trajectory = torch.tensor((path - (*window.corner, 0))[None], dtype=torch.float32)
    marks = Traj2Stroke.of([brush]).marks(trajectory, SCALE)
    paper = torch.tensor(window.before).permute(2, 0, 1).contiguous()
    return composite(paper, marks.points, marks.thickness, COLOUR[None], marks.falloff, marks.plateau, marks.opacity)


def test_every_stroke_is_stamped_as_on_its_window_alone(
    mosaic: Mosaic, windows: list[Window], paths: list[Floats]
) -> None:
    stamped = mosaic.stamped(Traj2Stroke.of(BRUSHES), COLOUR)
    for i, (window, path, brush) in enumerate(zip(windows, paths, BRUSHES, strict=True)):
        expected = alone(window, path, brush).permute(1, 2, 0).numpy()
        assert np.abs(expected - window.before).max() > 0.2
        assert np.abs(mosaic.window(stamped, i) - expected).max() < FLOAT32_VALUE_FAR


def test_windows_come_back_as_they_were(mosaic: Mosaic, windows: list[Window]) -> None:
    assert len(mosaic) == len(windows)
    for i, window in enumerate(windows):
        assert np.array_equal(mosaic.window(mosaic.before, i), window.before)
        assert np.array_equal(mosaic.window(mosaic.after, i), window.after)
        rows, columns = mosaic.places[i]
        assert torch.equal(mosaic.counts[rows, columns], torch.tensor(window.weights))
        assert torch.all(mosaic.of[rows, columns] == i)
        assert int(mosaic.areas[i]) == window.covered.size


def test_a_covered_pixel_counts_twice_and_one_between_windows_not_at_all(mosaic: Mosaic, windows: list[Window]) -> None:
    nobody = mosaic.of == len(windows)
    assert nobody.any()
    assert torch.all(mosaic.weights[nobody] == 0)
    for i, window in enumerate(windows):
        weights = mosaic.weights[mosaic.places[i]].numpy()
        assert np.array_equal(weights, window.weights * np.where(window.covered, 2, 1))


def test_a_stroke_that_lies_far_beside_its_place_does_not_reach_into_another_window(
    mosaic: Mosaic, windows: list[Window]
) -> None:
    for i in range(len(windows)):
        brushes = list(BRUSHES)
        plain = mosaic.stamped(Traj2Stroke.of(brushes), COLOUR)
        brushes[i] = BRUSHES[i].model_copy(update={"b_x": BRUSHES[i].b_x + MARK_REACH, "b_y": MARK_REACH})
        others = (mosaic.of != i) & (mosaic.of != len(windows))
        changed = (mosaic.stamped(Traj2Stroke.of(brushes), COLOUR) - plain).abs().amax(dim=0)
        assert changed.max() > 0.1
        assert changed[others].max() == 0


def test_a_stroke_that_runs_off_its_photograph_does_not_reach_into_another_window() -> None:
    broad = MARKER.model_copy(update={"beta": 10e-3})
    seen = [look(trial, SCALE, 14e-3) for trial in draw_darkness(broad, 6, 0)]
    assert sum(window.covered[:, [0, -1]].any() or window.covered[[0, -1]].any() for window in seen) > 2
    mosaic = Mosaic.of_windows(seen, [window.path for window in seen], SCALE)
    stamped = mosaic.stamped(Traj2Stroke.of([broad] * 6), torch.ones(1))
    assert float(mosaic.l1(stamped).max()) < FLOAT32_VALUE_FAR


def test_the_error_of_a_window_is_its_mean_difference_from_the_photograph(
    mosaic: Mosaic, windows: list[Window], paths: list[Floats]
) -> None:
    errors = mosaic.l1(mosaic.stamped(Traj2Stroke.of(BRUSHES), COLOUR))
    for i, (window, path, brush) in enumerate(zip(windows, paths, BRUSHES, strict=True)):
        off = np.abs(alone(window, path, brush).permute(1, 2, 0).numpy() - window.after).mean(axis=2)
        assert float(errors[i]) == pytest.approx(float((off * window.weights).mean()), abs=FLOAT32_VALUE_FAR)
    assert float(mosaic.loss(mosaic.after)) == 0


def test_darkness_images_make_a_mosaic_of_one_channel() -> None:
    windows = [look(trial, SCALE, 4e-3) for trial in draw_darkness(MARKER, 3, 0)]
    mosaic = Mosaic.of_windows(windows, [window.path for window in windows], SCALE)
    stamped = mosaic.stamped(Traj2Stroke.of([MARKER] * 3), torch.ones(1))
    assert stamped.shape == mosaic.after.shape == (1, *mosaic.of.shape)
    assert float(mosaic.l1(stamped).max()) < FLOAT32_VALUE_FAR
