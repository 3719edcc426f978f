// Of corners of lines, the nearest of another line: by a grid of cells that hold a few corners each.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace maulstick {

constexpr double in_a_cell = 2;              // corners, on average

// Numbers of all points (count, 2), cell by cell, row by row.
struct Grid {
  const double* points;
  double left, top, side;
  int64_t columns, rows;
  std::vector<int64_t> first, sorted;        // the first of each cell among the sorted ones

  Grid(const double* points, int64_t count) : points(points) {
    double right = left = points[0], bottom = top = points[1];
    for (int64_t i = 0; i < count; ++i) {
      if (!std::isfinite(points[2 * i]) || !std::isfinite(points[2 * i + 1]))
        throw std::invalid_argument("a corner of a line is nowhere");
      left = std::min(left, points[2 * i]), right = std::max(right, points[2 * i]);
      top = std::min(top, points[2 * i + 1]), bottom = std::max(bottom, points[2 * i + 1]);
    }
    const double width = right - left, height = bottom - top, cells = std::max(1.0, count / in_a_cell);
    side = std::max(std::sqrt(width * height / cells), std::max(width, height) / cells);
    if (!(side > 0)) side = 1;               // all points are one
    columns = int64_t(width / side) + 1, rows = int64_t(height / side) + 1;
    first.assign(columns * rows + 1, 0), sorted.resize(count);
    for (int64_t i = 0; i < count; ++i) ++first[cell(i) + 1];
    for (int64_t c = 0; c < columns * rows; ++c) first[c + 1] += first[c];
    std::vector<int64_t> next(first.begin(), first.end() - 1);
    for (int64_t i = 0; i < count; ++i) sorted[next[cell(i)]++] = i;
  }

  int64_t column(int64_t i) const { return std::min(int64_t((points[2 * i] - left) / side), columns - 1); }
  int64_t row(int64_t i) const { return std::min(int64_t((points[2 * i + 1] - top) / side), rows - 1); }
  int64_t cell(int64_t i) const { return row(i) * columns + column(i); }

  // The point that is nearest to point i, of those outside [begin, end); -1 without any.
  int64_t nearest(int64_t i, int64_t begin, int64_t end) const {
    const double x = points[2 * i], y = points[2 * i + 1];
    const int64_t c = column(i), r = row(i);
    int64_t found = -1;
    double least = HUGE_VAL;
    auto look = [&](int64_t at_row, int64_t from, int64_t to) {
      if (at_row < 0 || at_row >= rows) return;
      from = std::max<int64_t>(from, 0), to = std::min(to, columns - 1);
      if (from > to) return;
      const int64_t last = first[at_row * columns + to + 1];
      for (int64_t k = first[at_row * columns + from]; k < last; ++k) {
        const int64_t j = sorted[k];
        if (j >= begin && j < end) continue;
        const double dx = points[2 * j] - x, dy = points[2 * j + 1] - y, apart = dx * dx + dy * dy;
        if (apart < least || (apart == least && j < found)) least = apart, found = j;
      }
    };
    for (int64_t ring = 0; ring <= std::max(columns, rows); ++ring) {
      look(r - ring, c - ring, c + ring);
      if (ring > 0) look(r + ring, c - ring, c + ring);
      for (int64_t between = r - ring + 1; between < r + ring; ++between)
        look(between, c - ring, c - ring), look(between, c + ring, c + ring);
      if (found >= 0 && least < ring * side * (ring * side)) break;    // all further cells are farther
    }
    return found;
  }
};

}  // namespace maulstick
