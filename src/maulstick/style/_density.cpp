// Costs by a mixture of Gaussians, and their slopes: the fast version of `Density.cost`, whose `terms` it takes.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace nb = nanobind;

namespace {

template <class T, int Dimensions>
using Array = nb::ndarray<T, nb::ndim<Dimensions>, nb::c_contig, nb::device::cpu>;

constexpr double negligible = 37;            // nats: e to the power of minus so many is less than a double's grain
constexpr int64_t step = 4;                  // terms, and centres, at a time

int64_t whole(int64_t count) { return (count + step - 1) / step * step; }

// Terms of the squared distance of points from all centres, padded by such as add nothing, and by centres far away.
struct Table {
  int64_t count, terms, centres, width;
  std::vector<double> rows, columns;         // (terms, width); (centres, count)

  explicit Table(Array<const double, 2> given)
      : count(given.shape(0)), terms(whole(count)), centres(given.shape(1)), width(whole(centres)),
        rows(terms * width, 0.0), columns(centres * count) {
    for (int64_t t = 0; t < count; ++t)
      for (int64_t m = 0; m < centres; ++m) rows[t * width + m] = columns[m * count + t] = given(t, m);
    std::fill(&rows[(count - 1) * width + centres], &rows[(count - 1) * width] + width, HUGE_VAL);
  }

  // of: (terms,).  apart: (width,).
  void add_up(const double* of, double* __restrict apart) const {
    std::fill(apart, apart + width, 0.0);
    for (int64_t t = 0; t < terms; t += step) {
      const double *a = &rows[t * width], *b = a + width, *c = b + width, *d = c + width;
      for (int64_t m = 0; m < width; ++m) apart[m] += of[t] * a[m] + of[t + 1] * b[m] + of[t + 2] * c[m] + of[t + 3] * d[m];
    }
  }
};

double least_of(const std::vector<double>& apart) {
  double least[step];
  std::copy(apart.begin(), apart.begin() + step, least);
  for (size_t m = step; m < apart.size(); m += step)
    for (int64_t lane = 0; lane < step; ++lane) least[lane] = std::min(least[lane], apart[m + lane]);
  return *std::min_element(least, least + step);
}

// points: (N, d).  inverse: (d, d), of the covariance.  group: (d,), of each number; there are k.
// terms: (k * k + d + 1, M), which the squares within and between groups, the numbers and 1 are multiplied by.
// costs: (N,), without log M.  nearest: (N,).  slopes: (N, d), of the costs.
void cost(Array<const double, 2> points, Array<const double, 2> inverse, Array<const int64_t, 1> group,
          Array<const double, 2> terms, Array<double, 1> costs, Array<int64_t, 1> nearest, Array<double, 2> slopes) {
  nb::gil_scoped_release release;
  const Table table(terms);
  const int64_t count = points.shape(0), d = points.shape(1), pairs = table.count - d - 1;
  const int64_t groups = std::lround(std::sqrt(double(pairs)));
  const int64_t* of_group = group.data();
  std::vector<double> apart(table.width), of(table.terms), mixed(table.count), sums(groups * d);
  for (int64_t i = 0; i < count; ++i) {
    const double* x = points.data() + i * d;
    std::fill(sums.begin(), sums.end(), 0.0);                      // (k, d): the inverse times a group's numbers
    for (int64_t b = 0; b < d; ++b)
      for (int64_t a = 0; a < d; ++a) sums[of_group[b] * d + a] += x[b] * inverse.data()[b * d + a];
    std::fill(of.begin(), of.end(), 0.0);
    for (int64_t a = 0; a < d; ++a) {
      for (int64_t g = 0; g < groups; ++g) of[of_group[a] * groups + g] += x[a] * sums[g * d + a];
      of[pairs + a] = x[a];
    }
    of[pairs + d] = 1;
    table.add_up(of.data(), apart.data());

    const double least = std::max(least_of(apart), 0.0), bound = least + 2 * negligible;
    double total = 0;
    nearest(i) = -1;
    std::fill(mixed.begin(), mixed.end(), 0.0);
    for (int64_t m = 0; m < table.centres; ++m) {
      if (apart[m] > bound) continue;
      if (nearest(i) < 0 && apart[m] <= least) nearest(i) = m;
      const double share = std::exp((least - std::max(apart[m], 0.0)) / 2);
      total += share;
      if (apart[m] < 0) continue;            // less than no distance, by rounding: there is no slope
      const double* column = &table.columns[m * table.count];
      for (int64_t t = 0; t < table.count; ++t) mixed[t] += share * column[t];
    }
    costs(i) = least / 2 - std::log(total);
    for (int64_t a = 0; a < d; ++a) {
      double sum = mixed[pairs + a] / 2;
      for (int64_t g = 0; g < groups; ++g) sum += mixed[of_group[a] * groups + g] * sums[g * d + a];
      slopes(i, a) = sum / total;
    }
  }
}

}  // namespace

NB_MODULE(_density, m) { m.def("cost", &cost); }
