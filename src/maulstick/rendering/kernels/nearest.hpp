// The nearest part of a stroke to pixels, and another one that may meet it in a crease (nearest.py).
#pragma once
#include "average.hpp"
#include "tiles.hpp"

namespace maulstick {
namespace {

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

inline Floats clamped(Floats x) { return smaller(larger(x, all(0.0f)), all(1.0f)); }

struct Foot { Floats free, t, offset_x, offset_y; };   // t: `free` clamped to [0, 1]

inline Foot foot_on(const Segment& s, Floats x, Floats y) {
  const Floats dx = x - s.ux, dy = y - s.uy;
  const Floats free = (dx * s.wx + dy * s.wy) * s.inverse_squared_length;
  const Floats t = smaller(larger(free, all(0.0f)), all(1.0f));
  return {free, t, dx - t * s.wx, dy - t * s.wy};
}

// What a segment k offers to LANES pixels.
struct Offer {
  Nearest part;
  Floats thickness_squared;
  Ints touches;                       // pixels that its mark reaches
};

inline Offer offer_of(const Segment& s, const Foot& foot, int32_t k) {
  const Floats thickness = s.thickness + foot.t * s.growth, reach = thickness + half_diagonal;
  const Floats squared = foot.offset_x * foot.offset_x + foot.offset_y * foot.offset_y;
  return {{squared, foot.offset_x, foot.offset_y, thickness, all(k)}, thickness * thickness,
          (thickness > all(thinnest)) & (squared < reach * reach)};
}

// The nearest of all parts that were offered, by distance / thickness.
struct Choice {
  Nearest part = nothing_near();
  Floats thickness_squared = all(1.0f);

  // Takes the offer for those pixels of `wanted` to which it is nearer, and returns them.
  Ints take(const Offer& offer, Ints wanted) {
    const Nearest& its = offer.part;
    const Ints takes = wanted & (its.squared * thickness_squared < part.squared * offer.thickness_squared);
    part = {takes ? its.squared : part.squared, takes ? its.offset_x : part.offset_x,
            takes ? its.offset_y : part.offset_y, takes ? its.thickness : part.thickness,
            takes ? its.owner : part.owner};
    thickness_squared = takes ? offer.thickness_squared : thickness_squared;
    return takes;
  }
};

// Calls visit(k, lanes) for each segment k that owns some of these lanes.
template <class Visit>
inline void each_owner(Ints owner, Ints lanes, Visit visit) {
  int32_t owners[LANES];
  store(owners, owner);
  for (uint32_t pending = bits_of(lanes); pending;) {
    const int32_t k = owners[__builtin_ctz(pending)];
    const Ints mine = lanes & (owner == all(k));
    pending &= ~bits_of(mine);
    visit(k, mine);
  }
}

// By how much a stroke has turned up to a point of a segment, and from it on (nearest.py, Nearest).
struct Turned { Floats from, to; };

inline Turned turned_at(const Shape& p, Floats free) {
  const Floats start = clamped(2 * p.length * free), end = clamped(2 * p.length * (1.0f - free));
  return {p.turned_before + (p.turned - p.turned_before) * start, p.turned_after + (p.turned - p.turned_after) * end};
}

// A part of a stroke that may meet the nearest one in a crease.
struct Second {
  Nearest part;
  Floats turn;                        // between the two
};

// Finds the nearest part to each pixel of those that go elsewhere than the nearest one, where that is tight.
class SecondSearch {
 public:
  SecondSearch(const Nearest& near, Ints tight, const Segment* segments, const Shape* shapes, Floats x, Floats y)
      : segments_(segments), shapes_(shapes), x_(x), y_(y), ratio_(root(near.squared) / near.thickness),
        half_pixel_(0.5f / near.thickness), furthest_(ratio_ + half_pixel_ * most_of_turn), tight_(tight),
        turned_{}, least_(1e30f), most_(-1e30f), turn_{} {
    each_owner(near.owner, tight, [&](int32_t k, Ints mine) {
      const Turned here = turned_at(shapes[k], foot_on(segments[k], x, y).free);
      turned_ = {mine ? here.from : turned_.from, mine ? here.to : turned_.to};
      least_ = smaller(least_, shapes[k].turned_before), most_ = larger(most_, shapes[k].turned_after);
    });
  }

  void look_at(int32_t k) {
    const Shape& p = shapes_[k];
    if (!(p.turned_after - least_ > sharp_turn || most_ - p.turned_before > sharp_turn)) return;
    const Foot foot = foot_on(segments_[k], x_, y_);
    const Offer here = offer_of(segments_[k], foot, k);
    const Floats most = furthest_ * here.part.thickness;
    const Ints close = here.touches & tight_ & (here.part.squared < most * most);
    if (!any(close)) return;
    const Turned turned = turned_at(p, foot.free);
    const Floats turn = larger(turned.from - turned_.to, turned_.from - turned.to);
    const Floats reach = (ratio_ + half_pixel_ * smaller(turn, all(2.0f))) * here.part.thickness;
    const Ints meets = close & (turn > all(sharp_turn)) & (here.part.squared < reach * reach);
    turn_ = choice_.take(here, meets) ? turn : turn_;
  }

  Second found() const { return {choice_.part, turn_}; }

 private:
  const Segment* segments_;
  const Shape* shapes_;
  Floats x_, y_, ratio_, half_pixel_; // of the nearest: distance, and half a pixel, over thickness
  static constexpr float most_of_turn = 2.001f;   // that counts in `reach`, and some more for rounding
  Floats furthest_;                   // what else meets it is no further off, over thickness
  Ints tight_;
  Turned turned_;                     // at the nearest points
  float least_, most_;                // turned, around the segments that own them
  Choice choice_;                     // among parts that meet the nearest one within the pixel
  Floats turn_;
};

// Pixels in which another part may be as near.
inline Ints tight_pixels(const Nearest& near, const Shape* shapes) {
  Floats from;
  for (int i = 0; i < LANES; ++i) from[i] = shapes[near.owner[i]].tight_from;
  from = larger(from, all(0.0f));
  return marks(near) & (near.squared >= from * from);
}

// Of a block of pixels in some of which a stroke is not straight.
struct Bent {
  Nearest second;
  Floats slant, share;                // cosine between the way across the crease and to the stroke; of the second part
  Floats rounded, second_rounded;     // share of each part that lies around a point
  Ints ends, second_ends;             // bits: 1 while that share grows with the stroke's start, 2 with its end
};


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
// which they lie where that is further off; returns whether any pixel has such a share. count: number of the stroke's
// segments. each_round: calls a function of k for each of them that may be round, if it reaches the pixels.
template <class EachRound>
inline bool round_off(Floats& rounded, Ints& ends, Nearest& near, const Segment* segments, const Shape* shapes,
                      int64_t count, Floats x, Floats y, EachRound each_round) {
  rounded = Floats{}, ends = Ints{};
  const Ints marked = marks(near);
  each_round([&](int64_t k) {
    const Ints mine = marked & (near.owner == all(int32_t(k)));
    if (!any(mine)) return;
    const Shape& p = shapes[k];
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
  });
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

}  // namespace
}  // namespace maulstick
