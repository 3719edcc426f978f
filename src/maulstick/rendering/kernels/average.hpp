// Mean darkness over pixels, of a straight stroke and around points (reference.py, _mean_across), and its slopes.
#pragma once
#include "lanes.hpp"

namespace maulstick {
namespace {

struct Profile {
  float c, q, o;                      // falloff, plateau, opacity
};

struct Mean {
  Floats value;                       // before the opacity
  Floats by_distance, by_thickness, by_c, by_q, by_width;
};

// The width of pixels across a stroke that is so far from their centres: a box of width a blurred by a box of width b.
struct Across { Floats distance, a, b; };

inline Across across_pixels(Floats offset_x, Floats offset_y) {
  const Floats squared = offset_x * offset_x + offset_y * offset_y;
  const Ints apart = squared > all(0.0f);
  const Floats distance = root(squared), share = 1.0f / (apart ? distance : all(1.0f));
  const Floats x_share = absolute(offset_x) * share, y_share = absolute(offset_y) * share;
  return {distance, apart ? larger(x_share, y_share) : all(1.0f), smaller(x_share, y_share)};
}

// by_distance and by_thickness are found if `Slopes` is at least 1, by_c and by_q if it is 2; by_width, the slope by the
// logarithm of a and b, only if `Widths`.
template <int Slopes, bool Widths>
inline Mean mean_across(const Across& across, Floats h, const Profile& p) {
  const Floats distance = across.distance, a = across.a, b = across.b;
  const Ints exact = (b > all(0.125f)) & (h - distance < all(2.0f));
  const Floats step = b * (exact ? all(0.5f) : all(0.28867513f));   // else Gauss's two places
  const float c1 = 1 / (p.c + 1), c2 = 1 / (p.c + 2), steepness = 1 / (1 - p.q);
  const Floats ramp = h * (1 - p.q), edge = h * p.q, inverse = 1.0f / h;
  const Floats whole = 2.0f * (edge + ramp * c1);

  Floats firsts{}, seconds{}, profiles{}, moments{}, profile_moments{};       // sums over the four places
  Floats firsts_c{}, firsts_q{}, seconds_c{}, seconds_q{};
  Floats xs[4], bases[4], logs[4], powers[4];
  for (int k = 0; k < 4; ++k) {
    xs[k] = distance + (k < 2 ? -0.5f : 0.5f) * a + (k % 2 ? step : -step);
    bases[k] = larger(smaller((1.0f - absolute(xs[k]) * inverse) * steepness, all(1.0f)), all(1e-30f));
  }
  for (int k = 0; k < 4; ++k) logs[k] = natural_log(bases[k]);
  for (int k = 0; k < 4; ++k) powers[k] = exponential(logs[k] * p.c);
  for (int k = 0; k < 4; ++k) {
    const float side_sign = k < 2 ? 1 : -1, corner_sign = k == 0 || k == 3 ? 1 : -1;
    const Floats x = xs[k], away = absolute(x), base = bases[k], log_base = logs[k];
    const Floats profile = base > all(1e-30f) ? powers[k] : all(0.0f);
    const Floats slope = ramp * c1 * profile * base;
    const Floats flat = larger(edge - away, all(0.0f)), beyond = larger(-x, all(0.0f));
    const Floats curve = ramp * c2 * base * slope;
    const Ints over = x < all(0.0f);
    const Floats first = over ? whole - slope - flat : slope + flat;
    const Floats second = curve + flat * (ramp * c1 + 0.5f * flat) + whole * beyond;
    firsts += (Slopes ? (exact ? all(corner_sign) : all(side_sign)) : all(side_sign)) * first;
    seconds += corner_sign * second;
    if (Slopes) {
      profiles += side_sign * profile;
      moments += corner_sign * (x * first);
      profile_moments += side_sign * (x * profile);
    }
    if (Slopes > 1) {
      const Floats knee = ramp * (c1 * c1);
      const Floats slope_c = slope * (log_base - c1), slope_q = slope * (p.c * steepness);
      firsts_c += side_sign * (over ? -2.0f * knee - slope_c : slope_c);
      firsts_q += side_sign * (over ? 2.0f * (p.c * c1) * h - slope_q : slope_q);
      seconds_c += corner_sign * (curve * (log_base - c1 - c2) - flat * knee - 2.0f * knee * beyond);
      seconds_q += corner_sign * ((p.c * steepness) * (curve + flat * (ramp * c1)) + 2.0f * (p.c * c1) * h * beyond);
    }
  }
  const Floats per_exact = 1.0f / (exact ? a * b : all(1.0f)), per_gauss = 0.5f / a;
  Mean mean{};
  const Ints full = distance + 0.5f * (a + b) <= edge;
  mean.value = full ? all(1.0f) : exact ? seconds * per_exact : firsts * per_gauss;
  if (Slopes) {
    mean.by_distance = full ? all(0.0f) : exact ? -firsts * per_exact : -profiles * per_gauss;
    mean.by_thickness = full ? all(0.0f)
                             : inverse * (exact ? 2.0f * mean.value + moments * per_exact
                                                : mean.value + profile_moments * per_gauss);
  }
  if (Slopes && Widths)
    mean.by_width = full ? all(0.0f)
                         : exact ? -2.0f * mean.value - (moments - distance * firsts) * per_exact
                                 : -mean.value - (profile_moments - distance * profiles) * per_gauss;
  if (Slopes > 1) {
    mean.by_c = full ? all(0.0f) : exact ? seconds_c * per_exact : firsts_c * per_gauss;
    mean.by_q = full ? all(0.0f) : exact ? seconds_q * per_exact : firsts_q * per_gauss;
  }
  return mean;
}

// How the mean distance of a pixel from a point differs from that of its centre (reference.py, _around_a_point); square: of
// the latter.
inline Floats fall_around(Floats square) { return 1.0f / (1.0f + 5.12f * square + 23.6f * square * square); }
inline Floats bulge_around(Floats fall) { return 1.0f / 12 + 0.06305f * fall; }

// Mean darkness over parts of pixels (reference.py, _mean_darkness). shift, scale: of the part, from its pixel's centre and
// of its width. point: where the part lies around a point and not along a line.
template <int Slopes>
inline Mean mean_of_parts(Across across, Floats h, Floats shift, Floats scale, Ints point, const Profile& p) {
  const Floats distance = across.distance + shift, square = distance * distance;
  const Floats fall = fall_around(square), bulge = bulge_around(fall);
  const Floats around = root(square + bulge), squared_spread = 2.0f - 12.0f * bulge;
  scale = point ? scale * root(squared_spread) : scale;
  Mean mean = mean_across<Slopes, true>({point ? around : distance, across.a * scale, across.b * scale}, h, p);
  if (Slopes) {
    const Floats bends = -0.06305f * (5.12f + 47.2f * square) * fall * fall;   // slope of `bulge` by `square`
    const Floats moves = distance * (1.0f + bends) / around, widens = -12.0f * bends * distance / squared_spread;
    mean.by_distance = point ? mean.by_distance * moves + mean.by_width * widens : mean.by_distance;
  }
  return mean;
}

}  // namespace
}  // namespace maulstick
