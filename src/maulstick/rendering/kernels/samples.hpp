// A stroke over a tile as lists of samples: pixels along which it is straight, and parts of pixels in which it is not. The
// darkness of a pixel is the weighted sum of its samples'. Lists are dense where blocks of pixels are mostly empty.
#pragma once
#include "coverage.hpp"

namespace maulstick {
namespace {

constexpr int batch = 512;            // samples that are kept before they are shaded; a multiple of LANES

// The pixel of a tile that a sample belongs to, and the segment that owns it, in one number.
constexpr int pixel_bits = 10;
static_assert(tile_pixels == 1 << pixel_bits && most_segments < 1 << (31 - pixel_bits));

inline int32_t place_of(int32_t owner, int pixel) { return owner << pixel_bits | pixel; }
template <class Places> inline Places pixel_of(Places places) { return places & (tile_pixels - 1); }
template <class Places> inline Places owner_of(Places places) { return places >> pixel_bits; }

struct Samples {
  int32_t count = 0;
  alignas(64) float offset_x[batch], offset_y[batch], thickness[batch];
  alignas(64) int32_t place[batch];

  // Appends the pixels of a block that are `wanted`.
  void append(const Nearest& near, Ints wanted, int block) {
    Ints pixel;
    for (int i = 0; i < LANES; ++i) pixel[i] = i;
    const uint32_t bits = bits_of(wanted);
    store_some(offset_x + count, near.offset_x, bits), store_some(offset_y + count, near.offset_y, bits);
    store_some(thickness + count, near.thickness, bits);
    store_some(place + count, (near.owner << pixel_bits) + (pixel + block * LANES), bits);
    count += __builtin_popcount(bits);
  }

  void append_one(const Nearest& near, int lane, int pixel) {
    offset_x[count] = near.offset_x[lane], offset_y[count] = near.offset_y[lane];
    thickness[count] = near.thickness[lane], place[count++] = place_of(near.owner[lane], pixel);
  }

  // Fills the last vector with samples that no mark reaches, of a pixel that has another one.
  void pad() {
    for (; count % LANES; ++count) {
      offset_x[count] = 10, offset_y[count] = 0, thickness[count] = 1;
      place[count] = pixel_of(place[count - 1]);
    }
  }
};

// Parts of pixels (reference.py, _mean_darkness).
struct Parts : Samples {
  alignas(64) float weight[batch], shift[batch], scale[batch];
  alignas(64) int32_t point[batch];   // whether the part lies around a point and not along a line
  alignas(64) int32_t ends[batch];    // bits as in Bent, and 4 if the weight falls as that share grows
  alignas(64) float share[batch];     // of the pixel, by which the weight grows or falls

  void append(const Nearest& near, int lane, int pixel, float part, float slant, float rounded, int32_t growing) {
    const float lost = 1 - part;
    for (int around = 0; around < 2; ++around) {
      const float its = around ? rounded : 1 - rounded;
      if (!(its > 0)) continue;
      weight[count] = part * its, share[count] = part, point[count] = -around;
      shift[count] = -0.5f * slant * lost;
      scale[count] = __builtin_sqrtf(larger(1 - slant * slant * lost * (2 - lost), slimmest * slimmest));
      ends[count] = growing ? growing | (around ? 0 : 4) : 0;
      append_one(near, lane, pixel);
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
void each_batch(Samples& samples, Parts& parts, const Coverage& cover, const Profile& profile, Shade shade,
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
    if (is_odd(cover, block)) {
      const Bent& bent = cover.bent[block];
      const Ints straight = (bent.rounded == all(0.0f)) & (bent.share == all(0.0f));
      flush(parts, 4 * LANES, shade_parts);
      for (int i = 0; i < LANES; ++i) {
        if (!wanted[i] || straight[i]) continue;
        const int pixel = block * LANES + i;
        const float share = bent.share[i];
        parts.append(near, i, pixel, 1 - share, bent.slant[i], bent.rounded[i], bent.ends[i]);
        if (share > 0)
          parts.append(bent.second, i, pixel, share, bent.slant[i], bent.second_rounded[i], bent.second_ends[i]);
      }
      wanted &= straight;
    }
    if (any(wanted)) samples.append(near, wanted, block);
  });
  flush(samples, batch, shade);
  flush(parts, batch, shade_parts);
}

}  // namespace
}  // namespace maulstick
