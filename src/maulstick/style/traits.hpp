// Traits of a stroke, as `traits` in trait_costs.py says them, and their slopes.
#pragma once

#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "shape.hpp"

namespace maulstick {

constexpr int64_t seen = gist + 1, traits = seen + 2;              // log odds of chord over length and turning are last
constexpr float shortest = 1e-9f, flat = 1e-3f;                    // as in traits.py
constexpr double least_chord = 0.01;         // as in trait_costs.py
constexpr double half_turn = 3.14159265358979323846;

struct Traits {
  double values[traits], apart[traits];      // and how far they are from what is wanted

  // given: (17,), gist and roughness.  strays: (2, 32), off the spline.
  void set(const float* given, const float* strays, const Bases& bases) {
    make_shape(given, strays, bases, shape_);
    std::copy(given, given + seen, values);
    float path[2][points];
    for (int64_t axis = 0; axis < 2; ++axis)
      for (int64_t p = 0; p < points; ++p) path[axis][p] = shape_.path(p, axis);
    for (int64_t j = 0; j < steps; ++j) {
      x_[j] = path[0][j + 1] - path[0][j], y_[j] = path[1][j + 1] - path[1][j];
      norms_[j] = std::sqrt(x_[j] * x_[j] + y_[j] * y_[j] + shortest * shortest);
    }
    mean_ = 0;
    for (int64_t j = 0; j < steps; ++j) mean_ += norms_[j];
    mean_ /= steps;
    for (int64_t j = 0; j < steps; ++j) x_[j] /= mean_, y_[j] /= mean_;
    const float whole = steps * mean_;
    middle_x_ = (path[0][points - 1] - path[0][0]) / whole, middle_y_ = (path[1][points - 1] - path[1][0]) / whole;
    chord_ = std::sqrt(middle_x_ * middle_x_ + middle_y_ * middle_y_ + shortest * shortest);
    values[seen] = std::log((chord_ + least_chord) / (1 - chord_ + least_chord));
    for (int64_t j = 0; j < corners; ++j) {
      across_[j] = x_[j] * y_[j + 1] - y_[j] * x_[j + 1], along_[j] = x_[j] * x_[j + 1] + y_[j] * y_[j + 1];
      upright_[j] = std::sqrt(across_[j] * across_[j] + flat * flat);
    }
    values[seen + 1] = turning();
  }

  // Adds slopes with respect to what is given (17,), and to strays (2, 32) unless that is null, of slopes (19,) of the
  // values.
  void add_slopes(const Bases& bases, const double* slopes, float* given, float* strays) const {
    for (int64_t k = 0; k < seen; ++k) given[k] += static_cast<float>(slopes[k]);
    const float of_chord = static_cast<float>(
        slopes[seen] * (1 / (chord_ + least_chord) + 1 / (1 - chord_ + least_chord)) / chord_ / steps);
    const float of_turning = static_cast<float>(slopes[seen + 1]);
    float x[steps], y[steps], of_across[corners], of_along[corners];
    for (int64_t j = 0; j < steps; ++j) x[j] = of_chord * middle_x_, y[j] = of_chord * middle_y_;
    for (int64_t j = 0; j < corners; ++j) {
      const float of_angle = of_turning / (upright_[j] * upright_[j] + along_[j] * along_[j]);
      of_across[j] = of_angle * along_[j] * across_[j] / upright_[j], of_along[j] = -of_angle * upright_[j];
    }
    for (int64_t j = 0; j < corners; ++j) {
      x[j] += of_across[j] * y_[j + 1] + of_along[j] * x_[j + 1];
      y[j] += of_along[j] * y_[j + 1] - of_across[j] * x_[j + 1];
    }
    for (int64_t j = 0; j < corners; ++j) {
      x[j + 1] += of_along[j] * x_[j] - of_across[j] * y_[j];
      y[j + 1] += of_across[j] * x_[j] + of_along[j] * y_[j];
    }
    float of_mean = 0;
    for (int64_t j = 0; j < steps; ++j) of_mean -= x[j] * x_[j] + y[j] * y_[j];
    float path[2][points] = {};
    for (int64_t j = 0; j < steps; ++j) {
      const float share = of_mean / (steps * norms_[j]);     // of the mean's slope, times a step over its length
      x[j] = x[j] / mean_ + share * x_[j], y[j] = y[j] / mean_ + share * y_[j];
    }
    for (int64_t j = 0; j < steps; ++j) {
      path[0][j] -= x[j], path[1][j] -= y[j];
      path[0][j + 1] += x[j], path[1][j + 1] += y[j];
    }
    maulstick::add_slopes(shape_, bases, path, given, strays);
  }

 private:
  static constexpr int64_t corners = steps - 1;

  // Sum of the angles at corners, each above 0 and below half a turn: that of the product of complex numbers with these
  // angles, and a turn for each time that it has come round. So one arc tangent is enough.
  double turning() const {
    double re = 1, im = 0;
    int64_t turns = 0;
    for (int64_t j = 0; j < corners; ++j) {
      const double before = im;
      im = re * upright_[j] + im * along_[j];
      re = re * along_[j] - before * upright_[j];
      turns += before < 0 && im >= 0;
    }
    const double angle = std::atan2(im, re);
    return 2 * half_turn * (turns + (angle < 0)) + angle;
  }

  Shape shape_;
  float x_[steps], y_[steps];    // steps in units of their mean
  float norms_[steps], mean_, middle_x_, middle_y_, chord_;
  float across_[corners], along_[corners], upright_[corners];
};

// Rows in the order of one trait, in single precision; equal ones stay as they are. Sorted byte by byte.
inline std::vector<int64_t> ascending(const std::vector<Traits>& all, int64_t column) {
  std::vector<std::pair<uint32_t, int64_t>> rows(all.size()), sorted(all.size());
  for (size_t i = 0; i < all.size(); ++i) {
    const float value = static_cast<float>(all[i].values[column]) + 0.0f;            // no zero is below another
    uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    rows[i] = {bits & 0x80000000u ? ~bits : bits | 0x80000000u, int64_t(i)};         // grows as the value does
  }
  for (int shift = 0; shift < 32; shift += 8) {
    std::array<size_t, 257> begins{};
    for (const auto& row : rows) ++begins[(row.first >> shift & 255) + 1];
    for (size_t digit = 0; digit < 256; ++digit) begins[digit + 1] += begins[digit];
    for (const auto& row : rows) sorted[begins[row.first >> shift & 255]++] = row;
    rows.swap(sorted);
  }
  std::vector<int64_t> order(all.size());
  for (size_t i = 0; i < all.size(); ++i) order[i] = rows[i].second;
  return order;
}

}  // namespace maulstick
