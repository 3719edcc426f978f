"""Mean darkness over pixels and parts of them, and its slopes, in Triton's language (reference.py, average.hpp)."""

import triton
import triton.language as tl

# As in reference.py: _CLOSE, _SLIMMEST, _WIDE, _ALIGNED; and the share of a step at which Gauss's two places lie.
_CLOSE, _SLIMMEST = tl.constexpr(1.25), tl.constexpr(0.1)
_WIDE, _ALIGNED = tl.constexpr(2.0), tl.constexpr(0.125)
_GAUSS = tl.constexpr(0.5 / 3**0.5)
_LEAST = tl.constexpr(1e-30)  # of a base, outside the mark


@triton.jit
def _mean_across(distance, h, c, q, a, b, SLOPES: tl.constexpr):
    """Return the mean of a straight stroke over pixels, (PIXELS,), so far from its middle and so wide across it.

    Then its slopes by distance, thickness, c, q, and by the logarithm of a and b together; 0 without SLOPES.
    """
    exact = (b > _ALIGNED) & (h - distance < _WIDE)
    step = b * tl.where(exact, 0.5, _GAUSS)
    place = tl.arange(0, 4)[:, None]  # the four corners of the trapezoid, or Gauss's places about its two sides
    side = tl.where(place < 2, 1.0, -1.0)
    corner = tl.where((place == 0) | (place == 3), 1.0, -1.0)
    x = distance[None, :] - side * (a / 2)[None, :] - corner * side * step[None, :]
    c1, c2, steepness = 1 / (c + 1), 1 / (c + 2), 1 / (1 - q)
    inverse = 1 / h
    ramp, edge = (h * (1 - q))[None, :], (h * q)[None, :]
    whole = 2 * (edge + ramp * c1)
    away = tl.abs(x)
    base = tl.maximum(tl.minimum((1 - away * inverse[None, :]) * steepness, 1.0), _LEAST)
    log = tl.log2(base)
    profile = tl.where(base > _LEAST, tl.exp2(c * log), 0.0)
    slope = ramp * c1 * profile * base
    flat, beyond, over = tl.maximum(edge - away, 0.0), tl.maximum(-x, 0.0), x < 0
    curve = ramp * c2 * base * slope
    first = tl.where(over, whole - slope - flat, slope + flat)
    second = curve + flat * (ramp * c1 + flat / 2) + whole * beyond
    full = distance + (a + b) / 2 <= h * q
    per_exact, per_gauss = 1 / tl.where(exact, a * b, 1.0), 0.5 / a
    mean = tl.where(exact, tl.sum(corner * second, axis=0) * per_exact, tl.sum(side * first, axis=0) * per_gauss)
    mean = tl.where(full, 1.0, mean)
    by_distance, by_thickness = tl.zeros_like(mean), tl.zeros_like(mean)
    by_c, by_q, by_width = tl.zeros_like(mean), tl.zeros_like(mean), tl.zeros_like(mean)
    if SLOPES:
        firsts, profiles = tl.sum(corner * first, axis=0), tl.sum(side * profile, axis=0)
        moments, profile_moments = tl.sum(corner * (x * first), axis=0), tl.sum(side * (x * profile), axis=0)
        by_distance = tl.where(exact, -firsts * per_exact, -profiles * per_gauss)
        by_thickness = inverse * tl.where(
            exact, 2 * mean + moments * per_exact, mean + profile_moments * per_gauss
        )  # all lengths grow together
        by_width = tl.where(
            exact,
            -2 * mean - (moments - distance * firsts) * per_exact,
            -mean - (profile_moments - distance * profiles) * per_gauss,
        )
        log = log * 0.6931471805599453
        knee, wide = ramp * c1 * c1, 2 * c * c1 * h[None, :]
        slope_c, slope_q = slope * (log - c1), slope * (c * steepness)
        first_c = tl.where(over, -2 * knee - slope_c, slope_c)
        first_q = tl.where(over, wide - slope_q, slope_q)
        second_c = curve * (log - c1 - c2) - flat * knee - 2 * knee * beyond
        second_q = c * steepness * (curve + flat * (ramp * c1)) + wide * beyond
        by_c = tl.where(
            exact, tl.sum(corner * second_c, axis=0) * per_exact, tl.sum(side * first_c, axis=0) * per_gauss
        )
        by_q = tl.where(
            exact, tl.sum(corner * second_q, axis=0) * per_exact, tl.sum(side * first_q, axis=0) * per_gauss
        )
        by_distance, by_thickness = tl.where(full, 0.0, by_distance), tl.where(full, 0.0, by_thickness)
        by_c, by_q, by_width = tl.where(full, 0.0, by_c), tl.where(full, 0.0, by_q), tl.where(full, 0.0, by_width)
    return mean, by_distance, by_thickness, by_c, by_q, by_width


