// How far from each segment of a stroke another part of it may be as near (nearest.py, _free_radius).
#pragma once
#include "lanes.hpp"
#include "tiles.hpp"

namespace maulstick {
namespace {

int64_t places_floats(int64_t segments) { return 4 * (2 * segments + 1 + LANES); }

void find_tight(const Segment* segments, Shape* shapes, int64_t count, float* places) {
  constexpr float nowhere = 1e15f;
  for (int64_t k = 0; k < count; ++k) shapes[k].tight_from = nowhere;
  if (shapes[count - 1].turned <= sharp_turn) return;
  const int64_t room = places_floats(count) / 4;
  float *xs = places, *ys = xs + room, *least = ys + room, *most = least + room;   // turned before, and from there on
  int64_t n = 0;
  bool any_long = false;
  const auto add = [&](float x, float y, float before, float after) {
    xs[n] = x, ys[n] = y, least[n] = before, most[n++] = after;
  };
  for (int64_t k = 0; k < count; ++k) {
    const Segment& s = segments[k];
    add(s.ux, s.uy, shapes[k].turned_before, shapes[k].turned);
    if (shapes[k].length > 1) add(s.ux + s.wx / 2, s.uy + s.wy / 2, shapes[k].turned, shapes[k].turned);
    any_long |= shapes[k].length > long_segment;
  }
  const Segment& end = segments[count - 1];
  add(end.ux + end.wx, end.uy + end.wy, shapes[count - 1].turned, shapes[count - 1].turned);
  while (n % LANES) add(nowhere, nowhere, 0, 0);
  for (int64_t k = 0; k < count; ++k) {
    const Segment& s = segments[k];
    Shape& p = shapes[k];
    Floats radius = all(nowhere);
    for (int64_t i = 0; i < n; i += LANES) {
      const Floats x = load(xs + i) - s.ux, y = load(ys + i) - s.uy;
      const Floats along = x * p.direction_x + y * p.direction_y, across = absolute(x * p.direction_y - y * p.direction_x);
      const Floats beside = along - smaller(larger(along, all(0.0f)), all(p.length));
      const Ints turns = (p.turned - load(least + i) > all(sharp_turn)) | (load(most + i) - p.turned > all(sharp_turn));
      const Floats its = (beside * beside + across * across) / (2.0f * larger(across, all(1e-6f)));
      radius = turns ? smaller(radius, its) : radius;
    }
    for (int i = 0; i < LANES; ++i) p.tight_from = smaller(p.tight_from, radius[i]);
    for (int64_t j = 0; any_long && j < count; ++j)
      if (shapes[j].length > long_segment && __builtin_fabsf(shapes[j].turned - p.turned) > sharp_turn) p.tight_from = 0;
    p.tight_from -= crease_room;
  }
}

}  // namespace
}  // namespace maulstick
