"""Measures of how near a painting comes to its picture."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter
from skimage.metrics import structural_similarity

from maulstick.storage.arrays import Image

_WINDOW = 7  # pixels: side of the window of structural similarity, so the least side of a picture


@dataclass(frozen=True)
class Metrics:
    """Measures of how near one image is to another.

    mse: mean squared error of sRGB in [0, 1].  psnr: dB.  ssim: structural similarity; NaN for a picture too small
    for it.  tone_mse_sigma4: mse after a Gaussian blur of 4 pixels, as seen from further away.
    """

    mse: float
    psnr: float
    ssim: float
    tone_mse_sigma4: float


@dataclass(frozen=True)
class PlanMetrics(Metrics):
    """Metrics of a plan, taken at the truth: see `maulstick.rendering.preview.truth`.

    psnr_planned: dB, of the pixels that the plan ends on.
    """

    psnr_planned: float


def compare(painted: Image, picture: Image) -> Metrics:
    """Return the metrics of a painted image against the picture, both (H, W, 3) sRGB in [0, 1]."""
    blurred = gaussian_filter(painted.astype(np.float64) - picture, sigma=(4, 4, 0))
    mse = _mse(painted, picture)
    large = min(picture.shape[:2]) >= _WINDOW
    return Metrics(
        mse=mse,
        psnr=_psnr(mse),
        ssim=float(structural_similarity(picture, painted, channel_axis=2, data_range=1.0)) if large else float("nan"),
        tone_mse_sigma4=float(np.mean(blurred**2)),
    )


def psnr(painted: Image, picture: Image) -> float:
    """Return the PSNR, dB, of two images (H, W, 3), sRGB in [0, 1]."""
    return _psnr(_mse(painted, picture))


def blurred_psnr(painted: Image, picture: Image, sigma: float) -> float:
    """Return the PSNR, dB, of two images (H, W, 3), sRGB in [0, 1], after a Gaussian blur of `sigma` pixels."""
    apart = gaussian_filter(painted.astype(np.float64) - picture, sigma=(sigma, sigma, 0))
    return _psnr(float(np.mean(apart**2)))


def _mse(painted: Image, picture: Image) -> float:
    return float(np.mean((painted.astype(np.float64) - picture) ** 2))


def _psnr(mse: float) -> float:
    return -10 * float(np.log10(mse)) if mse > 0 else float("inf")
