import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.painting.metrics import blurred_psnr, compare, psnr

PICTURE = np.random.default_rng(0).uniform(0.3, 0.7, (24, 31, 3)).astype(np.float32)
FLOAT32 = 1e-5  # relative: squares of differences that are known to 6e-8


def test_a_picture_is_exactly_like_itself() -> None:
    metrics = compare(PICTURE, PICTURE.copy())
    assert (metrics.mse, metrics.psnr, metrics.tone_mse_sigma4) == (0, np.inf, 0)
    assert metrics.ssim == pytest.approx(1, abs=1e-6)


@given(st.floats(0.01, 0.3))
def test_an_even_difference_is_the_same_in_tone_and_gives_its_decibels(d: float) -> None:
    metrics = compare(PICTURE + np.float32(d), PICTURE)
    assert metrics.mse == pytest.approx(d**2, rel=FLOAT32)
    assert metrics.tone_mse_sigma4 == pytest.approx(d**2, rel=FLOAT32)
    assert metrics.psnr == pytest.approx(-20 * np.log10(d), rel=FLOAT32)
    assert metrics.ssim < 1


def test_tone_does_not_see_what_a_blur_of_four_pixels_hides() -> None:
    rows, columns = np.indices((32, 32))
    checks = ((rows + columns) % 2).astype(np.float32)[..., None].repeat(3, axis=2)
    metrics = compare(checks, np.full_like(checks, 0.5))
    assert metrics.mse == pytest.approx(0.25, rel=1e-12)
    assert metrics.psnr == pytest.approx(10 * np.log10(4), rel=FLOAT32)
    assert metrics.tone_mse_sigma4 < 1e-4
    assert metrics.ssim < 0.1


def test_the_wider_a_blur_the_closer_are_checks_to_their_grey_and_without_one_they_are_as_far_as_they_are() -> None:
    rows, columns = np.indices((32, 32))
    checks = ((rows // 2 + columns // 2) % 2).astype(np.float32)[..., None].repeat(3, axis=2)
    grey = np.full_like(checks, 0.5)
    assert blurred_psnr(checks, grey, 0) == pytest.approx(psnr(checks, grey))
    closer = [blurred_psnr(checks, grey, sigma) for sigma in (0.5, 1, 2)]
    assert psnr(checks, grey) < closer[0] < closer[1] < closer[2]
    assert blurred_psnr(PICTURE + 0.1, PICTURE, 3) == pytest.approx(20, rel=FLOAT32)


def test_a_blur_does_not_mix_channels() -> None:
    red, green = (np.zeros((16, 16, 3), dtype=np.float32) for _ in range(2))
    red[..., 0], green[..., 1] = 0.6, 0.6
    assert compare(red, green).tone_mse_sigma4 == pytest.approx(2 / 3 * 0.36, rel=FLOAT32)


def test_the_order_of_the_two_images_changes_no_figure() -> None:
    other = PICTURE[::-1].copy()
    one, two = compare(PICTURE, other), compare(other, PICTURE)
    assert (one.mse, one.tone_mse_sigma4) == (two.mse, two.tone_mse_sigma4)
    assert (one.psnr, one.ssim) == pytest.approx((two.psnr, two.ssim), rel=FLOAT32)


@pytest.mark.parametrize("shape", [(1, 1, 3), (6, 40, 3), (40, 6, 3)])
def test_a_picture_too_small_for_structure_has_no_similarity_but_all_else(shape: tuple[int, int, int]) -> None:
    metrics = compare(np.full(shape, 0.25, dtype=np.float32), np.full(shape, 0.5, dtype=np.float32))
    assert np.isnan(metrics.ssim)
    assert (metrics.mse, metrics.tone_mse_sigma4) == pytest.approx((1 / 16, 1 / 16), rel=1e-12)
    assert metrics.psnr == pytest.approx(10 * np.log10(16), rel=FLOAT32)
    assert not np.isnan(compare(np.zeros((7, 7, 3), np.float32), np.ones((7, 7, 3), np.float32)).ssim)
