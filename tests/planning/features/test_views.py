import pytest
import torch
from torch import Generator, Tensor

from maulstick.planning.features.views import on_canvas, random_views, squares, through, whole
from tests.support.planning.tiny_network import check_gradient, noise
from tests.support.tolerances import FLOAT32_VALUE

PAPER = torch.tensor([0.9, 0.8, 0.7])

shapes = pytest.mark.parametrize("shape", [(60, 60), (90, 40), (30, 300), (700, 500)])


def seeded(count: int, shape: tuple[int, int], seed: int = 0) -> Tensor:
    return random_views(count, *shape, Generator().manual_seed(seed))


def middles(height: int, width: int) -> Tensor:
    """Return the middles of a canvas's pixels, (H, W, 2), in its own coordinates."""
    return on_canvas(torch.eye(3)[None], height, width)[0]


def seen_in(view: Tensor, places: Tensor) -> Tensor:
    """Return where a view shows places (..., 2) of the canvas."""
    shown = torch.cat([places, torch.ones_like(places[..., :1])], dim=-1) @ torch.linalg.inv(view).T
    return shown[..., :2] / shown[..., 2:]


def test_the_whole_canvas_stands_in_the_middle_of_paper() -> None:
    seen = through(torch.zeros(3, 20, 40), whole(20, 40), 8, PAPER)[0]
    assert torch.allclose(seen[:, [0, 1, 6, 7]], PAPER[:, None, None])
    assert torch.allclose(seen[:, 2:6], torch.tensor(0.0), atol=1e-6)
    tall = through(torch.zeros(3, 40, 20), whole(40, 20), 8, PAPER)[0]
    assert torch.allclose(tall.transpose(1, 2), seen, atol=FLOAT32_VALUE)


def test_the_whole_view_of_a_square_canvas_is_its_average_over_pixels() -> None:
    image = noise(0, 3, 96, 96)
    seen = through(image, whole(96, 96), 48, PAPER)[0]
    assert torch.allclose(seen, image.reshape(3, 48, 2, 48, 2).mean(dim=(2, 4)))


@shapes
def test_paper_seen_from_anywhere_is_paper(shape: tuple[int, int]) -> None:
    image = PAPER[:, None, None].expand(3, *shape)
    seen = through(image, seeded(5, shape), 32, PAPER)
    assert seen.shape == (5, 3, 32, 32)
    assert torch.allclose(seen, PAPER[:, None, None].expand_as(seen), atol=FLOAT32_VALUE)


@shapes
def test_a_view_shows_a_place_where_its_homography_says(shape: tuple[int, int]) -> None:
    y, x = shape[0] // 3, shape[1] // 2
    spot = torch.exp(-((middles(*shape) - middles(*shape)[y, x]) * max(shape) / 40).square().sum(dim=-1))
    for view in seeded(4, shape):
        seen = through(spot.expand(3, *shape), view[None], 64, torch.zeros(3))[0, 0]
        brightest = middles(64, 64).reshape(-1, 2)[seen.argmax()]
        assert torch.allclose(brightest, seen_in(view, middles(*shape)[y, x]), atol=3 / 64)


@shapes
def test_every_pixel_in_view_feels_what_becomes_of_the_view(shape: tuple[int, int]) -> None:
    image = torch.zeros(3, *shape, requires_grad=True)
    in_some = torch.zeros(shape, dtype=torch.bool)
    for view in torch.cat([whole(*shape), seeded(6, shape)]):
        (gradient,) = torch.autograd.grad(through(image, view[None], 32, PAPER).sum(), image)
        in_view = (seen_in(view, middles(*shape)).abs() < 1 - 1 / 32).all(dim=-1)
        assert in_view.float().mean() > 0.6
        assert (gradient[:, in_view] > 0).all()
        in_some |= in_view
    assert in_some.all()


def test_a_checkerboard_seen_from_far_is_grey() -> None:
    board = ((torch.arange(1000)[:, None] + torch.arange(800)) % 2).float().expand(3, -1, -1)
    seen = through(board, seeded(3, (1000, 800)), 32, torch.full((3,), 0.5))
    assert ((seen - 0.5).abs() < 0.02).all()


def test_views_differ_and_are_the_same_for_the_same_seed() -> None:
    views = seeded(6, (40, 60))
    assert torch.equal(views, seeded(6, (40, 60)))
    assert torch.pdist(views.reshape(6, 9)).min() > 0.01
    assert not torch.equal(views, seeded(6, (40, 60), seed=1))


@shapes
def test_random_views_show_most_of_the_canvas_and_no_corner_from_behind(shape: tuple[int, int]) -> None:
    corners = torch.tensor([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    for view in seeded(40, shape):
        shown = seen_in(view, corners)
        assert shown.abs().max() < 2 / 0.7**0.5
        assert (shown * corners > 0).sum() >= 6
        sides = shown.roll(-1, 0) - shown
        turns = sides[:, 0] * sides.roll(-1, 0)[:, 1] - sides[:, 1] * sides.roll(-1, 0)[:, 0]
        assert (turns > 0).all(), "convex, and not mirrored"


@pytest.mark.parametrize(("shape", "count"), [((50, 50), 1), ((50, 51), 2), ((90, 40), 3), ((40, 80), 2)])
def test_squares_show_all_of_a_canvas_and_nothing_beside_it(shape: tuple[int, int], count: int) -> None:
    views = squares(*shape)
    assert len(views) == count
    assert (on_canvas(views, 30, 30).abs() < 1).all()
    shown = torch.stack([(seen_in(view, middles(*shape)).abs() < 1).all(dim=-1) for view in views])
    assert shown.any(dim=0).all()


def test_gradients_through_a_view_are_those_of_finite_differences() -> None:
    views = seeded(2, (40, 30))
    check_gradient(lambda canvas: through(canvas, views, 12, PAPER).square().sum(), noise(0, 3, 40, 30))
