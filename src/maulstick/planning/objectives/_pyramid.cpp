// Squared differences on a pyramid of halved images, and their slope, in one pass down and one up.
//
// A level is the one before, every other row and column of it after a binomial filter of five taps whose edge pixels
// repeat (Burt and Adelson's pyramid).
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace nb = nanobind;

namespace {

template <class T, int Dimensions>
using Array = nb::ndarray<T, nb::ndim<Dimensions>, nb::c_contig, nb::device::cpu>;

constexpr int64_t reach = 2;                 // pixels on either side of a tap in the middle
constexpr float taps[] = {1 / 16.0f, 4 / 16.0f, 6 / 16.0f, 4 / 16.0f, 1 / 16.0f};

struct Level {
  int64_t height, width;
  std::vector<float> values;
};

int64_t half(int64_t size) { return (size + 1) / 2; }

int64_t tapped(int64_t i, int64_t k, int64_t size) { return std::clamp<int64_t>(2 * i + k - reach, 0, size - 1); }

// Each pixel that the taps of a halved row or column fall on: visit(halved, tap, whole).
template <class Visit>
void each_tap(int64_t size, Visit visit) {
  for (int64_t i = 0; i < half(size); ++i)
    for (int64_t k = 0; k <= 2 * reach; ++k) visit(i, k, tapped(i, k, size));
}

Level halved(const float* image, int64_t height, int64_t width) {
  std::vector<float> rows(half(height) * width, 0.0f);
  each_tap(height, [&](int64_t i, int64_t k, int64_t y) {
    for (int64_t x = 0; x < width; ++x) rows[i * width + x] += taps[k] * image[y * width + x];
  });
  Level level{half(height), half(width), {}};
  level.values.resize(level.height * level.width);
  for (int64_t y = 0; y < level.height; ++y) {
    const float* row = rows.data() + y * width;
    for (int64_t i = 0; i < level.width; ++i) {
      float sum = 0;
      for (int64_t k = 0; k <= 2 * reach; ++k) sum += taps[k] * row[tapped(i, k, width)];
      level.values[y * level.width + i] = sum;
    }
  }
  return level;
}

// Adds the slope with respect to a halved image to that with respect to the image, (height, width).
void add_doubled(const Level& halved, int64_t height, int64_t width, float* slope) {
  std::vector<float> rows(halved.height * width, 0.0f);
  for (int64_t y = 0; y < halved.height; ++y) {
    float* row = rows.data() + y * width;
    each_tap(width, [&](int64_t i, int64_t k, int64_t x) { row[x] += taps[k] * halved.values[y * halved.width + i]; });
  }
  each_tap(height, [&](int64_t i, int64_t k, int64_t y) {
    for (int64_t x = 0; x < width; ++x) slope[y * width + x] += taps[k] * rows[i * width + x];
  });
}

// Turns values into the slope of weight * mean of their squares, and returns that mean; `count` values in all.
double squared(float weight, int64_t count, float* values, int64_t size) {
  double sum = 0;
  for (int64_t i = 0; i < size; ++i) sum += static_cast<double>(values[i]) * values[i];
  const float twice = 2 * weight / static_cast<float>(count);
  for (int64_t i = 0; i < size; ++i) values[i] *= twice;
  return sum / static_cast<double>(count);
}

// difference: (C, H, W).  weights: (L,), one per level.  slope: (C, H, W) of the result, the weighted sum of the means.
double mean_squares(Array<const float, 3> difference, Array<const float, 1> weights, Array<float, 3> slope) {
  nb::gil_scoped_release release;
  const int64_t channels = difference.shape(0), height = difference.shape(1), width = difference.shape(2);
  const int64_t count = weights.shape(0);
  double total = 0;
  for (int64_t channel = 0; channel < channels; ++channel) {
    const float* image = difference.data() + channel * height * width;
    float* finest = slope.data() + channel * height * width;
    std::copy(image, image + height * width, finest);
    std::vector<Level> levels;
    for (int64_t l = 1; l < count; ++l)
      levels.push_back(l == 1 ? halved(finest, height, width)
                              : halved(levels.back().values.data(), levels.back().height, levels.back().width));
    const auto add_level = [&](int64_t l, float* values, int64_t rows, int64_t columns) {
      const int64_t size = rows * columns;
      total += weights(l) * squared(weights(l), channels * size, values, size);
    };
    add_level(0, finest, height, width);
    for (int64_t l = 1; l < count; ++l)
      add_level(l, levels[l - 1].values.data(), levels[l - 1].height, levels[l - 1].width);
    for (int64_t l = count - 1; l > 0; --l) {
      const int64_t rows = l == 1 ? height : levels[l - 2].height, columns = l == 1 ? width : levels[l - 2].width;
      add_doubled(levels[l - 1], rows, columns, l == 1 ? finest : levels[l - 2].values.data());
    }
  }
  return total;
}

}  // namespace

NB_MODULE(_pyramid, m) { m.def("mean_squares", &mean_squares); }
