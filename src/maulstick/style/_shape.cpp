// Strokes out of their numbers, many at a time: the fast versions of `drawn` in shape.py and `trait_costs` beside it.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "shape.hpp"
#include "traits.hpp"

namespace nb = nanobind;
using namespace maulstick;

namespace {

template <class T, int Dimensions>
using Array = nb::ndarray<T, nb::ndim<Dimensions>, nb::c_contig, nb::device::cpu>;

// gists: (N, 16).  rests: (N, 47).  x, y: (31, 32), bases.  paths: (N, 32, 2).
void decode(Array<const float, 2> gists, Array<const float, 2> rests, Array<const float, 2> x, Array<const float, 2> y,
            Array<float, 3> paths) {
  nb::gil_scoped_release release;
  const Bases bases{{x.data(), y.data()}};
  Shape shape;
  for (int64_t i = 0; i < int64_t(gists.shape(0)); ++i) {
    make_shape(gists.data() + i * gist, rests.data() + i * residual, bases, shape);
    float* path = paths.data() + i * 2 * points;
    for (int64_t p = 0; p < points; ++p) path[2 * p] = shape.path(p, 0), path[2 * p + 1] = shape.path(p, 1);
  }
}

// slopes: (N, 32, 2), of the paths.  of_gists: (N, 16).  of_rests: (N, 47), or (0, 47) where nobody asks.
void decode_backward(Array<const float, 2> gists, Array<const float, 2> rests, Array<const float, 2> x,
                     Array<const float, 2> y, Array<const float, 3> slopes, Array<float, 2> of_gists,
                     Array<float, 2> of_rests) {
  nb::gil_scoped_release release;
  const Bases bases{{x.data(), y.data()}};
  std::fill(of_gists.data(), of_gists.data() + of_gists.size(), 0.0f);
  std::fill(of_rests.data(), of_rests.data() + of_rests.size(), 0.0f);
  Shape shape;
  float slope[2][points];
  for (int64_t i = 0; i < int64_t(gists.shape(0)); ++i) {
    make_shape(gists.data() + i * gist, rests.data() + i * residual, bases, shape);
    const float* given = slopes.data() + i * 2 * points;
    for (int64_t p = 0; p < points; ++p) slope[0][p] = given[2 * p], slope[1][p] = given[2 * p + 1];
    add_slopes(shape, bases, slope, of_gists.data() + i * gist,
               of_rests.size() ? of_rests.data() + i * residual : nullptr);
  }
}

// wanted: (N, 19), ascending in each column, that the traits are to have.  widths: (19,), of their distances.
// costs: (N,), half the squared distances.  of_gists: (N, 16), their slopes.
void trait_costs(Array<const float, 2> gists, Array<const float, 2> rests, Array<const float, 2> x,
                 Array<const float, 2> y, Array<const double, 2> wanted, Array<const double, 1> widths,
                 Array<float, 1> costs, Array<float, 2> of_gists) {
  nb::gil_scoped_release release;
  const Bases bases{{x.data(), y.data()}};
  const int64_t count = gists.shape(0);
  std::vector<Traits> all(count);
  for (int64_t i = 0; i < count; ++i) all[i].set(gists.data() + i * gist, rests.data() + i * residual, bases);
  for (int64_t column = 0; column < traits; ++column) {
    const std::vector<int64_t> order = ascending(all, column);
    for (int64_t rank = 0; rank < count; ++rank) {
      Traits& one = all[order[rank]];
      one.apart[column] = (one.values[column] - wanted(rank, column)) / widths(column);
    }
  }
  std::fill(of_gists.data(), of_gists.data() + of_gists.size(), 0.0f);
  for (int64_t i = 0; i < count; ++i) {
    double sum = 0, slopes[traits];
    for (int64_t column = 0; column < traits; ++column) {
      sum += all[i].apart[column] * all[i].apart[column];
      slopes[column] = all[i].apart[column] / widths(column);
    }
    costs(i) = static_cast<float>(sum / 2);
    all[i].add_slopes(bases, slopes, of_gists.data() + i * gist);
  }
}

}  // namespace

NB_MODULE(_shape, m) {
  m.def("decode", &decode);
  m.def("decode_backward", &decode_backward);
  m.def("trait_costs", &trait_costs);
}
