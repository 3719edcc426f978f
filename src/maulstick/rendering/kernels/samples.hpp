// A stroke over a tile as a list of samples: pixels that it reaches, and cells of pixels that are cut up. The darkness of
// a pixel is the weighted sum of its samples'. A list is dense where blocks of pixels are mostly empty.
#pragma once
#include "coverage.hpp"

namespace maulstick {
namespace {

constexpr int batch = 512;            // samples that are kept before they are shaded; a multiple of LANES

struct Samples {
  int32_t count;
  alignas(64) float x[batch], y[batch], offset_x[batch], offset_y[batch], thickness[batch], side[batch], weight[batch];
  alignas(64) int32_t owner[batch], at[batch];

  // Appends those of LANES cells that the stroke marks and that weigh something. pixels: to which each belongs.
  void append(const Nearest& near, Floats xs, Floats ys, float cell, Floats weights, Ints pixels) {
    for (int i = 0; i < LANES; ++i) {
      x[count] = xs[i], y[count] = ys[i], side[count] = cell, weight[count] = weights[i], at[count] = pixels[i];
      offset_x[count] = near.offset_x[i], offset_y[count] = near.offset_y[i], thickness[count] = near.thickness[i];
      owner[count] = near.owner[i] & (creased_bit - 1);
      count += near.square[i] < no_mark && weights[i] > 0;
    }
  }

  // Fills the last vector with samples that weigh nothing.
  void pad() {
    for (; count % LANES; ++count) {
      x[count] = y[count] = offset_x[count] = offset_y[count] = weight[count] = 0;
      thickness[count] = side[count] = 1;
      owner[count] = at[count] = 0;
    }
  }
};

inline Ints lane_numbers_from(int first) {
  Ints numbers;
  for (int i = 0; i < LANES; ++i) numbers[i] = first + i;
  return numbers;
}

// Calls shade(samples) for batches of all samples of a stroke; their number is a multiple of LANES.
template <class Shade>
void each_batch(Samples& samples, const Coverage& cover, const Cuts& cuts, const Strokes& s, int64_t id, Tile tile,
                Shade shade) {
  const auto flush = [&](int room) {
    if (samples.count + room <= batch - LANES) return;
    samples.pad();
    shade(samples);
    samples.count = 0;
  };
  samples.count = 0;
  each_block(cover, [&](int block) {
    flush(LANES);
    samples.append(cover.near[block], block_x(tile, block), block_y(tile, block), 1,
                   1.0f - load(cuts.share + block * LANES), lane_numbers_from(block * LANES));
  });
  for (int32_t n = 0; n < cuts.count; ++n) {
    const int at = cuts.at[n];
    const float x = tile.x + column_of(at) + 0.5f, y = tile.y + row_of(at) + 0.5f;
    const Cells cells = cover_cells(s.segment + id * s.segments, s.segments, x, y);
    for (int part = 0; part < cells_a_pixel / LANES; ++part) {
      flush(LANES);
      samples.append(cells.near[part], cell_x(part, x), cell_y(part, y), cell_side,
                     all(cuts.share[at] / cells_a_pixel), all(int32_t(at)));
    }
  }
  flush(batch);
}

}  // namespace
}  // namespace maulstick
