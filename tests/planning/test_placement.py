import math
from collections.abc import Callable

import numpy as np
import pytest
import torch
from scipy.ndimage import gaussian_filter
from skimage.feature import structure_tensor, structure_tensor_eigenvalues

from maulstick.painting.brush import Brush
from maulstick.planning.placement import (
    Places,
    blurred_at,
    detail,
    edges,
    find_places,
    sizes_at,
    start_strokes,
    unlike,
)
from maulstick.rendering.traj2stroke import Traj2Stroke, paint
from maulstick.storage.arrays import Floats
from maulstick.storage.arrays import Image as Picture
from maulstick.style import load_style
from maulstick.style.exemplar import Exemplar
from maulstick.style.free import FreeStyle
from maulstick.style.hand import Hand
from tests.planning.conftest import mse, problem_for
from tests.support.nominal import nominal
from tests.support.style.synthetic_hands import all_hands, circle, drawn, exemplar_of, strokes_of
from tests.support.tolerances import FLOAT32_VALUE

STYLE = FreeStyle(shortest=0.001, longest=0.05)
PPM = 1000.0
HEIGHT, WIDTH = 48, 64


def places(target: Floats, density: Floats, count: int, seed: int = 0, room: float = math.inf) -> Places:
    return find_places(target, density, count, np.random.default_rng(seed), room)


