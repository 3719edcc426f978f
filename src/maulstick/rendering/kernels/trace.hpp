// What the way back needs of a stroke over a tile, written one after another into an arena.
#pragma once
#include <new>

#include "samples.hpp"

namespace maulstick {
namespace {

// Of LANES samples: their places, and their weight times the slopes of their darkness.
struct Slope {
  Ints place;
  Floats by_distance, by_thickness;
};

struct ShapeSlope : Slope {           // where the falloff and the plateau get gradients too
  Floats by_c, by_q;
};

template <int Slopes>
struct SlopeOf { using type = Slope; };
template <>
struct SlopeOf<2> { using type = ShapeSlope; };

// Of a sample whose weight grows or falls as an end of the stroke moves outwards.
struct EndSlope {
  float by_start, by_end;
  int32_t place;
};

// Of a block: its darkness before the opacity, and the canvas beneath in each channel.
inline int64_t beneath_floats(int64_t channels) { return LANES * (1 + channels); }

// One stroke; after it its slopes, beneath of its blocks, its ends, and the numbers of its blocks.
struct alignas(64) Trace {
  const Trace* before;                // of the stroke that was painted before, if any
  int64_t stroke;                     // its place among the strokes of the tile
  int32_t slopes, blocks, ends;

  static constexpr int64_t most_slopes = 5 * tile_blocks;      // pixels or four parts of each, and padding

  static int64_t most_bytes(int64_t channels) {
    return sizeof(Trace) + most_slopes * (sizeof(ShapeSlope) + LANES * sizeof(EndSlope)) +
           tile_blocks * sizeof(float) * (beneath_floats(channels) + 1) + 64;
  }

  template <class S> S* first_slope() const { return reinterpret_cast<S*>(const_cast<Trace*>(this) + 1); }
  template <class S> float* first_beneath() const { return reinterpret_cast<float*>(first_slope<S>() + slopes); }
  template <class S> EndSlope* first_end(int64_t channels) const {
    return reinterpret_cast<EndSlope*>(first_beneath<S>() + blocks * beneath_floats(channels));
  }
  template <class S> int32_t* first_block(int64_t channels) const {
    return reinterpret_cast<int32_t*>(first_end<S>(channels) + ends);
  }
  template <class S> char* end(int64_t channels) const {
    return reinterpret_cast<char*>(first_block<S>(channels) + blocks);
  }
};

// Fetches the trace before another one, if they lie in one piece; the processor does not guess that it goes backwards.
inline void prefetch(const Trace* before, const Trace* trace) {
  const char *from = reinterpret_cast<const char*>(before), *to = reinterpret_cast<const char*>(trace);
  if (from > to || to - from > 1 << 15) to = from + 1;
  for (; from < to; from += 64) __builtin_prefetch(from);
}

// Begins the trace of a stroke; null if the arena has no room for it.
inline Trace* new_trace(Arena& arena, const Trace* before, int64_t stroke, int64_t channels) {
  const int64_t most = Trace::most_bytes(channels);
  if (arena.end - arena.at < most && !(arena.more && arena.more(arena, most))) return nullptr;
  arena.at += (64 - reinterpret_cast<uintptr_t>(arena.at) % 64) % 64;
  return new (arena.at) Trace{before, stroke, 0, 0, 0};
}

}  // namespace
}  // namespace maulstick
