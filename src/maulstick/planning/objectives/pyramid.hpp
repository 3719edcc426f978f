// Pyramids of halved images, and the slopes with respect to them.
//
// A level is the one before, every other row and column of it after a binomial filter of five taps whose edge pixels
// repeat (Burt and Adelson's pyramid).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace maulstick {

constexpr int64_t reach = 2;                 // pixels on either side of a tap in the middle
constexpr float taps[] = {1 / 16.0f, 4 / 16.0f, 6 / 16.0f, 4 / 16.0f, 1 / 16.0f};

struct Level {
  int64_t height, width;
  std::vector<float> values;
};

inline int64_t half(int64_t size) { return (size + 1) / 2; }

inline int64_t tapped(int64_t i, int64_t k, int64_t size) { return std::clamp<int64_t>(2 * i + k - reach, 0, size - 1); }

// Pixels that a row of `width` has with those beyond its edges that taps fall on.
inline int64_t widened(int64_t width) { return 2 * half(width) + 2 * reach; }

inline Level halved(const float* image, int64_t height, int64_t width) {
  Level level{half(height), half(width), {}};
  level.values.resize(level.height * level.width);
  std::vector<float> row(widened(width));
  for (int64_t i = 0; i < level.height; ++i) {
    const float* rows[2 * reach + 1];
    for (int64_t k = 0; k <= 2 * reach; ++k) rows[k] = image + tapped(i, k, height) * width;
    const float *a = rows[0], *b = rows[1], *c = rows[2], *d = rows[3], *e = rows[4];
    float* within = row.data() + reach;
    for (int64_t x = 0; x < width; ++x)
      within[x] = taps[0] * a[x] + taps[1] * b[x] + taps[2] * c[x] + taps[3] * d[x] + taps[4] * e[x];
    std::fill(row.begin(), row.begin() + reach, within[0]);
    std::fill(row.begin() + reach + width, row.end(), within[width - 1]);
    const float* at = row.data();
    float* out = level.values.data() + i * level.width;
    for (int64_t x = 0; x < level.width; ++x)
      out[x] = taps[0] * at[2 * x] + taps[1] * at[2 * x + 1] + taps[2] * at[2 * x + 2] + taps[3] * at[2 * x + 3] +
               taps[4] * at[2 * x + 4];
  }
  return level;
}

// Adds the slope with respect to a halved image to that with respect to the image, (height, width).
inline void add_doubled(const Level& halved, int64_t height, int64_t width, float* slope) {
  std::vector<float> padded(halved.width + 2 * reach, 0.0f), row(widened(width));
  for (int64_t i = 0; i < halved.height; ++i) {
    const float* values = halved.values.data() + i * halved.width;
    std::copy(values, values + halved.width, padded.begin() + reach);
    const float* at = padded.data();
    float* within = row.data() + reach;
    for (int64_t x = 0; x < halved.width + reach; ++x) {
      row[2 * x] = taps[0] * at[x + 2] + taps[2] * at[x + 1] + taps[4] * at[x];
      row[2 * x + 1] = taps[1] * at[x + 2] + taps[3] * at[x + 1];
    }
    for (int64_t x = 0; x < reach; ++x) within[0] += row[x];
    for (int64_t x = reach + width; x < int64_t(row.size()); ++x) within[width - 1] += row[x];
    for (int64_t k = 0; k <= 2 * reach; ++k) {
      float* out = slope + tapped(i, k, height) * width;
      for (int64_t x = 0; x < width; ++x) out[x] += taps[k] * within[x];
    }
  }
}

}  // namespace maulstick
