// A stroke's shape out of its gist and strays, and the slopes of that: `shape.py` says what the numbers are.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace maulstick {

constexpr int64_t points = 32;               // of a stroke
constexpr int64_t steps = points - 1;
constexpr int64_t gist = 16;
constexpr int64_t splines[] = {8, 7};        // numbers of the gist along x and y
constexpr float least_length = 1e-6f;        // metres, as `_SHORTEST`

// Bases (8, 32) and (7, 32) along x and y: what each number adds to each point, the first of which stays 0.
struct Bases {
  const float* axes[2];
};

struct Shape {
  float spline[2][points];                   // of a length of its own
  float step[2][points], pull[points];       // of the spline, and one over how long each is, 0 where that is nothing
  const float* strays;                       // (2, 32), off the spline, in units of the stroke's length
  float length, size, scale;                 // of the spline, of the stroke, and one over the other
  bool floored;                              // whether the length is the least there may be

  float path(int64_t point, int64_t axis) const {
    return scale * spline[axis][point] + size * strays[axis * points + point];
  }
};

inline float dot(const float* a, const float* b) {
  float lanes[8] = {};
  for (int64_t p = 0; p < points; p += 8)
    for (int64_t lane = 0; lane < 8; ++lane) lanes[lane] += a[p + lane] * b[p + lane];
  return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
}

// gists: (16,).  strays: (2, 32).
inline void make_shape(const float* gists, const float* strays, const Bases& bases, Shape& shape) {
  constexpr float least_square = std::numeric_limits<float>::min();
  const float* number = gists + 1;
  for (int64_t axis = 0; axis < 2; ++axis) {
    float sum[points] = {};
    const float* row = bases.axes[axis];
    for (int64_t k = 0; k < splines[axis]; ++k, ++number, row += points)
      for (int64_t p = 0; p < points; ++p) sum[p] += *number * row[p];
    std::copy(sum, sum + points, shape.spline[axis]);
    for (int64_t j = 0; j < steps; ++j) shape.step[axis][j] = sum[j + 1] - sum[j];
    shape.step[axis][steps] = 0;
  }
  float lengths[points], length = 0;
  for (int64_t j = 0; j < points; ++j) {
    const float square = shape.step[0][j] * shape.step[0][j] + shape.step[1][j] * shape.step[1][j];
    lengths[j] = std::sqrt(std::max(square, least_square));
    shape.pull[j] = (square < least_square ? 0.0f : 1.0f) / lengths[j];
  }
  for (int64_t j = 0; j < steps; ++j) length += lengths[j];
  shape.strays = strays;
  shape.floored = length < least_length;
  shape.length = std::max(length, least_length);
  shape.size = std::exp(gists[0]);
  shape.scale = shape.size / shape.length;
}

// Adds slopes with respect to gist (16,), and to strays (2, 32) unless that is null, of slopes (2, 32) of the path.
inline void add_slopes(const Shape& shape, const Bases& bases, float (&slope)[2][points], float* gists, float* strays) {
  float of_scale = 0, of_size = 0;
  for (int64_t axis = 0; axis < 2; ++axis) {
    of_size += dot(slope[axis], shape.strays + axis * points);
    of_scale += dot(slope[axis], shape.spline[axis]);
    if (strays)
      for (int64_t p = 0; p < points; ++p) strays[axis * points + p] += shape.size * slope[axis][p];
  }
  gists[0] += of_scale * shape.scale + of_size * shape.size;
  const float of_length = shape.floored ? 0.0f : -of_scale * shape.scale / shape.length;
  float* number = gists + 1;
  for (int64_t axis = 0; axis < 2; ++axis) {
    float bent[points], turned[points];
    for (int64_t j = 0; j < points; ++j) turned[j] = of_length * shape.step[axis][j] * shape.pull[j];
    bent[0] = 0;                             // the first point of a spline stays where it is
    for (int64_t p = 1; p < points; ++p) bent[p] = shape.scale * slope[axis][p] + turned[p - 1] - turned[p];
    const float* row = bases.axes[axis];
    for (int64_t k = 0; k < splines[axis]; ++k, row += points) *number++ += dot(row, bent);
  }
}

}  // namespace maulstick
