"""Views of a canvas: perspectives and crops that a network sees, so that no painting is fitted to one view alone.

A view is a homography (3, 3) that maps places in the view's square to places on the canvas. Both are (x, y, 1), with
x and y from -1 at one edge to 1 at the other, whatever the pixels.
"""

import math

import torch
from torch import Generator, Tensor
from torch.nn.functional import avg_pool2d, grid_sample, interpolate

_DISTORTION = 0.5  # the most a corner moves inwards, as a share of the way to the middle, as in CLIPasso
_LEAST_AREA = 0.7  # smallest crop, as a share of the area: a view still shows most of the painting
_SAMPLES = 2  # samples of a pixel along each side: views shrink the canvas by up to about so much


def whole(height: int, width: int) -> Tensor:
    """Return the one view (1, 3, 3) that just shows all of a canvas of so many pixels, in the middle of the square."""
    longest = max(height, width)
    return torch.diag(torch.tensor([longest / width, longest / height, 1.0]))[None]


def squares(height: int, width: int) -> Tensor:
    """Return the fewest views (V, 3, 3) that show all of a canvas of so many pixels and nothing beside it."""
    shortest = min(height, width)
    count = math.ceil(max(height, width) / shortest)
    shares = torch.tensor([shortest / width, shortest / height])
    middles = torch.linspace(-1, 1, count)[:, None] * (1 - shares) if count > 1 else torch.zeros(1, 2)
    return _scaled(shares.expand(count, 2), middles)


def random_views(count: int, height: int, width: int, torch_rng: Generator) -> Tensor:
    """Return random perspectives (V, 3, 3) of all of a canvas of so many pixels, cropped at random.

    Source: Vinker et al., CLIPasso, its augmentations: a perspective whose corners move up to half way to the middle,
    then a square, here of 0.7 to 1 of the area.
    """
    corners = torch.tensor([[-1.0, -1], [1, -1], [1, 1], [-1, 1]], dtype=torch.float64)
    moved = corners * (1 - _DISTORTION * torch.rand(count, 4, 2, generator=torch_rng, dtype=torch.float64))
    area = _LEAST_AREA + (1 - _LEAST_AREA) * torch.rand(count, generator=torch_rng, dtype=torch.float64)
    shares = area.sqrt()[:, None].expand(count, 2)
    middles = (1 - shares) * (2 * torch.rand(count, 2, generator=torch_rng, dtype=torch.float64) - 1)
    return (whole(height, width).double() @ _homographies(moved, corners) @ _scaled(shares, middles)).float()


def through(image: Tensor, views: Tensor, side: int, paper: Tensor) -> Tensor:
    """Return an image (C, H, W) of the canvas as seen through views (V, 3, 3): (V, C, side, side).

    Beside the canvas lies paper (C,). Differentiable with respect to the image.
    """
    samples = _SAMPLES * side
    beyond_paper = (image - paper.to(image)[:, None, None])[None]
    shrink = samples / max(image.shape[1:])
    if shrink < 1:
        size = [max(1, round(shrink * pixels)) for pixels in image.shape[1:]]
        beyond_paper = interpolate(beyond_paper, size=size, mode="bilinear", antialias=True)
    places = on_canvas(views.to(image), samples, samples)
    # All places beside the canvas are paper alike; clamped, since coordinates near the horizon would overflow.
    seen = grid_sample(
        beyond_paper.expand(len(views), -1, -1, -1), places.clamp(-9, 9), padding_mode="zeros", align_corners=False
    )
    return avg_pool2d(seen, _SAMPLES) + paper.to(image)[:, None, None]


def on_canvas(views: Tensor, rows: int, columns: int) -> Tensor:
    """Return where on the canvas the middles of a view's cells lie, (V, rows, columns, 2), for views (V, 3, 3)."""
    y, x = ((2 * torch.arange(n, dtype=views.dtype, device=views.device) + 1) / n - 1 for n in (rows, columns))
    square = torch.stack([*torch.meshgrid(x, y, indexing="xy"), torch.ones_like(x).expand(rows, columns)], dim=-1)
    places = torch.einsum("vij,rcj->vrci", views, square)
    return places[..., :2] / places[..., 2:]


def _scaled(shares: Tensor, middles: Tensor) -> Tensor:
    """Return views (V, 3, 3) of one rectangle each: its sides (V, 2), as shares of all, and its middle (V, 2)."""
    views = torch.diag_embed(torch.cat([shares, torch.ones_like(shares[:, :1])], dim=1))
    views[:, :2, 2] = middles
    return views


def _homographies(sources: Tensor, targets: Tensor) -> Tensor:
    """Return the homographies (V, 3, 3) that map four points (V, 4, 2) to four points (4, 2)."""
    ones = torch.ones_like(sources[..., :1])
    points = torch.cat([sources, ones], dim=-1)
    targets = targets.expand_as(sources)
    x, y = targets[..., :1], targets[..., 1:]
    rows = torch.cat(
        [
            torch.cat([points, torch.zeros_like(points), -x * sources], dim=-1),
            torch.cat([torch.zeros_like(points), points, -y * sources], dim=-1),
        ],
        dim=1,
    )
    numbers = torch.linalg.solve(rows, torch.cat([x, y], dim=1)[..., 0])
    return torch.cat([numbers, torch.ones_like(numbers[:, :1])], dim=1).reshape(-1, 3, 3)
