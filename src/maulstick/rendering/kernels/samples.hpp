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

  // Appends those of LANES cells that are `wanted`. pixels: to which each belongs.
  void append(const Nearest& near, Ints wanted, Floats xs, Floats ys, Floats sides, Floats weights, Ints pixels) {
    const Ints owners = near.owner & (creased_bit - 1);
    if (!any(~wanted)) {
      store(x + count, xs), store(y + count, ys), store(side + count, sides), store(weight + count, weights);
      store(offset_x + count, near.offset_x), store(offset_y + count, near.offset_y);
      store(thickness + count, near.thickness), store(owner + count, owners), store(at + count, pixels);
      count += LANES;
      return;
    }
    for (int i = 0; i < LANES; ++i) {
      if (!wanted[i]) continue;
      x[count] = xs[i], y[count] = ys[i], side[count] = sides[i], weight[count] = weights[i], at[count] = pixels[i];
      offset_x[count] = near.offset_x[i], offset_y[count] = near.offset_y[i], thickness[count] = near.thickness[i];
      owner[count++] = owners[i];
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

// Calls shade(samples) for batches of a stroke's samples off its plateau; their number is a multiple of LANES.
template <class Shade>
void each_batch(Samples& samples, const Coverage& cover, const Cuts& cuts, const Strokes& s, int64_t id,
                const Profile& profile, Tile tile, Shade shade) {
  const auto flush = [&](int room) {
    if (samples.count + room <= batch - LANES) return;
    samples.pad();
    shade(samples);
    samples.count = 0;
  };
  samples.count = 0;
  each_block(cover, [&](int block) {
    flush(LANES);
    const Nearest& near = cover.near[block];
    const Floats whole = 1.0f - load(cuts.share + block * LANES);
    samples.append(near, (near.square < all(no_mark)) & ~on_plateau(near, profile) & (whole > all(0.0f)),
                   block_x(tile, block), block_y(tile, block), all(1.0f), whole, lane_numbers_from(block * LANES));
  });
  for (int32_t n = 0; n < cuts.count; ++n) {
    const Cut& cut = cuts.cut[n];
    const float step = 1.0f / cut.cells, left = tile.x + column_of(cut.at), top = tile.y + row_of(cut.at);
    const int cells = cut.cells * cut.cells;
    for (int first = 0; first < cells; first += LANES) {
      Floats x, y, weight;
      for (int i = 0; i < LANES; ++i) {
        const int cell = first + i < cells ? first + i : first;
        x[i] = left + (cell % cut.cells + 0.5f) * step, y[i] = top + (cell / cut.cells + 0.5f) * step;
        weight[i] = first + i < cells ? cut.share * step * step : 0;
      }
      flush(LANES);
      const Nearest near = nearest_of<false>(cover.reaching, cover.comes_near, s.segment + id * s.segments, s.segments,
                                             cut.at / LANES, x, y, all(step));
      samples.append(near, (near.square < all(no_mark)) & (weight > all(0.0f)), x, y, all(step), weight,
                     all(int32_t(cut.at)));
    }
  }
  flush(batch);
}

}  // namespace
}  // namespace maulstick
