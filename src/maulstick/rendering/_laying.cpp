// Trajectories out of paths, and marks out of trajectories: the fast versions of `laid` in laying.py and of
// `Traj2Stroke.marks` for brushes whose tip neither trails nor is broader one way.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace nb = nanobind;

namespace {

template <class T, int Dimensions>
using Array = nb::ndarray<T, nb::ndim<Dimensions>, nb::c_contig, nb::device::cpu>;

// paths: (N, n, 2).  centres: (N, 2), of their middles.  angles: (N,).  pressure: (N, n).  trajectories: (N, n, 3).
void lay(Array<const float, 3> paths, Array<const float, 2> centres, Array<const float, 1> angles,
         Array<const float, 2> pressure, Array<float, 3> trajectories) {
  nb::gil_scoped_release release;
  const int64_t count = paths.shape(0), points = paths.shape(1);
  for (int64_t i = 0; i < count; ++i) {
    const float *path = paths.data() + i * points * 2, *given = pressure.data() + i * points;
    float* laid = trajectories.data() + i * points * 3;
    const float cos = std::cos(angles.data()[i]), sin = std::sin(angles.data()[i]);
    float x = 0, y = 0;                      // sums, and then the move that brings the middle to its centre
    for (int64_t p = 0; p < points; ++p) {
      laid[3 * p] = cos * path[2 * p] - sin * path[2 * p + 1], laid[3 * p + 1] = sin * path[2 * p] + cos * path[2 * p + 1];
      laid[3 * p + 2] = given[p];
      x += laid[3 * p], y += laid[3 * p + 1];
    }
    x = centres.data()[2 * i] - x / points, y = centres.data()[2 * i + 1] - y / points;
    for (int64_t p = 0; p < points; ++p) laid[3 * p] += x, laid[3 * p + 1] += y;
  }
}

// slopes: (N, n, 3), of the trajectories; the others are what follows for what they are named after.
void lay_backward(Array<const float, 3> paths, Array<const float, 1> angles, Array<const float, 3> slopes,
                  Array<float, 3> of_paths, Array<float, 2> of_centres, Array<float, 1> of_angles,
                  Array<float, 2> of_pressure) {
  nb::gil_scoped_release release;
  const int64_t count = paths.shape(0), points = paths.shape(1);
  for (int64_t i = 0; i < count; ++i) {
    const float *path = paths.data() + i * points * 2, *slope = slopes.data() + i * points * 3;
    float *of_path = of_paths.data() + i * points * 2, *of_given = of_pressure.data() + i * points;
    const float cos = std::cos(angles.data()[i]), sin = std::sin(angles.data()[i]);
    float x = 0, y = 0, turn = 0;
    for (int64_t p = 0; p < points; ++p) {
      of_given[p] = slope[3 * p + 2];
      x += slope[3 * p], y += slope[3 * p + 1];
    }
    of_centres.data()[2 * i] = x, of_centres.data()[2 * i + 1] = y;
    x /= points, y /= points;                // what the middle, which stays at its centre, takes back
    for (int64_t p = 0; p < points; ++p) {
      const float along_x = slope[3 * p] - x, along_y = slope[3 * p + 1] - y;
      of_path[2 * p] = cos * along_x + sin * along_y, of_path[2 * p + 1] = cos * along_y - sin * along_x;
      turn += of_path[2 * p + 1] * path[2 * p] - of_path[2 * p] * path[2 * p + 1];
    }
    of_angles.data()[i] = turn;
  }
}

// trajectories: (N, n, 3).  least, most: (N, 2), of x and y.
void extents(Array<const float, 3> trajectories, Array<float, 2> least, Array<float, 2> most) {
  nb::gil_scoped_release release;
  const int64_t count = trajectories.shape(0), points = trajectories.shape(1);
  for (int64_t i = 0; i < count; ++i)
    for (int64_t axis = 0; axis < 2; ++axis) {
      const float* at = trajectories.data() + i * points * 3 + axis;
      float low = at[0], high = at[0];
      for (int64_t p = 1; p < points; ++p) low = std::min(low, at[3 * p]), high = std::max(high, at[3 * p]);
      least.data()[2 * i + axis] = low, most.data()[2 * i + axis] = high;
    }
}

constexpr int64_t pieces = 8;                // of a brush's curve, as `_PIECES` in traj2stroke.py

// One brush, as `Traj2Stroke._numbers` has it in a row.
struct Brush {
  float scale[2], shift[2], curve[pieces + 1], alpha, beta, opacity, faint, solid;
};

const Brush& brush_of(Array<const float, 2> brushes, int64_t i) {
  return *reinterpret_cast<const Brush*>(brushes.data() + i * brushes.shape(1));
}

int64_t piece_of(float pressure) {
  return std::min(std::max(static_cast<int64_t>(pressure * pieces), int64_t(0)), pieces - 1);
}

// trajectories: (N, n, 3).  brushes: (N, 18).  places: (N, n, 2) and thickness: (N, n), pixels.  opacity: (N,).
void mark(Array<const float, 3> trajectories, Array<const float, 2> brushes, float pixels_per_metre,
          Array<float, 3> places, Array<float, 2> thickness, Array<float, 1> opacity) {
  nb::gil_scoped_release release;
  const int64_t count = trajectories.shape(0), points = trajectories.shape(1);
  for (int64_t i = 0; i < count; ++i) {
    const float* at = trajectories.data() + i * points * 3;
    const Brush& brush = brush_of(brushes, i);
    float *place = places.data() + i * points * 2, *width = thickness.data() + i * points, sum = 0;
    for (int64_t p = 0; p < points; ++p) {
      for (int64_t axis = 0; axis < 2; ++axis) {
        const float marked = at[axis] + brush.scale[axis] * (at[3 * p + axis] - at[axis]) + brush.shift[axis];
        place[2 * p + axis] = marked * pixels_per_metre;
      }
      const float pressure = at[3 * p + 2];
      const int64_t piece = piece_of(pressure);
      const float below = brush.curve[piece], rise = brush.curve[piece + 1] - below;
      const float risen = below + rise * (pressure * pieces - piece);
      width[p] = (brush.alpha * risen + brush.beta) * pixels_per_metre;
      sum += pressure;
    }
    const float share = std::min(sum / points / brush.solid, 1.0f);
    opacity.data()[i] = brush.opacity * (brush.faint + (1 - brush.faint) * share);
  }
}

// of_places, of_thickness, of_opacity: slopes of what `mark` returns.  slopes: (N, n, 3), of the trajectories.
void mark_backward(Array<const float, 3> trajectories, Array<const float, 2> brushes, float pixels_per_metre,
                   Array<const float, 3> of_places, Array<const float, 2> of_thickness, Array<const float, 1> of_opacity,
                   Array<float, 3> slopes) {
  nb::gil_scoped_release release;
  const int64_t count = trajectories.shape(0), points = trajectories.shape(1);
  for (int64_t i = 0; i < count; ++i) {
    const float* at = trajectories.data() + i * points * 3;
    const Brush& brush = brush_of(brushes, i);
    const float *of_place = of_places.data() + i * points * 2, *of_width = of_thickness.data() + i * points;
    float *slope = slopes.data() + i * points * 3, start[2] = {}, sum = 0;
    for (int64_t p = 0; p < points; ++p) sum += at[3 * p + 2];
    const bool grows = sum / points / brush.solid <= 1;
    const float of_mean = grows ? of_opacity.data()[i] * brush.opacity * (1 - brush.faint) / brush.solid / points : 0;
    for (int64_t p = 0; p < points; ++p) {
      for (int64_t axis = 0; axis < 2; ++axis) {
        const float moved = of_place[2 * p + axis] * pixels_per_metre;
        slope[3 * p + axis] = moved * brush.scale[axis];
        start[axis] += moved * (1 - brush.scale[axis]);
      }
      const int64_t piece = piece_of(at[3 * p + 2]);
      const float rise = (brush.curve[piece + 1] - brush.curve[piece]) * pieces;
      slope[3 * p + 2] = of_width[p] * pixels_per_metre * brush.alpha * rise + of_mean;
    }
    slope[0] += start[0], slope[1] += start[1];
  }
}

}  // namespace

NB_MODULE(_laying, m) {
  m.def("lay", &lay);
  m.def("lay_backward", &lay_backward);
  m.def("extents", &extents);
  m.def("mark", &mark);
  m.def("mark_backward", &mark_backward);
}
