// Costs of strokes of the free style, and their slopes: the fast version of `FreeStyle.cost`.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace nb = nanobind;

namespace {

using Rows = nb::ndarray<float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using GivenRows = nb::ndarray<const float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

constexpr int points = 8, steps = points - 1;   // of the control polygon
constexpr double softness = 1e-12;              // metres²: keeps a step without length out of the denominators
constexpr double beyond = 100;                  // weight of the squared logarithm of a length beyond the limits

struct Vector {
  double x = 0, y = 0;
  Vector operator-(Vector other) const { return {x - other.x, y - other.y}; }
  double squared() const { return x * x + y * y; }
  void add(double times, Vector other) { x += times * other.x, y += times * other.y; }
};

// code: the chord, then the inner control points.  of_code: the slopes of the cost by it.
double of_path(const float* code, double unit, double shortest, double longest, float* of_code) {
  Vector control[points], step[steps], of_step[steps];
  control[points - 1].x = unit * std::abs(code[0]);
  for (int k = 1; k < points - 1; ++k) control[k] = {unit * code[2 * k - 1], unit * code[2 * k]};
  double long_[steps], length = 0, turned = 0;
  for (int j = 0; j < steps; ++j) {
    step[j] = control[j + 1] - control[j];
    length += long_[j] = std::sqrt(step[j].squared() + softness);
  }
  const double even = length / steps, share = 2 / (even * even);
  for (int j = 0; j + 1 < steps; ++j) {
    const Vector bend = step[j + 1] - step[j];
    turned += bend.squared();
    of_step[j + 1].add(share, bend);
    of_step[j].add(-share, bend);
  }
  const double bending = turned / (even * even);
  const double shorter = std::max(std::log(shortest / length), 0.0), longer = std::max(std::log(length / longest), 0.0);
  const double of_length = (-2 * bending + 2 * beyond * (longer - shorter)) / length;
  for (int j = 0; j < steps; ++j) of_step[j].add(of_length / long_[j], step[j]);
  for (int k = 1; k < points - 1; ++k) {
    const Vector of_control = of_step[k - 1] - of_step[k];
    of_code[2 * k - 1] = float(unit * of_control.x), of_code[2 * k] = float(unit * of_control.y);
  }
  of_code[0] = float(unit * of_step[steps - 1].x * ((code[0] > 0) - (code[0] < 0)));
  return bending + beyond * (shorter + longer) * (shorter + longer);
}

// codes: (N, 13).  knots: (N, K), of pressure.  costs: (N, 1).  of_codes, of_knots: their slopes.
void cost(GivenRows codes, GivenRows knots, double unit, double shortest, double longest, Rows costs, Rows of_codes,
          Rows of_knots) {
  nb::gil_scoped_release release;
  for (int64_t i = 0; i < int64_t(codes.shape(0)); ++i) {
    const float* knot = &knots(i, 0);
    float* of_knot = &of_knots(i, 0);
    double total = of_path(&codes(i, 0), unit, shortest, longest, &of_codes(i, 0));
    std::fill(of_knot, of_knot + knots.shape(1), 0.0f);
    for (int64_t k = 0; k + 1 < int64_t(knots.shape(1)); ++k) {
      const float change = knot[k + 1] - knot[k];
      total += double(change) * change;
      of_knot[k] -= 2 * change, of_knot[k + 1] += 2 * change;
    }
    costs(i, 0) = float(total);
  }
}

}  // namespace

NB_MODULE(_free, m) { m.def("cost", &cost); }
