"""How far a stroke model is off once each mark may lie a little elsewhere and be paler or darker.

A tool puts its marks a little beside their commanded place, and not all equally dark, which no model can know. For each
stroke, a translation of the predicted image and a factor for its darkness are found, by one search that sees nothing
of a model but that image.
"""

import torch
from torch import Tensor
from torch.fft import irfft2, rfft2
from torch.nn.functional import grid_sample, max_pool2d
from torch.optim import Adam

FURTHEST = 1.5e-3
"""Metres: no translation is longer."""
PALEST, DARKEST = 0.5, 2.0
"""The bounds of the factor."""
_STARTS, _STEPS = 3, 30
_RATES = 0.3, 0.1  # pixels, and share of the ink
_SEEN = 0.05  # of darkness
_AT_ONCE = 64


@torch.no_grad()
def registered_l1(predicted: Tensor, truth: Tensor, weights: Tensor, pixels_per_metre: float) -> Tensor:
    """Mean over all pixels of weight times error, (N,), of predicted against true darkness, all (N, H, W).

    The best found over translations of at most 1.5 mm (blank paper comes in, sampling is bilinear) and factors from 0.5
    to 2; at most what it is without either.
    """
    batches = zip(*(images.split(_AT_ONCE) for images in (predicted, truth, weights)), strict=True)
    return torch.cat([_registered(*batch, FURTHEST * pixels_per_metre) for batch in batches])


def _registered(predicted: Tensor, truth: Tensor, weights: Tensor, furthest: float) -> Tensor:
    place, factor = _whole_pixels(predicted, truth, weights, furthest)
    place, factor = _refined(predicted, truth, weights, furthest, place, factor)
    found, as_is = _l1(factor[:, None, None] * _moved(predicted, place), truth, weights), _l1(predicted, truth, weights)
    return torch.minimum(found, as_is)


def _l1(predicted: Tensor, truth: Tensor, weights: Tensor) -> Tensor:
    return (weights * (predicted - truth).abs()).mean(dim=(1, 2))


def _whole_pixels(predicted: Tensor, truth: Tensor, weights: Tensor, furthest: float) -> tuple[Tensor, Tensor]:
    """Translations (N, 2) by whole pixels and factors (N,): of those of least squared error, the one of least error."""
    count, height, width = predicted.shape
    reach = int(furthest)
    y, x = torch.meshgrid(*[torch.arange(-reach, reach + 1)] * 2, indexing="ij")
    places = torch.stack([x, y], dim=-1)[x.square() + y.square() <= furthest**2]
    size = (height + reach, width + reach)

    def correlated(image: Tensor, moved: Tensor) -> Tensor:
        """The sums (N, places) of image times the moved one."""
        sums = irfft2(rfft2(image, size) * rfft2(moved, size).conj(), size)
        return sums[:, places[:, 1], places[:, 0]]

    own = correlated(weights, predicted.square()).clamp(min=1e-6)
    common = correlated(weights * truth, predicted)
    factors = (common / own).clamp(PALEST, DARKEST)
    best = (factors * (factors * own - 2 * common)).topk(min(_STARTS, len(places)), dim=1, largest=False).indices
    candidates = [
        (places[index].float(), factors.gather(1, index[:, None])[:, 0])
        for index in (*best.unbind(1), (places == 0).all(1).nonzero()[0].expand(count))
    ]
    errors = [_l1(factor[:, None, None] * _moved(predicted, place), truth, weights) for place, factor in candidates]
    least, rows = torch.stack(errors).argmin(dim=0), torch.arange(count)
    place, factor = (torch.stack(each)[least, rows] for each in zip(*candidates, strict=True))
    return place, factor


def _refined(
    predicted: Tensor, truth: Tensor, weights: Tensor, furthest: float, place: Tensor, factor: Tensor
) -> tuple[Tensor, Tensor]:
    """The best seen along a descent of the error itself, elsewhere than near ink as if translations changed nothing."""
    around = 2 * int(furthest + 1) + 1
    inked = max_pool2d(torch.maximum(predicted, weights * truth)[:, None], around, 1, around // 2).flatten(1) > _SEEN
    pixels = inked.float().topk(int(inked.sum(1).max().clamp(min=1))).indices
    haze = (weights * predicted).flatten(1).masked_fill(inked, 0).sum(dim=1)
    weights = (weights.flatten(1) * inked).gather(1, pixels)
    truth = truth.flatten(1).gather(1, pixels)
    centres = torch.stack([pixels % predicted.shape[2], pixels // predicted.shape[2]], dim=-1) + 0.5
    numbers = [place.clone().requires_grad_(), factor.clone().requires_grad_()]
    optimiser = Adam([{"params": [number]} for number in numbers])
    best, least = [place, factor], torch.full_like(factor, torch.inf)
    for step in range(_STEPS):
        with torch.enable_grad():
            drawn = numbers[1][:, None] * _sampled(predicted[:, None], centres - numbers[0][:, None])[:, 0]
            errors = (weights * (drawn - truth).abs()).sum(dim=1) + numbers[1] * haze
            optimiser.zero_grad()
            errors.sum().backward()
        better = errors < least
        least = torch.where(better, errors, least)
        best = [
            torch.where(better if x.ndim == 1 else better[:, None], x, y) for x, y in zip(numbers, best, strict=True)
        ]
        for group, rate in zip(optimiser.param_groups, _RATES, strict=True):
            group["lr"] = rate * (1 - step / _STEPS)
        optimiser.step()
        numbers[0].mul_((furthest / numbers[0].norm(dim=1, keepdim=True).clamp(min=1e-6)).clamp(max=1))
        numbers[1].clamp_(PALEST, DARKEST)
    place, factor = best
    return place, factor


def _moved(images: Tensor, place: Tensor) -> Tensor:
    """Images (N, H, W), each translated by its (x, y) of place (N, 2), pixels."""
    count, height, width = images.shape
    y, x = torch.meshgrid(torch.arange(height), torch.arange(width), indexing="ij")
    centres = torch.stack([x, y], dim=-1).reshape(1, -1, 2) + 0.5
    return _sampled(images[:, None], centres - place[:, None]).reshape(count, height, width)


def _sampled(images: Tensor, points: Tensor) -> Tensor:
    """(N, C, P) of images (N, C, H, W) at points (N, P, 2), x and y from their upper left corner; 0 beyond them."""
    size = torch.tensor([images.shape[3], images.shape[2]])
    return grid_sample(images, (2 * points / size - 1)[:, None], align_corners=False)[:, :, 0]
