// Numbers of strokes among those near them, as `plain_describe` in laid.py says them, and their slopes.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>

#include "corners.hpp"

namespace nb = nanobind;

namespace {

using maulstick::Grid;

template <class T, int Dimensions>
using Array = nb::ndarray<T, nb::ndim<Dimensions>, nb::c_contig, nb::device::cpu>;
using Points = Array<const double, 3>;
using Vectors = Array<const double, 2>;
using Numbers = Array<const double, 1>;

constexpr int64_t near = 4, gaps = 8;        // strokes near one, and corners of each line that gaps are measured from
constexpr double shortest_side = 1e-18;      // squared, of a line between two corners

enum Column { distance = 0, alike = near, crossing = 2 * near, along = 3 * near, length = 4 * near, gap = 5 * near };

// points: (N, n, 2), of N > 1 lines.  found: (N, m), of every (n / m)th corner the nearest of another line, numbered
// through all lines.
void nearest(Points points, Array<int64_t, 2> found) {
  nb::gil_scoped_release release;
  const int64_t lines = points.shape(0), corners = points.shape(1), every = corners / found.shape(1);
  const Grid grid(points.data(), lines * corners);
  for (int64_t line = 0; line < lines; ++line)
    for (int64_t k = 0; k < int64_t(found.shape(1)); ++k)
      found(line, k) = grid.nearest(line * corners + k * every, line * corners, (line + 1) * corners);
}

// From a corner to the nearest place on the side of a line that begins at its `start`.
struct Way {
  double x, y, share;                        // of the side, from its start

  Way(const double* corner, const double* start) {
    const double side_x = start[2] - start[0], side_y = start[3] - start[1];
    x = corner[0] - start[0], y = corner[1] - start[1];
    const double squared = std::max(side_x * side_x + side_y * side_y, shortest_side);
    share = std::clamp((x * side_x + y * side_y) / squared, 0.0, 1.0);
    x -= share * side_x, y -= share * side_y;
  }

  double squared() const { return x * x + y * y; }
};

double log_distance(double x, double y, double least) { return std::log(x * x + y * y + least * least) / 2; }

// Where another stroke's centre is, in the frame of one.
struct Offset {
  double x, y, cos, sin, along, across;      // in units; of the axis; signed

