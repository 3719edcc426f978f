// Which part of a stroke is nearest to each cell: to the pixels of a tile, or to the cells of one pixel that is cut up.
//
// The maximum of darkness over segments (docs/equations.md) is the minimum of distance / thickness.
#pragma once
#include "average.hpp"
#include "tiles.hpp"

namespace maulstick {
namespace {

constexpr int tile_pixels = tile_height * tile_width;
constexpr int tile_blocks = tile_pixels / LANES;
constexpr float cut_near = 1.25f, cut_fade = 0.25f;       // as in reference.py: _NEAR, _FADE ...
constexpr float sharp_turn = 0.4f, crease_near = 0.6f;
constexpr float no_mark = 1e30f;                          // square of a cell that no segment reaches
constexpr int32_t creased_bit = 1 << 30;                  // of an owner

// The nearest segment to each of LANES cells.
struct Nearest {
  Floats square;                      // (distance / thickness)^2
  Floats offset_x, offset_y;          // from its nearest point to the cell's middle
  Floats thickness;
  Ints owner;                         // index of the segment, and the creased bit
};

inline Nearest nothing_near() { return {all(no_mark), all(0.0f), all(0.0f), all(1.0f), all(0)}; }

struct Foot { Floats free, t, offset_x, offset_y; };   // t: `free` clamped to [0, 1]

inline Foot foot_on(const Segment& s, Floats x, Floats y) {
  const Floats dx = x - s.ux, dy = y - s.uy;
  const Floats free = (dx * s.wx + dy * s.wy) * s.inverse_squared_length;
  const Floats t = smaller(larger(free, all(0.0f)), all(1.0f));
  return {free, t, dx - t * s.wx, dy - t * s.wy};
}

// Takes segment k where it is nearer to the cells around (x, y). first, last: whether it is the stroke's. turned: that
// of the nearest segments; unless it is null, cells are marked in which two parts of the stroke may meet in a crease.
inline void take_nearer(Nearest& near, const Segment& s, int32_t k, bool first, bool last, Floats x, Floats y,
                        Floats side, Floats* turned) {
  const Foot foot = foot_on(s, x, y);
  Floats offset_x = foot.offset_x, offset_y = foot.offset_y;
  const Floats thickness = s.thickness + foot.t * s.growth, reach = thickness + half_diagonal * side;
  const Floats squared = offset_x * offset_x + offset_y * offset_y, width = thickness * thickness;
  const Floats square = (thickness > all(0.0f)) & (squared < reach * reach) ? squared / width : all(no_mark);
  if (first || last) {                                     // around an end the mark's edge is an arc
    Ints beyond = all(0);
    if (first) beyond |= foot.free <= all(0.0f);
    if (last) beyond |= foot.free >= all(1.0f);
    const Floats far = root(larger(squared, all(1e-12f)));
    const Floats bent = 1.0f + side * side / 24 / (far * larger(far, 0.25f * side));
    offset_x = beyond ? offset_x * bent : offset_x;
    offset_y = beyond ? offset_y * bent : offset_y;
  }
  const Ints nearer = square < near.square;
  if (turned) {
    const Floats gap = (square - near.square) * width, ex = offset_x - near.offset_x, ey = offset_y - near.offset_y;
    const Ints creased = (larger(square, near.square) < all(no_mark)) &
                         (gap * gap < 4 * crease_near * crease_near * (ex * ex + ey * ey)) &
                         (absolute(s.turned - *turned) > all(crease_turn));
    near.owner |= creased & creased_bit;
    *turned = nearer ? all(s.turned) : *turned;
  }
  near.square = nearer ? square : near.square;
  near.offset_x = nearer ? offset_x : near.offset_x;
  near.offset_y = nearer ? offset_y : near.offset_y;
  near.thickness = nearer ? thickness : near.thickness;
  near.owner = nearer ? (near.owner & creased_bit) | k : near.owner;
}

// A block of pixels is 4 wide, and the blocks of a tile lie in it row by row; so strokes fill blocks better than they
// would fill rows of LANES pixels. Pixels are numbered block by block.
constexpr int block_width = 4, block_height = LANES / block_width, blocks_across = tile_width / block_width;
constexpr int block_rows = tile_height / block_height;

inline int column_of(int at) { return at / LANES % blocks_across * block_width + at % block_width; }
inline int row_of(int at) { return at / LANES / blocks_across * block_height + at % LANES / block_width; }
inline int pixel_at(int row, int column) {
  return (row / block_height * blocks_across + column / block_width) * LANES + row % block_height * block_width +
         column % block_width;
}

constexpr int run = 32;               // segments that one mask has bits for

inline int64_t runs_of(int64_t segments) { return (segments + run - 1) / run; }

struct Coverage {                     // of one stroke over one tile
  Nearest near[tile_blocks];
  uint32_t touched[block_rows];       // one bit per block; others are not initialised
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

// Takes the segments of all runs that may reach a block where they are nearer to the cells around (x, y).
template <bool Creases>
inline Nearest nearest_of(const uint32_t* reaching, const uint8_t* comes_near, const Segment* segments, int64_t count,
                          int block, Floats x, Floats y, Floats side) {
  Nearest near = nothing_near();
  Floats turned{};
  for (int64_t r = 0, runs = runs_of(count); r < runs; ++r) {
    if (!comes_near[r]) continue;
    for (uint32_t bits = reaching[r * tile_blocks + block]; bits; bits &= bits - 1) {
      const int64_t k = r * run + __builtin_ctz(bits);
      take_nearer(near, segments[k], int32_t(k), k == 0, k == count - 1, x, y, side, Creases ? &turned : nullptr);
    }
  }
  return near;
}

void cover_stroke(Coverage& cover, const Strokes& strokes, int64_t id, Tile tile) {
  const Segment* segments = strokes.segment + id * strokes.segments;
  std::memset(cover.touched, 0, sizeof cover.touched);
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
    for (uint32_t bits = cover.touched[row]; bits; bits &= bits - 1) {
      const int block = row * blocks_across + __builtin_ctz(bits);
      const Floats x = block_x(tile, block), y = block_y(tile, block);
      cover.near[block] = strokes.may_crease[id] ? nearest_of<true>(cover.reaching, cover.comes_near, segments,
                                                                    strokes.segments, block, x, y, all(1.0f))
                                                 : nearest_of<false>(cover.reaching, cover.comes_near, segments,
                                                                     strokes.segments, block, x, y, all(1.0f));
    }
}

template <class Visit>   // visit(block) for each block that the stroke reaches
inline void each_block(const Coverage& cover, Visit visit) {
  for (int row = 0; row < block_rows; ++row)
    for (uint32_t bits = cover.touched[row]; bits; bits &= bits - 1) {
      const int block = row * blocks_across + __builtin_ctz(bits);
      if (any(cover.near[block].square < all(no_mark))) visit(block);
    }
}

// Pixels that lie on the plateau altogether.
inline Ints on_plateau(const Nearest& near, const Profile& profile) {
  const Floats flat = profile.q * near.thickness - half_diagonal;
  return (flat >= all(0.0f)) & (near.offset_x * near.offset_x + near.offset_y * near.offset_y <= flat * flat) &
         (near.square < all(no_mark));
}

// Pixels of a tile that are cut up into cells, since they do not lie along a straight stroke.
constexpr int cells_at_end = 4, cells_at_crease = 2;      // per side of a pixel

struct Cut {
  int16_t at;
  int16_t cells;                      // per side
  float share;                        // of the pixel's darkness that its cells say
};

struct Cuts {
  int32_t count;
  Cut cut[2 * tile_pixels];
  float share[tile_pixels];           // of each pixel; 0 but while `count` is above 0
};

inline void add_cut(Cuts& cuts, const Coverage& cover, const Profile& profile, int at, int cells, float share) {
  const Nearest& near = cover.near[at / LANES];
  if (!(near.square[at % LANES] < no_mark) || on_plateau(near, profile)[at % LANES]) return;
  const float before = cuts.share[at];
  cuts.cut[cuts.count++] = {int16_t(at), int16_t(cells), (1 - before) * share};
  cuts.share[at] = before + (1 - before) * share;
}

inline void cut_around(Cuts& cuts, const Coverage& cover, const Profile& profile, Tile tile, float x, float y) {
  const float left = x - cut_near - tile.x, right = x + cut_near - tile.x;
  const float top = y - cut_near - tile.y, bottom = y + cut_near - tile.y;
  if (!(left < tile.width && right > 0 && top < tile.height && bottom > 0)) return;
  for (int row = int(larger(top, 0.0f)); row < tile.height && row < bottom; ++row)
    for (int column = int(larger(left, 0.0f)); column < tile.width && column < right; ++column) {
      if (!(cover.touched[row / block_height] >> (column / block_width) & 1)) continue;
      const float dx = tile.x + column + 0.5f - x, dy = tile.y + row + 0.5f - y;
      const float share = (cut_near - __builtin_sqrtf(dx * dx + dy * dy)) / cut_fade;
      if (share > 0 && cuts.share[pixel_at(row, column)] < 1)
        add_cut(cuts, cover, profile, pixel_at(row, column), cells_at_end, smaller(share, 1.0f));
    }
}

// Finds the pixels that are cut up: around ends and sharp corners, and along creases.
void find_cuts(Cuts& cuts, const Coverage& cover, const Strokes& strokes, int64_t id, const Profile& profile,
               Tile tile) {
  const Segment* segments = strokes.segment + id * strokes.segments;
  const int64_t last = strokes.segments - 1;
  cut_around(cuts, cover, profile, tile, segments[0].ux, segments[0].uy);
  for (int64_t k = 1; k <= last; ++k)
    if (segments[k].turned - segments[k - 1].turned > sharp_turn)
      cut_around(cuts, cover, profile, tile, segments[k].ux, segments[k].uy);
  cut_around(cuts, cover, profile, tile, segments[last].ux + segments[last].wx, segments[last].uy + segments[last].wy);
  if (!strokes.may_crease[id]) return;
  each_block(cover, [&](int block) {
    const Ints creased = (cover.near[block].owner & creased_bit) != all(0);
    if (any(creased))
      for (int lane = 0; lane < LANES; ++lane)
        if (creased[lane] && cuts.share[block * LANES + lane] < 1)
          add_cut(cuts, cover, profile, block * LANES + lane, cells_at_crease, 1);
  });
}

}  // namespace
}  // namespace maulstick