def striped(angle: float) -> Floats:
    """Stripes along a direction, (3, H, W)."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    across = -math.sin(angle) * x + math.cos(angle) * y
    return np.broadcast_to(0.5 + 0.5 * np.sin(2 * np.pi * across / 8), (3, HEIGHT, WIDTH))


def turned(angles: Floats, angle: float) -> Floats:
    """Return how far undirected lines are from an angle, radians in [0, pi/2]."""
    return np.abs((angles - angle + np.pi / 2) % np.pi - np.pi / 2)


def even() -> Floats:
    return np.ones((HEIGHT, WIDTH))


@pytest.mark.parametrize("alpha", [0.0, 0.002])
def test_strokes_begin_no_lighter_than_their_brush_was_measured(alpha: float) -> None:
    brush = nominal("round").model_copy(update={"alpha": alpha, "lightest": 0.3})
    narrow = find_places(striped(0.3), even(), 40, np.random.default_rng(0), 1.0)
    begun = start_strokes(narrow, STYLE, brush, PPM, torch.Generator().manual_seed(0))
    assert begun.pressure_knots.min() == pytest.approx(0.3)


def test_places_lie_where_the_density_is() -> None:
    density = np.zeros((HEIGHT, WIDTH))
    density[5:20, 30:60] = 1.0
    found = places(striped(0.3), density, 40)
    assert found.centres.shape == (40, 2)
    x, y = found.centres.T
    assert 30 <= x.min() < 36
    assert 54 < x.max() <= 60
    assert 5 <= y.min() < 8
    assert 17 < y.max() <= 20


def test_three_times_the_density_has_about_three_times_the_places() -> None:
    density = even()
    density[:, WIDTH // 2 :] = 3.0
    right = sum((places(striped(0), density, 80, seed).centres[:, 0] > WIDTH / 2).sum() for seed in range(5)) / 400
    assert 0.65 < right < 0.82


def test_places_are_spread_and_know_their_room() -> None:
    found = places(striped(0), even(), 48)
    distances = np.linalg.norm(found.centres[:, None] - found.centres[None], axis=2) + 1e9 * np.eye(48)
    nearest = np.sort(distances, axis=1)
    apart = math.sqrt(HEIGHT * WIDTH / 48)
    assert nearest[:, 0].min() > 0.5 * apart, "no two places on top of each other"
    assert found.spacing == pytest.approx(nearest[:, :4].mean(axis=1), rel=1e-9)
    assert places(striped(0), even(), 48, room=5.0).spacing.max() <= 5.0


@pytest.mark.parametrize("angle", [0.0, 0.5, math.pi / 4, math.pi / 2, 2.5])
def test_directions_follow_the_stripes_of_a_picture(angle: float) -> None:
    found = places(striped(angle), even(), 40)
    inside = (np.abs(found.centres - (WIDTH / 2, HEIGHT / 2)) < (WIDTH / 2 - 8, HEIGHT / 2 - 8)).all(axis=1)
    assert inside.sum() > 10
    assert turned(found.angles[inside], angle).max() < 0.15


def test_directions_on_an_even_picture_are_any() -> None:
    angles = places(np.full((3, HEIGHT, WIDTH), 0.5), even(), 200).angles % np.pi
    assert np.histogram(angles, bins=4, range=(0, np.pi))[0].min() > 20


def test_colours_are_those_of_the_picture_at_the_places() -> None:
    target = np.zeros((3, HEIGHT, WIDTH))
    target[0, :, WIDTH // 2 :] = 0.8
    target[2, :, : WIDTH // 2] = 0.6
    found = places(target, even(), 40)
    clear = np.abs(found.centres[:, 0] - WIDTH / 2) > 10
    expected = np.where(found.centres[:, :1] > WIDTH / 2, [[0.8, 0, 0]], [[0, 0, 0.6]])
    assert clear.sum() > 20
    assert found.colours[clear] == pytest.approx(expected[clear], abs=0.02)


@pytest.mark.parametrize("count", [1, 2, 3, 60])
def test_any_number_of_places_is_found(count: int) -> None:
    found = places(striped(0), even(), count)
    assert found.centres.shape == (count, 2)
    assert (found.centres >= 0).all()
    assert (found.centres <= (WIDTH, HEIGHT)).all()
    assert (found.spacing > 0).all()
    assert np.isfinite(found.angles).all()


def test_an_empty_density_is_an_even_one() -> None:
    found = places(striped(0), np.zeros((HEIGHT, WIDTH)), 60)
    quarters = (found.centres > (WIDTH / 2, HEIGHT / 2)) @ (1, 2)
    assert np.bincount(quarters, minlength=4).min() >= 9


@pytest.mark.parametrize("shape", [(2, 2), (2, 90), (90, 2)])
def test_small_and_thin_canvases_have_places(shape: tuple[int, int]) -> None:
    target = np.random.default_rng(0).random((3, *shape))
    found = places(target, detail(target), 5)
    assert np.isfinite(np.concatenate([found.centres, found.colours], axis=1)).all()
    assert (found.centres <= shape[::-1]).all()


def test_a_seed_repeats_the_places_to_the_bit() -> None:
    one, two, other = (places(striped(0.3), even(), 30, seed) for seed in (4, 4, 5))
    for name in ("centres", "angles", "spacing", "colours"):
        assert np.array_equal(getattr(one, name), getattr(two, name))
    assert not np.array_equal(one.centres, other.centres)


def test_density_is_highest_where_the_picture_changes_and_nowhere_0_in_a_picture() -> None:
    target = np.zeros((3, HEIGHT, WIDTH))
    target[:, :, WIDTH // 2 :] = 1.0
    density = detail(target)
    assert density.shape == (HEIGHT, WIDTH)
    assert density.min() > 0
    assert density[:, WIDTH // 2 - 1 : WIDTH // 2 + 1].min() > 5 * density[:, 5].max()
    assert not detail(np.full((3, HEIGHT, WIDTH), 0.5)).any()


@pytest.mark.parametrize("density", [detail, unlike])
def test_a_picture_of_more_pixels_has_the_same_density(density: Callable[[Floats], Floats]) -> None:
    picture = gaussian_filter(np.random.default_rng(0).random((3, 260, 190)), (0, 4, 4))
    finer = picture.repeat(3, axis=1).repeat(3, axis=2)
    found = density(finer)
    assert found.shape == (780, 570)
    each = density(picture)
    assert found.reshape(260, 3, 190, 3).mean(axis=(1, 3)) == pytest.approx(each, rel=0.02, abs=0.02 * each.max())


def three(spacing: float) -> Places:
    """Three places with the same room, pixels."""
    return Places(
        np.array([[10.0, 20], [30, 5], [40, 40]]), np.array([0.1, 1.0, 2.0]), np.full(3, spacing), np.eye(3) * 0.5
    )


def crowd(spacing: float) -> Places:
    """Many places with the same room, pixels."""
    return Places(np.tile([[20.0, 20.0]], (200, 1)), np.zeros(200), np.full(200, spacing), np.zeros((200, 3)))


def started(found: Places, brush: Brush, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return lengths in metres and pressure knots of strokes at the places."""
    strokes = start_strokes(found, STYLE, brush, PPM, torch.Generator().manual_seed(seed))
    return STYLE.decode(strokes.codes).diff(dim=1).norm(dim=-1).sum(1).numpy(), strokes.pressure_knots.numpy()