  Offset(Vectors centres, Numbers axes, int64_t one, int64_t other, double unit)
      : x((centres(other, 0) - centres(one, 0)) / unit), y((centres(other, 1) - centres(one, 1)) / unit),
        cos(std::cos(axes(one))), sin(std::sin(axes(one))), along(x * cos + y * sin), across(x * sin - y * cos) {}
};

// beside: (N, 4), strokes with the nearest centres.  points: (N, 16, 2).  centres: (N, 2).  axes, straightness,
// lengths: (N,).  numbers: (N, 23).  sides: (N, 8), where in `points` the sides begin that gaps go to.  gaps_of: (N, 8),
// their logarithms.
void describe(double unit, double least, Array<const int64_t, 2> beside, Points points, Vectors centres, Numbers axes,
              Numbers straightness, Numbers lengths, Array<double, 2> numbers, Array<int64_t, 2> sides,
              Array<double, 2> gaps_of) {
  if (int64_t(points.shape(0)) <= near) throw std::invalid_argument("there are too few strokes to be near one");
  nb::gil_scoped_release release;
  const int64_t lines = points.shape(0), corners = points.shape(1), every = corners / gaps;
  const double* all = points.data();
  const Grid grid(all, lines * corners);
  for (int64_t i = 0; i < lines; ++i) {
    for (int64_t k = 0; k < near; ++k) {
      const int64_t j = beside(i, k);
      const Offset to(centres, axes, i, j, unit);
      const double turned = 2 * (axes(j) - axes(i)), both = straightness(i) * straightness(j);
      numbers(i, distance + k) = log_distance(to.x, to.y, least);
      numbers(i, alike + k) = both * std::cos(turned);
      numbers(i, crossing + k) = both * std::abs(std::sin(turned));
      const double ahead = std::abs(to.along), aside = std::abs(to.across);
      numbers(i, Column::along + k) = (ahead - aside) / (ahead + aside + least);
      numbers(i, length + k) = std::abs(std::log(lengths(j)) - std::log(lengths(i)));
    }
    double* own = &gaps_of(i, 0);
    for (int64_t k = 0; k < gaps; ++k) {
      const int64_t corner = i * corners + k * every, found = grid.nearest(corner, i * corners, (i + 1) * corners);
      const int64_t first = found - found % corners, last = first + corners - 2;
      const int64_t before = std::clamp(found - 1, first, last), after = std::clamp(found, first, last);
      const Way one(all + 2 * corner, all + 2 * before), other(all + 2 * corner, all + 2 * after);
      const bool nearer = one.squared() < other.squared();
      const Way& way = nearer ? one : other;
      sides(i, k) = nearer ? before : after;
      own[k] = log_distance(way.x / unit, way.y / unit, least);
    }
    const double mean = std::accumulate(own, own + gaps, 0.0) / gaps;
    double squares = 0;
    for (int64_t k = 0; k < gaps; ++k) squares += (own[k] - mean) * (own[k] - mean);
    numbers(i, gap) = mean;
    numbers(i, gap + 1) = *std::min_element(own, own + gaps);
    numbers(i, gap + 2) = std::sqrt(squares / (gaps - 1));
  }
}

double sign(double x) { return double(x > 0) - double(x < 0); }

// What `describe` was given and found, and slopes of a result by the numbers, (N, 23). Slopes by points, centres, axes,
// straightness and lengths, which are 0 at first, are added to.
void describe_backward(double unit, double least, Array<const int64_t, 2> beside, Points points, Vectors centres,
                       Numbers axes, Numbers straightness, Numbers lengths, Vectors numbers,
                       Array<const int64_t, 2> sides, Vectors gaps_of, Vectors slopes, Array<double, 3> of_points,
                       Array<double, 2> of_centres, Array<double, 1> of_axes, Array<double, 1> of_straightness,
                       Array<double, 1> of_lengths) {
  nb::gil_scoped_release release;
  const int64_t lines = points.shape(0), corners = points.shape(1), every = corners / gaps;
  const double* all = points.data();
  double* of_all = of_points.data();
  for (int64_t i = 0; i < lines; ++i) {
    for (int64_t k = 0; k < near; ++k) {
      const int64_t j = beside(i, k);
      const Offset to(centres, axes, i, j, unit);
      const double turned = 2 * (axes(j) - axes(i)), cos = std::cos(turned), sin = std::sin(turned);
      const double both = straightness(i) * straightness(j);
      const double by_alike = slopes(i, alike + k), by_crossing = slopes(i, crossing + k);
      const double by_both = by_alike * cos + by_crossing * std::abs(sin);
      of_straightness(i) += by_both * straightness(j), of_straightness(j) += by_both * straightness(i);
      const double by_turn = 2 * both * (by_crossing * sign(sin) * cos - by_alike * sin);
      of_axes(j) += by_turn, of_axes(i) -= by_turn;

      const double ahead = std::abs(to.along), aside = std::abs(to.across), sum = ahead + aside + least;
      const double by_along = slopes(i, Column::along + k) * sign(to.along) * (2 * aside + least) / (sum * sum);
      const double by_across = -slopes(i, Column::along + k) * sign(to.across) * (2 * ahead + least) / (sum * sum);
      of_axes(i) += by_across * to.along - by_along * to.across;
      const double by_log = slopes(i, distance + k) / (to.x * to.x + to.y * to.y + least * least);
      const double by_x = (by_log * to.x + by_along * to.cos + by_across * to.sin) / unit;
      const double by_y = (by_log * to.y + by_along * to.sin - by_across * to.cos) / unit;
      of_centres(j, 0) += by_x, of_centres(j, 1) += by_y, of_centres(i, 0) -= by_x, of_centres(i, 1) -= by_y;

      const double by_ratio = slopes(i, length + k) * sign(std::log(lengths(j)) - std::log(lengths(i)));
      of_lengths(j) += by_ratio / lengths(j), of_lengths(i) -= by_ratio / lengths(i);
    }
    const double mean = numbers(i, gap), shortest = numbers(i, gap + 1), spread = numbers(i, gap + 2);
    const double* own = &gaps_of(i, 0);
    const auto as_short = double(std::count(own, own + gaps, shortest));
    for (int64_t k = 0; k < gaps; ++k) {
      double slope = slopes(i, gap) / gaps;
      if (own[k] == shortest) slope += slopes(i, gap + 1) / as_short;
      if (spread > 0) slope += slopes(i, gap + 2) * (own[k] - mean) / (spread * (gaps - 1));
      const int64_t corner = 2 * (i * corners + k * every), side = 2 * sides(i, k);
      const Way way(all + corner, all + side);
      const double by_offset = slope / (way.squared() + least * least * unit * unit);
      const double by_x = by_offset * way.x, by_y = by_offset * way.y;
      of_all[corner] += by_x, of_all[corner + 1] += by_y;
      of_all[side] -= (1 - way.share) * by_x, of_all[side + 1] -= (1 - way.share) * by_y;
      of_all[side + 2] -= way.share * by_x, of_all[side + 3] -= way.share * by_y;
    }
  }
}

}  // namespace

NB_MODULE(_neighbourhoods, m) {
  m.def("nearest", &nearest);
  m.def("describe", &describe);
  m.def("describe_backward", &describe_backward);
}
