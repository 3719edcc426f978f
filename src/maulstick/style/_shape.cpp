// Strokes out of their numbers, many at a time: the fast versions of `drawn` in shape.py, `path_length` in traits.py and
// `trait_costs` beside them.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "shape.hpp"
#include "traits.hpp"

namespace nb = nanobind;
using namespace maulstick;

namespace {

template <class T, int Dimensions>
using Array = nb::ndarray<T, nb::ndim<Dimensions>, nb::c_contig, nb::device::cpu>;

// gists: (N, 16).  strays: (N, 2, 32).  x: (8, 32) and y: (7, 32), bases.  paths: (N, 32, 2).
void draw(Array<const float, 2> gists, Array<const float, 3> strays, Array<const float, 2> x, Array<const float, 2> y,
          Array<float, 3> paths) {
  nb::gil_scoped_release release;
  const Bases bases{{x.data(), y.data()}};
  Shape shape;
  for (int64_t i = 0; i < int64_t(gists.shape(0)); ++i) {
    make_shape(gists.data() + i * gist, strays.data() + i * 2 * points, bases, shape);
    float* path = paths.data() + i * 2 * points;
    for (int64_t p = 0; p < points; ++p) path[2 * p] = shape.path(p, 0), path[2 * p + 1] = shape.path(p, 1);
  }
}

// slopes: (N, 32, 2), of the paths.  of_gists: (N, 16).  of_strays: (N, 2, 32), or (0, 2, 32) where nobody asks.
void draw_backward(Array<const float, 2> gists, Array<const float, 3> strays, Array<const float, 2> x,
                   Array<const float, 2> y, Array<const float, 3> slopes, Array<float, 2> of_gists,
                   Array<float, 3> of_strays) {
  nb::gil_scoped_release release;
  const Bases bases{{x.data(), y.data()}};
  std::fill(of_gists.data(), of_gists.data() + of_gists.size(), 0.0f);
  std::fill(of_strays.data(), of_strays.data() + of_strays.size(), 0.0f);
  Shape shape;
  float slope[2][points];
  for (int64_t i = 0; i < int64_t(gists.shape(0)); ++i) {
    make_shape(gists.data() + i * gist, strays.data() + i * 2 * points, bases, shape);
    const float* of_path = slopes.data() + i * 2 * points;
    for (int64_t p = 0; p < points; ++p) slope[0][p] = of_path[2 * p], slope[1][p] = of_path[2 * p + 1];
    add_slopes(shape, bases, slope, of_gists.data() + i * gist,
               of_strays.size() ? of_strays.data() + i * 2 * points : nullptr);
  }
}

// given: (N, 17), gists and roughness.  strays: (N, 2, 32).  x, y: bases.  wanted: (N, 19), ascending in each column,
// that the traits are to have.  widths: (19,), of their distances.  costs: (N,), half the squared distances.
// of_given: (N, 17), their slopes.  of_strays: (N, 2, 32), or (0, 2, 32) where nobody asks.
void trait_costs(Array<const float, 2> given, Array<const float, 3> strays, Array<const float, 2> x,
                 Array<const float, 2> y, Array<const double, 2> wanted, Array<const double, 1> widths,
                 Array<float, 1> costs, Array<float, 2> of_given, Array<float, 3> of_strays) {
  nb::gil_scoped_release release;
  const Bases bases{{x.data(), y.data()}};
  const int64_t count = given.shape(0);
  std::vector<Traits> all(count);
  for (int64_t i = 0; i < count; ++i) all[i].set(given.data() + i * seen, strays.data() + i * 2 * points, bases);
  for (int64_t column = 0; column < traits; ++column) {
    const std::vector<int64_t> order = ascending(all, column);
    for (int64_t rank = 0; rank < count; ++rank) {
      Traits& one = all[order[rank]];
      one.apart[column] = (one.values[column] - wanted(rank, column)) / widths(column);
    }
  }
  std::fill(of_given.data(), of_given.data() + of_given.size(), 0.0f);
  std::fill(of_strays.data(), of_strays.data() + of_strays.size(), 0.0f);
  for (int64_t i = 0; i < count; ++i) {
    double sum = 0, slopes[traits];
    for (int64_t column = 0; column < traits; ++column) {
      sum += all[i].apart[column] * all[i].apart[column];
      slopes[column] = all[i].apart[column] / widths(column);
    }
    costs(i) = static_cast<float>(sum / 2);
    all[i].add_slopes(bases, slopes, of_given.data() + i * seen,
                      of_strays.size() ? of_strays.data() + i * 2 * points : nullptr);
  }
}

// paths: (N, n, 2).  lengths: (N,).
void path_lengths(Array<const float, 3> paths, Array<float, 1> lengths) {
  nb::gil_scoped_release release;
  const int64_t count = paths.shape(1);
  for (int64_t i = 0; i < int64_t(paths.shape(0)); ++i) {
    const float* path = paths.data() + i * count * 2;
    float length = 0;
    for (int64_t p = 1; p < count; ++p) {
      const float x = path[2 * p] - path[2 * p - 2], y = path[2 * p + 1] - path[2 * p - 1];
      length += std::sqrt(x * x + y * y + shortest * shortest);
    }
    lengths.data()[i] = length;
  }
}

}  // namespace

NB_MODULE(_shape, m) {
  m.def("draw", &draw);
  m.def("draw_backward", &draw_backward);
  m.def("path_lengths", &path_lengths);
  m.def("trait_costs", &trait_costs);
}