def test_strokes_start_at_their_places_in_metres(round_brush: Brush) -> None:
    found = three(12.0)
    strokes = start_strokes(found, STYLE, round_brush, PPM, torch.Generator().manual_seed(0))
    assert strokes.centres.numpy() == pytest.approx(found.centres / PPM, rel=1e-6)
    assert strokes.angles.numpy() == pytest.approx(found.angles, rel=1e-6)
    assert strokes.colours.numpy() == pytest.approx(found.colours, rel=1e-6)
    middles = strokes.trajectories(STYLE)[..., :2].mean(dim=1)
    assert middles.numpy() == pytest.approx(found.centres / PPM, abs=1e-7)


def test_more_room_makes_longer_and_wider_strokes(round_brush: Brush) -> None:
    lengths, pressure = zip(*(started(crowd(room), round_brush) for room in (2.0, 6.0, 12.0, 18.0)), strict=True)
    assert (np.diff([x.mean() for x in lengths]) > 0).all()
    assert (np.diff([x.mean() for x in pressure]) > 0).all()
    for length, knots in zip(lengths, pressure, strict=True):
        assert np.ptp(length) < 0.1 * length.mean(), "the same room takes the same length"
        assert knots.min() >= 0
        assert knots.max() <= 1


def test_a_hand_starts_with_its_own_lengths_whatever_the_room_and_the_longest_where_there_is_most(
    round_brush: Brush,
) -> None:
    hand, room = exemplar_of(circle), np.linspace(1, 300, 50)
    found = Places(np.zeros((50, 2)), np.zeros(50), room, np.zeros((50, 3)))
    strokes = start_strokes(found, hand, round_brush, PPM, torch.Generator().manual_seed(0))
    gists = strokes.codes[:, 0]
    assert (gists.diff() >= 0).all()
    own = hand.encode(torch.from_numpy(hand.hand.paths))[:, 0]
    assert own.min() - 2 < gists.min() < gists.max() < own.max() + 2


def test_pressure_rises_and_falls_as_the_style_has_it_about_the_width_that_the_room_asks(round_brush: Brush) -> None:
    falling = strokes_of(drawn(circle, 20), np.linspace(0.9, 0.6, 32))
    style = Exemplar.fit("falling", Hand.of(falling), all_hands())
    found = crowd((round_brush.beta + 0.5 * round_brush.alpha) / 0.4 * PPM)
    pressure = start_strokes(found, style, round_brush, PPM, torch.Generator().manual_seed(0)).pressure_knots
    assert pressure.numpy() == pytest.approx(np.tile([0.65, 0.55, 0.45, 0.35], (200, 1)), abs=FLOAT32_VALUE)


def test_a_pen_that_cannot_pressure_starts_without_pressure() -> None:
    _, pressure = started(three(12.0), nominal("fineliner"))
    assert not pressure.any()


