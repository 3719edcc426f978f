// Which parts of a stroke are nearest to each pixel of a tile (nearest.py, two_nearest).
//
// The maximum of darkness over segments (docs/equations.md) is the minimum of distance / thickness.
#pragma once
#include "average.hpp"
#include "tiles.hpp"

namespace maulstick {
namespace {

constexpr int tile_pixels = tile_height * tile_width;
constexpr int tile_blocks = tile_pixels / LANES;
constexpr float no_mark = 1e30f;      // square of the distance of a pixel that no segment reaches

// The nearest segment to each of LANES pixels.
struct Nearest {
  Floats squared;                     // of the distance
  Floats offset_x, offset_y;          // from its nearest point to the pixel's centre
  Floats thickness;
  Ints owner;                         // index of the segment
};

inline Nearest nothing_near() { return {all(no_mark), all(0.0f), all(0.0f), all(1.0f), all(0)}; }

inline Ints marks(const Nearest& near) { return near.squared < all(no_mark); }

inline Nearest chosen(Ints mask, const Nearest& a, const Nearest& b) {
  return {mask ? a.squared : b.squared, mask ? a.offset_x : b.offset_x, mask ? a.offset_y : b.offset_y,
          mask ? a.thickness : b.thickness, mask ? a.owner : b.owner};
}

inline Ints nearer(const Nearest& a, const Nearest& b) {   // by distance / thickness
  return a.squared * (b.thickness * b.thickness) < b.squared * (a.thickness * a.thickness);
}

struct Foot { Floats free, t, offset_x, offset_y; };   // t: `free` clamped to [0, 1]

inline Foot foot_on(const Segment& s, Floats x, Floats y) {
  const Floats dx = x - s.ux, dy = y - s.uy;
  const Floats free = (dx * s.wx + dy * s.wy) * s.inverse_squared_length;
  const Floats t = smaller(larger(free, all(0.0f)), all(1.0f));
  return {free, t, dx - t * s.wx, dy - t * s.wy};
}

inline Nearest nearest_on(const Segment& s, const Foot& foot, int32_t k) {
  const Floats thickness = s.thickness + foot.t * s.growth, reach = thickness + half_diagonal;
  const Floats squared = foot.offset_x * foot.offset_x + foot.offset_y * foot.offset_y;
  const Ints touches = (thickness > all(0.0f)) & (squared < reach * reach);
  return {touches ? squared : all(no_mark), foot.offset_x, foot.offset_y, touches ? thickness : all(1.0f), all(k)};
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

// Of a block of pixels in some of which a stroke is not straight.
struct Bent {
  Nearest second;
  Floats slant, share;                // cosine between the way across the crease and to the stroke; of the second part
  Floats rounded, second_rounded;     // share of each part that lies around a point
  Ints ends, second_ends;             // bits: 1 while that share grows with the stroke's start, 2 with its end
};

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

// Segments that reach a block, while there is room for them, and how near they are to its pixels.
struct Seen {
  static constexpr int most = 64;
  int count = 0;
  int32_t segment[most];
  Floats squared[most], thickness[most];
};

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

// A part of a stroke that may meet the nearest one in a crease.
struct Second {
  Nearest part;
  Floats turn;                        // between the two
};

// Whether a part is so near beside the nearest one that they meet within the pixel. inverse: of the nearest thickness.
inline Ints within(Floats squared, Floats thickness, Floats distance, Floats inverse, Floats turn) {
  const Floats reach = (distance + 0.5f * smaller(turn, all(2.0f))) * inverse * thickness;
  return squared < reach * reach;
}

// Finds the nearest part to each pixel of those that go elsewhere than the nearest one, where that is tight.
class SecondSearch {
 public:
  SecondSearch(const Nearest& near, Ints tight, const Segment* segments, const Shape* shapes, Floats x, Floats y)
      : segments_(segments), shapes_(shapes), x_(x), y_(y), distance_(root(near.squared)),
        inverse_(1.0f / near.thickness), tight_(tight), second_{nothing_near(), {}} {
    for (int lane = 0; lane < LANES; ++lane) {
      const Segment& s = segments[near.owner[lane]];
      const Shape& p = shapes[near.owner[lane]];
      const float free = ((x[lane] - s.ux) * s.wx + (y[lane] - s.uy) * s.wy) * s.inverse_squared_length;
      from_[lane] = free <= 0 ? p.turned_before : p.turned;
      to_[lane] = free >= 1 ? p.turned_after : p.turned;
    }
  }

  void look_at(int32_t k) {
    const Shape& p = shapes_[k];
    const Foot foot = foot_on(segments_[k], x_, y_);
    const Nearest here = nearest_on(segments_[k], foot, k);
    const Floats from = foot.free <= all(0.0f) ? all(p.turned_before) : all(p.turned);
    const Floats to = foot.free >= all(1.0f) ? all(p.turned_after) : all(p.turned);
    const Floats turn = larger(from - to_, from_ - to);
    const Ints meets = tight_ & (turn > all(sharp_turn)) & within(here.squared, here.thickness, distance_, inverse_, turn);
    const Ints takes = meets & nearer(here, second_.part);
    second_ = {chosen(takes, here, second_.part), takes ? turn : second_.turn};
  }

  const Second& found() const { return second_; }

 private:
  const Segment* segments_;
  const Shape* shapes_;
  Floats x_, y_, distance_, inverse_; // inverse_: of the nearest thickness
  Floats from_, to_;                  // turned up to the nearest points, and from them on
  Ints tight_;
  Second second_;
};

// Pixels in which another part may be as near.
inline Ints tight_pixels(const Nearest& near, const Shape* shapes) {
  Floats from;
  for (int lane = 0; lane < LANES; ++lane) from[lane] = larger(shapes[near.owner[lane]].tight_from, 0.0f);
  return marks(near) & (near.squared >= from * from);
}

// Chooses those that may be as near, and turned, as a crease demands; returns their number.
inline int choose_seconds(int32_t* chosen, const Seen& seen, const Nearest& near, Ints tight, const Shape* shapes) {
  const Floats distance = root(near.squared), inverse = 1.0f / near.thickness;
  Floats before, after;
  for (int lane = 0; lane < LANES; ++lane) {
    const Shape& p = shapes[near.owner[lane]];
    before[lane] = p.turned_before, after[lane] = p.turned_after;
  }
  int count = 0;
  for (int i = 0; i < seen.count; ++i) {
    const Shape& p = shapes[seen.segment[i]];
    const Floats turn = larger(p.turned_after - before, after - p.turned_before);    // at most
    if (any(tight & (turn > all(sharp_turn)) & within(seen.squared[i], seen.thickness[i], distance, inverse, turn)))
      chosen[count++] = seen.segment[i];
  }
  return count;
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

inline Floats clamped(Floats x) { return smaller(larger(x, all(0.0f)), all(1.0f)); }

// Finds how the crease between two parts cuts the pixels; returns whether it cuts any.
inline bool cut(Bent& bent, const Nearest& near, const Nearest& second, Floats turn) {
  const Ints both = marks(near) & marks(second);
  if (!any(both)) return false;
  const Floats distance = root(near.squared), further = root(second.squared);
  const Floats unit = 1.0f / (distance > all(0.0f) ? distance : all(1.0f));
  const Floats unit_second = 1.0f / (further > all(0.0f) ? further : all(1.0f));
  const Floats x = near.offset_x * unit - second.offset_x * unit_second;
  const Floats y = near.offset_y * unit - second.offset_y * unit_second;
  const Floats rate = root(x * x + y * y), gap = further / second.thickness * near.thickness - distance;
  const Ints meets = both & (rate > all(0.0f));
  const Floats opens = meets ? smaller(rate, turn) : all(1.0f);   // side by side they part no faster than they turn
  const Floats share = smaller(larger(0.5f - gap / opens, all(0.0f)), all(0.5f));
  bent.share = meets ? share * clamped((turn - sharp_turn) * (1 / turn_fade)) : all(0.0f);
  bent.slant = 0.5f * rate;
  bent.second = second;
  return any(bent.share > all(0.0f));
}

inline Floats share_beyond(Floats pixels) { return clamped(0.5f - pixels); }

// Finds the share of LANES pixels that lies around an end or a corner (nearest.py, _nearest_on), or bends the edge by
// which they lie where that is further off; returns whether any pixel has such a share. count: number of the stroke's segments.
inline bool round_off(Floats& rounded, Ints& ends, Nearest& near, const Segment* segments, const Shape* shapes,
                      int64_t count, Floats x, Floats y) {
  rounded = Floats{}, ends = Ints{};
  bool may = false;
  for (int lane = 0; lane < LANES; ++lane) may |= shapes[near.owner[lane]].may_round;
  if (!may) return false;
  Ints pending = marks(near);
  for (int lane = 0; lane < LANES; ++lane) {
    if (!pending[lane]) continue;
    const int32_t k = near.owner[lane];
    const Ints mine = pending & (near.owner == all(k));
    pending &= ~mine;
    const Shape& p = shapes[k];
    if (!p.may_round) continue;
    const Segment& s = segments[k];
    const Floats since = (x - s.ux) * p.direction_x + (y - s.uy) * p.direction_y, until = p.length - since;
    const Floats start = share_beyond(k == 0 ? since : p.before + larger(since, all(0.0f)));
    const Floats end = share_beyond(k == count - 1 ? until : p.after + larger(until, all(0.0f)));
    Floats share = start + end, wedge{};
    if (p.sharp_start > 0) {
      const Shape& other = shapes[k - 1];
      const Floats theirs = (s.ux - x) * other.direction_x + (s.uy - y) * other.direction_y;
      wedge = p.sharp_start * larger(share_beyond(since) + share_beyond(theirs) - 1.0f, all(0.0f));
    }
    if (p.sharp_end > 0) {
      const Shape& other = shapes[k + 1];
      const Floats theirs = (x - s.ux - s.wx) * other.direction_x + (y - s.uy - s.wy) * other.direction_y;
      wedge = larger(wedge, p.sharp_end * larger(share_beyond(until) + share_beyond(theirs) - 1.0f, all(0.0f)));
    }
    const Ints grows = mine & (share <= all(1.0f)) & (share >= wedge);
    ends |= grows & (((start > all(0.0f)) & (start < all(1.0f)) & 1) | ((end > all(0.0f)) & (end < all(1.0f)) & 2));
    rounded = mine ? smaller(larger(share, wedge), all(1.0f)) : rounded;
  }
  if (!any(rounded > all(0.0f))) return false;
  const Ints far = near.squared >= all(close_by * close_by);
  if (any(far)) {
    const Floats fall = fall_around(near.squared), square = far ? near.squared : all(1.0f);
    const Floats bend = far ? 1.0f + rounded * (root((square + bulge_around(fall)) / square) - 1.0f) : all(1.0f);
    near.offset_x *= bend, near.offset_y *= bend;
    rounded = far ? all(0.0f) : rounded;
    ends &= ~far;
  }
  return any(rounded > all(0.0f));
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
