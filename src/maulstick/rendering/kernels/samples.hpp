// A stroke over a tile as lists of samples: pixels along which it is straight, and parts of pixels in which it is not. The
// darkness of a pixel is the weighted sum of its samples'. Lists are dense where blocks of pixels are mostly empty.
#pragma once
#include "coverage.hpp"

namespace maulstick {
namespace {

constexpr int batch = 512;            // samples that are kept before they are shaded; a multiple of LANES

struct Samples {
  int32_t count = 0;
  alignas(64) float x[batch], y[batch], offset_x[batch], offset_y[batch], thickness[batch];
  alignas(64) int32_t owner[batch], at[batch];

  // Appends those of LANES pixels that are `wanted`. pixels: their places in the tile.
  void append(const Nearest& near, Ints wanted, Floats xs, Floats ys, int first) {
    if (!any(~wanted)) {
      store(x + count, xs), store(y + count, ys);
      store(offset_x + count, near.offset_x), store(offset_y + count, near.offset_y);
      store(thickness + count, near.thickness), store(owner + count, near.owner);
      for (int i = 0; i < LANES; ++i) at[count + i] = first + i;
      count += LANES;
      return;
    }
    for (int i = 0; i < LANES; ++i)
      if (wanted[i]) append_one(near, i, xs[i], ys[i], first + i);
  }

  void append_one(const Nearest& near, int lane, float xs, float ys, int pixel) {
    x[count] = xs, y[count] = ys, at[count] = pixel;
    offset_x[count] = near.offset_x[lane], offset_y[count] = near.offset_y[lane];
    thickness[count] = near.thickness[lane], owner[count++] = near.owner[lane];
  }

  // Fills the last vector with samples that no mark reaches, of a pixel that has another one.
  void pad() {
    for (; count % LANES; ++count) {
      x[count] = y[count] = offset_y[count] = 0;
      offset_x[count] = 10, thickness[count] = 1;
      owner[count] = 0, at[count] = at[count - 1];
    }
  }
};

// Parts of pixels (reference.py, _mean_darkness).
struct Parts : Samples {
  alignas(64) float weight[batch], shift[batch], scale[batch];
  alignas(64) int32_t point[batch];   // whether the part lies around a point and not along a line
  alignas(64) int32_t ends[batch];    // bits as in Bent, and 4 if the weight falls as that share grows
  alignas(64) float share[batch];     // of the pixel, by which the weight grows or falls

  void append(const Nearest& near, int lane, float xs, float ys, int pixel, float part, float slant, float rounded,
              int32_t growing) {
    const float lost = 1 - part;
    for (int around = 0; around < 2; ++around) {
      const float its = around ? rounded : 1 - rounded;
      if (!(its > 0)) continue;
      weight[count] = part * its, share[count] = part, point[count] = -around;
      shift[count] = -0.5f * slant * lost;
      scale[count] = __builtin_sqrtf(larger(1 - slant * slant * lost * (2 - lost), slimmest * slimmest));
      ends[count] = growing ? growing | (around ? 0 : 4) : 0;
      append_one(near, lane, xs, ys, pixel);
    }
  }

  void pad() {
    for (int32_t i = count; i % LANES; ++i) weight[i] = shift[i] = 0, scale[i] = 1, point[i] = ends[i] = 0;
    Samples::pad();
  }

  static constexpr float slimmest = 0.1f;
};

// Calls shade(samples) and shade_parts(parts) for batches of a stroke's samples off its plateau; their numbers are
// multiples of LANES.
template <class Shade, class ShadeParts>
void each_batch(Samples& samples, Parts& parts, const Coverage& cover, const Profile& profile, Tile tile, Shade shade,
                ShadeParts shade_parts) {
  const auto flush = [](auto& list, int room, auto visit) {
    if (list.count + room <= batch || list.count == 0) return;
    list.pad();
    visit(list);
    list.count = 0;
  };
  each_block(cover, [&](int block) {
    flush(samples, LANES, shade);
    const Nearest& near = cover.near[block];
    Ints wanted = marks(near) & ~on_plateau(near, profile);
    const Floats x = block_x(tile, block), y = block_y(tile, block);
    if (is_odd(cover, block)) {
      const Bent& bent = cover.bent[block];
      const Ints straight = (bent.rounded == all(0.0f)) & (bent.share == all(0.0f));
      flush(parts, 4 * LANES, shade_parts);
      for (int i = 0; i < LANES; ++i) {
        if (!wanted[i] || straight[i]) continue;
        const int pixel = block * LANES + i;
        const float share = bent.share[i];
        parts.append(near, i, x[i], y[i], pixel, 1 - share, bent.slant[i], bent.rounded[i], bent.ends[i]);
        if (share > 0)
          parts.append(bent.second, i, x[i], y[i], pixel, share, bent.slant[i], bent.second_rounded[i],
                       bent.second_ends[i]);
      }
      wanted &= straight;
    }
    if (any(wanted)) samples.append(near, wanted, x, y, block * LANES);
  });
  flush(samples, batch, shade);
  flush(parts, batch, shade_parts);
}

}  // namespace
}  // namespace maulstick