def test_a_generator_repeats_the_strokes_to_the_bit(round_brush: Brush) -> None:
    one, two, other = (
        start_strokes(three(12.0), STYLE, round_brush, PPM, torch.Generator().manual_seed(seed)) for seed in (1, 1, 2)
    )
    for name, tensor in one.each().items():
        assert torch.equal(tensor, two.each()[name])
    assert not torch.equal(one.codes, other.codes)


def test_a_start_from_the_picture_is_nearer_to_it_than_one_from_anywhere(portrait: Picture, round_brush: Brush) -> None:
    problem = problem_for(portrait, round_brush)
    style, ppm = load_style("free", problem.canvas), problem.canvas.pixels_per_metre
    image = problem.target.double().numpy()
    errors = []
    for seed in range(3):
        found = places(image, detail(image), 60, seed)
        rng = np.random.default_rng(seed)
        anywhere = Places(
            rng.uniform((0, 0), (60, 48), (60, 2)), rng.uniform(0, 3, 60), found.spacing, rng.permutation(found.colours)
        )
        for each in (found, anywhere):
            strokes = start_strokes(each, style, round_brush, ppm, torch.Generator().manual_seed(seed))
            brushes = Traj2Stroke.of([round_brush] * 60)
            canvas = paint(problem.paper, strokes.trajectories(style), strokes.colours, brushes, ppm)
            errors.append(mse(canvas, problem.target))
    assert np.mean(errors[::2]) < 0.6 * np.mean(errors[1::2])


def test_edges_are_those_of_the_structure_tensor_of_scikit_image(portrait: Picture) -> None:
    target = portrait.transpose(2, 0, 1).astype(np.float64)
    tensors = [structure_tensor(channel, sigma=2.5, order="rc", mode="nearest") for channel in target]
    rr, rc, cc = np.sum(tensors, axis=0)
    eigenvalues = structure_tensor_eigenvalues([rr, rc, cc])
    angles, coherence = edges(target, 2.5)
    assert coherence == pytest.approx((eigenvalues[0] - eigenvalues[1]) / (eigenvalues.sum(axis=0) + 1e-6), abs=1e-9)
    along = np.stack([np.sin(angles), np.cos(angles)])  # row and column: the slope is least along an edge
    least = rr * along[0] ** 2 + 2 * rc * along[0] * along[1] + cc * along[1] ** 2
    assert least == pytest.approx(eigenvalues[1], abs=1e-9)


@pytest.mark.parametrize("sigma", [0, 0.05, 1.3, 9.0])
@pytest.mark.parametrize("shape", [(3, 40, 50), (2, 5, 7), (1, 1, 3)])
def test_blurring_at_some_pixels_is_blurring_all_of_them(sigma: float, shape: tuple[int, int, int]) -> None:
    rng = np.random.default_rng(0)
    images, points = rng.random(shape), rng.uniform((0, 0), shape[:0:-1], (30, 2))
    column, row = points.astype(int).T
    for beyond, mode in (("edge", "nearest"), ("symmetric", "reflect")):
        blurred = np.stack([gaussian_filter(image, sigma, mode=mode) for image in images])
        assert blurred_at(images, points, sigma, beyond) == pytest.approx(blurred[:, row, column], abs=1e-12)


def test_the_wider_what_is_wrong_the_wider_is_the_stroke_that_mends_it() -> None:
    rows, columns = np.mgrid[:128, :128] + 0.5
    discs = [(np.hypot(rows - 64, columns - 64) < radius)[None].astype(np.float64) for radius in (3, 9, 30)]
    sizes = [sizes_at(disc, np.array([[64.0, 64.0]]), largest=10.0).item() for disc in discs]
    assert sizes == [2.0, 3.0, 10.0]


def test_where_nothing_is_wrong_a_stroke_is_as_large_as_it_may_be() -> None:
    assert sizes_at(np.zeros((3, 20, 30)), np.array([[4.0, 5.0]]), largest=7.0) == [7.0]
