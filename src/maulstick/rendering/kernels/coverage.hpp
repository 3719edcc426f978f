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

inline int pixel_at(int row, int column) {
  return (row / block_height * blocks_across + column / block_width) * LANES + row % block_height * block_width +
         column % block_width;
}

constexpr int run = 32;               // segments that one mask has bits for

inline int64_t runs_of(int64_t segments) { return (segments + run - 1) / run; }

struct Coverage {                     // of one stroke over one tile
  Nearest near[tile_blocks];
  Bent bent[tile_blocks];             // of blocks that are `odd`
  uint32_t touched[block_rows];       // one bit per block; others are not initialised
  uint32_t odd[block_rows];
  // Of each run of segments that comes near the tile, and of each block: one bit per segment that may reach it.
  uint32_t* reaching;                 // (runs, tile_blocks)
  uint8_t* comes_near;                // (runs,)
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

// Calls visit(k) for the segments of all runs that may reach a block.
template <class Visit>
inline void each_reaching(const Coverage& cover, int64_t count, int block, Visit visit) {
  for (int64_t r = 0, runs = runs_of(count); r < runs; ++r) {
    if (!cover.comes_near[r]) continue;
    for (uint32_t bits = cover.reaching[r * tile_blocks + block]; bits; bits &= bits - 1)
      visit(r * run + __builtin_ctz(bits));
  }
}

inline Nearest nearest_of(const Coverage& cover, const Segment* segments, int64_t count, int block, Floats x, Floats y,
                          Seen& seen) {
  Nearest near = nothing_near();
  each_reaching(cover, count, block, [&](int64_t k) {
    const Nearest here = nearest_on(segments[k], foot_on(segments[k], x, y), int32_t(k));
    if (seen.count < Seen::most) {
      seen.segment[seen.count] = int32_t(k), seen.squared[seen.count] = here.squared;
      seen.thickness[seen.count] = here.thickness;
    }
    ++seen.count;
    near = chosen(nearer(here, near), here, near);
  });
  return near;
}

// Finds the parts that may meet the nearest ones; returns whether there are any.
inline bool find_second(Second& second, const Seen& seen, const Coverage& cover, const Nearest& near,
                        const Segment* segments, const Shape* shapes, int64_t count, int block, Floats x, Floats y) {
  const Ints tight = tight_pixels(near, shapes);
  if (!any(tight)) return false;
  if (seen.count > Seen::most) {
    SecondSearch search(near, tight, segments, shapes, x, y);
    each_reaching(cover, count, block, [&](int64_t k) { search.look_at(int32_t(k)); });
    second = search.found();
    return true;
  }
  int32_t chosen[Seen::most];
  const int found = choose_seconds(chosen, seen, near, tight, shapes);
  if (found == 0) return false;
  SecondSearch search(near, tight, segments, shapes, x, y);
  for (int i = 0; i < found; ++i) search.look_at(chosen[i]);
  second = search.found();
  return true;
}

inline void cover_block(Coverage& cover, const Strokes& strokes, int64_t id, Tile tile, int block) {
  const Segment* segments = strokes.segment + id * strokes.segments;
  const Shape* shapes = strokes.shape + id * strokes.segments;
  const int64_t count = strokes.segments;
  const Floats x = block_x(tile, block), y = block_y(tile, block);
  Nearest& near = cover.near[block];
  Bent& bent = cover.bent[block];
  Seen seen;
  near = nearest_of(cover, segments, count, block, x, y, seen);
  Second second;
  const bool cuts = find_second(second, seen, cover, near, segments, shapes, count, block, x, y) &&
                    cut(bent, near, second.part, second.turn);
  bool odd = round_off(bent.rounded, bent.ends, near, segments, shapes, count, x, y);
  if (cuts)
    round_off(bent.second_rounded, bent.second_ends, bent.second, segments, shapes, count, x, y);
  else if (odd)
    bent.share = bent.slant = Floats{};
  if (cuts || odd) cover.odd[block / blocks_across] |= 1u << block % blocks_across;
}

void cover_stroke(Coverage& cover, const Strokes& strokes, int64_t id, Tile tile) {
  const Segment* segments = strokes.segment + id * strokes.segments;
  std::memset(cover.touched, 0, sizeof cover.touched);
  std::memset(cover.odd, 0, sizeof cover.odd);
  for (int64_t r = 0, runs = runs_of(strokes.segments); r < runs; ++r) {
    uint32_t* reaching = cover.reaching + r * tile_blocks;
    const int64_t first = r * run, last = strokes.segments < first + run ? strokes.segments : first + run;
    std::memset(reaching, 0, sizeof(uint32_t) * tile_blocks);
    bool near = false;
    for (int64_t k = first; k < last; ++k)
      near |= note_reached(reaching, cover.touched, segments[k], 1u << (k - first), tile);
    cover.comes_near[r] = near;
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

// Pixels that lie on the plateau altogether.
inline Ints on_plateau(const Nearest& near, const Profile& profile) {
  const Floats flat = profile.q * near.thickness - half_diagonal;
  return marks(near) & (flat >= all(0.0f)) & (near.squared <= flat * flat);
}

}  // namespace
}  // namespace maulstick
