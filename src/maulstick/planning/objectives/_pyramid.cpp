// Squared differences of two images on a pyramid of halved ones, and their slope, in one pass down and one up.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "../../rendering/kernels/share_out.hpp"
#include "pyramid.hpp"

namespace nb = nanobind;

namespace {

using maulstick::Level, maulstick::add_doubled, maulstick::halved;

template <class T, int Dimensions>
using Array = nb::ndarray<T, nb::ndim<Dimensions>, nb::c_contig, nb::device::cpu>;

constexpr int64_t small = 1 << 17;  // pixels of an image, below which threads cost more than they save

// Turns values into the slope of weight * mean of their squares, and returns that mean; `count` values in all.
double squared(float weight, int64_t count, float* values, int64_t size) {
  constexpr int64_t lanes = 8;
  double sums[lanes] = {};
  const int64_t whole = size - size % lanes;
  for (int64_t i = 0; i < whole; i += lanes)
    for (int64_t lane = 0; lane < lanes; ++lane) sums[lane] += static_cast<double>(values[i + lane]) * values[i + lane];
  for (int64_t i = whole; i < size; ++i) sums[0] += static_cast<double>(values[i]) * values[i];
  const float twice = 2 * weight / static_cast<float>(count);
  for (int64_t i = 0; i < size; ++i) values[i] *= twice;
  double sum = 0;
  for (double each : sums) sum += each;
  return sum / static_cast<double>(count);
}

// On up to `threads` threads, a channel at a time, which changes no bit.
// canvas, target: (C, H, W).  scale: (H, W), of their difference.  weights: (L,), one per level.
// pull: (C, H, W), or (0, 0, 0) for none.  slope: (C, H, W), of the result: the weighted sum of the means of squares,
// and the mean of the pulled difference.
double mean_squares(int64_t threads, Array<const float, 3> canvas, Array<const float, 3> target,
                    Array<const float, 2> scale, Array<const float, 1> weights, Array<const float, 3> pull,
                    Array<float, 3> slope) {
  nb::gil_scoped_release release;
  const int64_t channels = canvas.shape(0), height = canvas.shape(1), width = canvas.shape(2), area = height * width;
  const int64_t count = weights.shape(0);
  const float of_one = 1 / static_cast<float>(channels * area);
  std::vector<double> totals(channels);
  const auto channel_of = [&](int64_t channel, int64_t) {
    double& total = totals[channel];
    const float *seen = canvas.data() + channel * area, *wanted = target.data() + channel * area, *by = scale.data();
    float* finest = slope.data() + channel * area;
    for (int64_t i = 0; i < area; ++i) finest[i] = (seen[i] - wanted[i]) * by[i];
    std::vector<Level> levels;
    for (int64_t l = 1; l < count; ++l)
      levels.push_back(l == 1 ? halved(finest, height, width)
                              : halved(levels.back().values.data(), levels.back().height, levels.back().width));
    const auto add_level = [&](int64_t l, float* values, int64_t rows, int64_t columns) {
      const int64_t size = rows * columns;
      if (weights(l) == 0) std::fill(values, values + size, 0.0f);
      else total += weights(l) * squared(weights(l), channels * size, values, size);
    };
    add_level(0, finest, height, width);
    for (int64_t l = 1; l < count; ++l)
      add_level(l, levels[l - 1].values.data(), levels[l - 1].height, levels[l - 1].width);
    for (int64_t l = count - 1; l > 0; --l) {
      const int64_t rows = l == 1 ? height : levels[l - 2].height, columns = l == 1 ? width : levels[l - 2].width;
      add_doubled(levels[l - 1], rows, columns, l == 1 ? finest : levels[l - 2].values.data());
    }
    for (int64_t i = 0; i < area; ++i) finest[i] *= by[i];
    if (!pull.size()) return;
    const float* pulled = pull.data() + channel * area;
    for (int64_t y = 0; y < height; ++y) {
      float sum = 0;                         // of a row: short enough for single precision
      for (int64_t i = y * width; i < (y + 1) * width; ++i) {
        sum += (seen[i] - wanted[i]) * pulled[i];
        finest[i] += pulled[i] * of_one;
      }
      total += static_cast<double>(sum) * of_one;
    }
  };
  maulstick::share_out(channels, area < small ? 1 : threads, channel_of);
  return std::accumulate(totals.begin(), totals.end(), 0.0);
}

}  // namespace

NB_MODULE(_pyramid, m) { m.def("mean_squares", &mean_squares); }
