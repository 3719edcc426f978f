// What a stroke covers of a tile.
#pragma once
#include "nearest.hpp"

namespace maulstick {
namespace {

constexpr int tile_pixels = tile_height * tile_width;
constexpr int tile_blocks = tile_pixels / LANES;

// A block of pixels is 4 wide, and the blocks of a tile lie in it row by row; so strokes fill blocks better than they
// would fill rows of LANES pixels. Pixels are numbered block by block.
constexpr int block_width = 4, block_height = LANES / block_width, blocks_across = tile_width / block_width;
constexpr int block_rows = tile_height / block_height;
constexpr int lane_bits = LANES == 16 ? 4 : LANES == 8 ? 3 : 2, width_bits = 2, across_bits = 4;
static_assert(LANES == 1 << lane_bits && block_width == 1 << width_bits && blocks_across == 1 << across_bits);

inline int pixel_at(int row, int column) {
  return (row / block_height * blocks_across + column / block_width) * LANES + row % block_height * block_width +
         column % block_width;
}

constexpr int run_length = 32;        // segments that one mask has bits for

inline int64_t runs_of(int64_t segments) { return (segments + run_length - 1) / run_length; }

inline Profile profile_of(const Strokes& s, int64_t id) { return {s.c[id], s.q[id], s.o[id]}; }

struct Run {                          // of segments
  bool near;                          // whether any may reach the tile
  uint32_t tight, round;              // bits: beside which another part may be as near; near which a pixel may be round
};

struct Coverage {                     // of one stroke over one tile
  Nearest near[tile_blocks];
  Bent bent[tile_blocks];             // of blocks that are `odd`
  uint32_t touched[block_rows];       // one bit per block; others are not initialised
  uint32_t odd[block_rows];
  Run* run;                           // (runs,)
  uint32_t* reaching;                 // (runs, tile_blocks): one bit per segment that may reach the block
};

// Finds the columns [left, right] in which the segment, widened by its reach, crosses the rows from top to bottom.
inline bool crossing(const Segment& s, float top, float bottom, float* left, float* right) {
  float from = 0, to = 1;
  if (s.wy != 0) {
    float a = (top - s.reach - s.uy) / s.wy, b = (bottom + s.reach - s.uy) / s.wy;
    from = larger(0.0f, smaller(a, b));
    to = smaller(1.0f, larger(a, b));
    if (from > to) return false;
  }
  float a = s.ux + from * s.wx, b = s.ux + to * s.wx;
  *left = smaller(a, b) - s.reach;
  *right = larger(a, b) + s.reach;
  return true;
}

inline Floats block_x(Tile tile, int block) {
  Floats x;
  for (int i = 0; i < LANES; ++i) x[i] = i % block_width;
  return x + (tile.x + block % blocks_across * block_width + 0.5f);
}

inline Floats block_y(Tile tile, int block) {
  Floats y;
  for (int i = 0; i < LANES; ++i) y[i] = i / block_width;
  return y + (tile.y + block / blocks_across * block_height + 0.5f);
}

// Centres of pixels of a tile.
inline Floats pixels_x(Tile tile, Ints pixel) {
  const Ints column = ((pixel >> lane_bits) & (blocks_across - 1)) * block_width + (pixel & (block_width - 1));
  return __builtin_convertvector(column + tile.x, Floats) + 0.5f;
}

inline Floats pixels_y(Tile tile, Ints pixel) {
  const Ints row = (pixel >> (lane_bits + across_bits)) * block_height + ((pixel & (LANES - 1)) >> width_bits);
  return __builtin_convertvector(row + tile.y, Floats) + 0.5f;
}

// Notes in which blocks a segment may leave a mark.
inline bool note_reached(uint32_t* reaching, uint32_t* touched, const Segment& s, uint32_t bit, Tile tile) {
  const float x0 = tile.x, x1 = tile.x + tile.width, y0 = tile.y, y1 = tile.y + tile.height;
  const float left = smaller(s.ux, s.ux + s.wx) - s.reach, right = larger(s.ux, s.ux + s.wx) + s.reach;
  const float top = smaller(s.uy, s.uy + s.wy) - s.reach, bottom = larger(s.uy, s.uy + s.wy) + s.reach;
  if (!(s.reach > 0 && left < x1 && right > x0 && top < y1 && bottom > y0)) return false;
  const int from = int(larger(top - y0, 0.0f)) / block_height;
  const int to = int(smaller(bottom - y0, tile.height - 0.5f)) / block_height;
  const bool narrow = __builtin_fabsf(s.wx) < 4 * block_width;      // its box is as tight as its outline
  for (int row = from; row <= to; ++row) {
    float a = left, b = right;
    const float y = y0 + row * block_height;
    if (!narrow && !crossing(s, y, y + block_height, &a, &b)) continue;
    const float low = larger(a - x0, 0.0f), high = smaller(b - x0, tile.width - 0.5f);
    if (!(low <= high)) continue;
    const int first = int(low) / block_width, last = int(high) / block_width;
    for (int column = first; column <= last; ++column) reaching[row * blocks_across + column] |= bit;
    touched[row] |= (2u << last) - (1u << first);
  }
  return true;
}

// Calls visit(k) for the segments of all runs that may reach a block and that bits_of_run(run) has a bit for.
template <class Bits, class Visit>
inline void each_reaching(const Coverage& cover, int64_t count, int block, Bits bits_of_run, Visit visit) {
  for (int64_t r = 0, runs = runs_of(count); r < runs; ++r) {
    const Run& run = cover.run[r];
    if (!run.near) continue;
    for (uint32_t bits = cover.reaching[r * tile_blocks + block] & bits_of_run(run); bits; bits &= bits - 1)
      visit(r * run_length + __builtin_ctz(bits));
  }
}

template <class Visit>   // for all that may reach it
inline void each_reaching(const Coverage& cover, int64_t count, int block, Visit visit) {
  each_reaching(cover, count, block, [](const Run&) { return ~0u; }, visit);
}

inline Nearest nearest_of(const Coverage& cover, const Segment* segments, int64_t count, int block, Floats x,
                          Floats y) {
  Choice choice;
  each_reaching(cover, count, block, [&](int64_t k) {
    const Offer here = offer_of(segments[k], foot_on(segments[k], x, y), int32_t(k));
    choice.take(here, here.touches);
  });
  return choice.part;
}

// Pixels that lie on the plateau altogether.
inline Ints on_plateau(const Nearest& near, const Profile& profile) {
  const Floats flat = profile.q * near.thickness - half_diagonal;
  return marks(near) & (flat >= all(0.0f)) & (near.squared <= flat * flat);
}

// Where a pixel is on the plateau, what else is near does not matter.
inline Second second_of(const Coverage& cover, const Nearest& near, const Segment* segments, const Shape* shapes,
                        int64_t count, int block, Floats x, Floats y, const Profile& profile) {
  const Ints tight = tight_pixels(near, shapes) & ~on_plateau(near, profile);
  if (!any(tight)) return {nothing_near(), Floats{}};
  SecondSearch search(near, tight, segments, shapes, x, y);
  each_reaching(cover, count, block, [&](int64_t k) { search.look_at(int32_t(k)); });
  return search.found();
}

inline void cover_block(Coverage& cover, const Strokes& strokes, int64_t id, Tile tile, int block) {
  const Segment* segments = strokes.segment + id * strokes.segments;
  const Shape* shapes = strokes.shape + id * strokes.segments;
  const int64_t count = strokes.segments;
  const Floats x = block_x(tile, block), y = block_y(tile, block);
  uint32_t tight = 0, round = 0;
  for (int64_t r = 0, runs = runs_of(count); r < runs; ++r) {
    if (!cover.run[r].near) continue;
    tight |= cover.reaching[r * tile_blocks + block] & cover.run[r].tight;
    round |= cover.reaching[r * tile_blocks + block] & cover.run[r].round;
  }
  Nearest& near = cover.near[block];
  Bent& bent = cover.bent[block];
  near = nearest_of(cover, segments, count, block, x, y);
  bool cuts = false;
  if (tight) {
    const Second second = second_of(cover, near, segments, shapes, count, block, x, y, profile_of(strokes, id));
    cuts = cut(bent, near, second.part, second.turn);
  }
  const auto round_off_here = [&](Floats& rounded, Ints& ends, Nearest& its) {
    return round && round_off(rounded, ends, its, segments, shapes, count, x, y, [&](auto visit) {
             each_reaching(cover, count, block, [](const Run& run) { return run.round; }, visit);
           });
  };
  const bool odd = round_off_here(bent.rounded, bent.ends, near);
  if (!cuts && !odd) return;
  cover.odd[block / blocks_across] |= 1u << block % blocks_across;
  if (!odd) bent.rounded = Floats{}, bent.ends = Ints{};
  if (!cuts)
    bent.share = bent.slant = Floats{};
  else if (!round_off_here(bent.second_rounded, bent.second_ends, bent.second))
    bent.second_rounded = Floats{}, bent.second_ends = Ints{};
}

void cover_stroke(Coverage& cover, const Strokes& strokes, int64_t id, Tile tile) {
  const Segment* segments = strokes.segment + id * strokes.segments;
  const Shape* shapes = strokes.shape + id * strokes.segments;
  std::memset(cover.touched, 0, sizeof cover.touched);
  std::memset(cover.odd, 0, sizeof cover.odd);
  for (int64_t r = 0, runs = runs_of(strokes.segments); r < runs; ++r) {
    uint32_t* reaching = cover.reaching + r * tile_blocks;
    const int64_t first = r * run_length;
    const int64_t last = strokes.segments < first + run_length ? strokes.segments : first + run_length;
    std::memset(reaching, 0, sizeof(uint32_t) * tile_blocks);
    Run& here = cover.run[r] = {};
    for (int64_t k = first; k < last; ++k) {
      const uint32_t bit = 1u << (k - first);
      if (!note_reached(reaching, cover.touched, segments[k], bit, tile)) continue;
      here.near = true;
      if (shapes[k].tight_from < segments[k].reach) here.tight |= bit;
      if (shapes[k].may_round) here.round |= bit;
    }
  }
  for (int row = 0; row < block_rows; ++row)
    for (uint32_t bits = cover.touched[row]; bits; bits &= bits - 1)
      cover_block(cover, strokes, id, tile, row * blocks_across + __builtin_ctz(bits));
}

template <class Visit>   // visit(block) for each block that the stroke reaches
inline void each_block(const Coverage& cover, Visit visit) {
  for (int row = 0; row < block_rows; ++row)
    for (uint32_t bits = cover.touched[row]; bits; bits &= bits - 1) {
      const int block = row * blocks_across + __builtin_ctz(bits);
      if (any(marks(cover.near[block]))) visit(block);
    }
}

inline bool is_odd(const Coverage& cover, int block) {
  return cover.odd[block / blocks_across] >> block % blocks_across & 1;
}

}  // namespace
}  // namespace maulstick
