// A stroke's shape out of its gist and residual, and the slopes of that: `shape.py` says what the numbers are.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace maulstick {

constexpr int64_t points = 32;               // of a stroke
constexpr int64_t coordinates = points - 1;  // along either axis: the first point is the origin
constexpr int64_t gist = 16, residual = 47;
constexpr int64_t splines[] = {8, 7};        // numbers of the gist along x and y; the rest of each axis is residual's
constexpr float least_length = 1e-6f;        // metres, as `_SHORTEST`

// Bases (31, 32) along x and y, the spline's first: what each number adds to each point, the first of which stays 0.
struct Bases {
  const float* axes[2];
};

struct Shape {
  float spline[2][points], rest[2][points];  // of a spline of its own length, and of a residual in units of that
  float steps[2][points], pull[points];      // of the spline, and one over how long each is, 0 where that is nothing
  float length, size, scale;                 // of the spline, of the stroke, and one over the other
  bool floored;                              // whether the length is the least there may be

  float path(int64_t point, int64_t axis) const { return scale * spline[axis][point] + size * rest[axis][point]; }
};

inline void combine(const float* numbers, const float* rows, int64_t count, float* along) {
  float sum[points] = {};
  for (int64_t k = 0; k < count; ++k)
    for (int64_t p = 0; p < points; ++p) sum[p] += numbers[k] * rows[k * points + p];
  std::copy(sum, sum + points, along);
}

inline float dot(const float* a, const float* b) {
  float lanes[8] = {};
  for (int64_t p = 0; p < points; p += 8)
    for (int64_t lane = 0; lane < 8; ++lane) lanes[lane] += a[p + lane] * b[p + lane];
  return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
}

// gists: (16,).  rests: (47,).
inline void make_shape(const float* gists, const float* rests, const Bases& bases, Shape& shape) {
  constexpr float least_square = std::numeric_limits<float>::min();
  const float *own = gists + 1, *other = rests;
  for (int64_t axis = 0; axis < 2; ++axis) {
    combine(own, bases.axes[axis], splines[axis], shape.spline[axis]);
    combine(other, bases.axes[axis] + splines[axis] * points, coordinates - splines[axis], shape.rest[axis]);
    own += splines[axis], other += coordinates - splines[axis];
    for (int64_t j = 0; j < coordinates; ++j) shape.steps[axis][j] = shape.spline[axis][j + 1] - shape.spline[axis][j];
    shape.steps[axis][coordinates] = 0;
  }
  float lengths[points], length = 0;
  for (int64_t j = 0; j < points; ++j) {
    const float square = shape.steps[0][j] * shape.steps[0][j] + shape.steps[1][j] * shape.steps[1][j];
    lengths[j] = std::sqrt(std::max(square, least_square));
    shape.pull[j] = (square < least_square ? 0.0f : 1.0f) / lengths[j];
  }
  for (int64_t j = 0; j < coordinates; ++j) length += lengths[j];
  shape.floored = length < least_length;
  shape.length = std::max(length, least_length);
  shape.size = std::exp(gists[0]);
  shape.scale = shape.size / shape.length;
}

// Adds slopes with respect to gist (16,), and to residual (47,) unless that is null, of slopes (2, 32) of the path.
inline void add_slopes(const Shape& shape, const Bases& bases, float (&slope)[2][points], float* gists, float* rests) {
  float of_scale = 0, of_size = 0;
  for (int64_t axis = 0; axis < 2; ++axis) {
    slope[axis][0] = 0;                      // the first point stays where it is
    of_scale += dot(slope[axis], shape.spline[axis]);
    of_size += dot(slope[axis], shape.rest[axis]);
  }
  gists[0] += of_scale * shape.scale + of_size * shape.size;
  const float of_length = shape.floored ? 0.0f : -of_scale * shape.scale / shape.length;
  float *own = gists + 1, *other = rests;
  for (int64_t axis = 0; axis < 2; ++axis) {
    float bent[points], turned[points];
    for (int64_t j = 0; j < points; ++j) turned[j] = of_length * shape.steps[axis][j] * shape.pull[j];
    bent[0] = 0;
    for (int64_t p = 1; p < points; ++p) bent[p] = shape.scale * slope[axis][p] + turned[p - 1] - turned[p];
    const float* row = bases.axes[axis];
    for (int64_t k = 0; k < splines[axis]; ++k, row += points) *own++ += dot(row, bent);
    if (!rests) continue;
    for (int64_t k = splines[axis]; k < coordinates; ++k, row += points) *other++ += shape.size * dot(row, slope[axis]);
  }
}

}  // namespace maulstick