@triton.jit
def _around_a_point(distance):
    """Return the mean distance from a point to a pixel, how far a pixel spreads, and the bulge and its slope."""
    square = distance * distance
    fall = 1 / (1 + 5.12 * square + 23.6 * square * square)
    bulge = 1 / 12 + 0.06305 * fall
    bends = -0.06305 * (5.12 + 47.2 * square) * fall * fall  # the slope of the bulge by the square
    return tl.sqrt(square + bulge), tl.sqrt(2 - 12 * bulge), bulge, bends


@triton.jit
def mean_darkness(offset_x, offset_y, h, c, q, slant, lost, rounded, SLOPES: tl.constexpr):
    """Return the mean over the part of each pixel that is nearest to what lies there, before the opacity.

    lost: share of the pixel beyond a crease.  slant: cosine between the way across it and to the stroke.
    rounded: share of the part that lies around a point.

    Then the slopes by distance, thickness, c, q and rounded; 0 without SLOPES.
    """
    squared = offset_x * offset_x + offset_y * offset_y
    apart = squared > 0
    distance = tl.sqrt_rn(squared)
    unit = 1 / tl.where(apart, distance, 1.0)
    x_share, y_share = tl.abs(offset_x) * unit, tl.abs(offset_y) * unit
    narrow = tl.sqrt(tl.maximum(1 - slant * slant * lost * (2 - lost), _SLIMMEST * _SLIMMEST))
    a = tl.where(apart, tl.maximum(x_share, y_share), 1.0) * narrow
    b = tl.minimum(x_share, y_share) * narrow
    close = distance < _CLOSE
    around, _, bulge, _ = _around_a_point(distance)
    bend = tl.where(close, 0.0, rounded * bulge / (around + distance))  # so further off the edge of a line is bent
    distance += bend - slant * lost / 2
    mean, by_distance, by_thickness, by_c, by_q, _ = _mean_across(distance, h, c, q, a, b, SLOPES)
    by_rounded = tl.zeros_like(mean)
    rounded = tl.where(close, rounded, 0.0)
    if tl.max(rounded, axis=0) > 0:
        around, spread, _, bends = _around_a_point(distance)
        point, point_distance, point_thickness, point_c, point_q, point_width = _mean_across(
            around, h, c, q, spread * a, spread * b, SLOPES
        )
        takes = rounded > 0
        by_rounded = tl.where(takes, point - mean, 0.0)
        mean += rounded * by_rounded
        if SLOPES:
            moves, widens = distance * (1 + bends) / around, -12 * bends * distance / (spread * spread)
            point_distance = point_distance * moves + point_width * widens
            by_distance += rounded * tl.where(takes, point_distance - by_distance, 0.0)
            by_thickness += rounded * tl.where(takes, point_thickness - by_thickness, 0.0)
            by_c += rounded * tl.where(takes, point_c - by_c, 0.0)
            by_q += rounded * tl.where(takes, point_q - by_q, 0.0)
    return mean, by_distance, by_thickness, by_c, by_q, by_rounded
