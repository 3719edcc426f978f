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

// Strokes of so many blocks are a chunk: what they cover, in three channels, fits a cache. It is found again on the way
// back, from the canvas beneath the first of them.
constexpr int32_t chunk_blocks = 2048;

// One stroke; after it the canvas beneath it, where it begins a chunk other than the first, the numbers of its blocks,
// their darkness before the opacity, its slopes, and its ends.
struct alignas(64) Trace {
  const Trace *before, *next;         // of the strokes that were painted before and after it, if any
  const Trace* first;                 // of its chunk
  int64_t stroke;                     // its place among the strokes of the tile
  int32_t canvas_floats;              // of the canvas beneath; 0 where none is kept
  int32_t blocks, slopes, ends;
  int32_t blocks_before;              // of the chunk

  static constexpr int64_t most_slopes = 5 * tile_blocks;      // pixels or four parts of each, and padding

  static int64_t most_bytes(int64_t channels) {
    return sizeof(Trace) + most_slopes * (sizeof(ShapeSlope) + LANES * sizeof(EndSlope)) +
           tile_pixels * sizeof(float) * (channels + 1) + tile_blocks * sizeof(int32_t) + 64;
  }

  float* canvas() const { return reinterpret_cast<float*>(const_cast<Trace*>(this) + 1); }
  int32_t* block() const { return reinterpret_cast<int32_t*>(canvas() + canvas_floats); }
  float* darkness() const { return reinterpret_cast<float*>(block() + (blocks + LANES - 1) / LANES * LANES); }
  template <class S> S* slope() const { return reinterpret_cast<S*>(darkness() + blocks * LANES); }
  template <class S> EndSlope* end() const { return reinterpret_cast<EndSlope*>(slope<S>() + slopes); }
  template <class S> char* after() const { return reinterpret_cast<char*>(end<S>() + ends); }
};

// Fetches the trace before another one, if they lie in one piece; the processor does not guess that it goes backwards.
inline void prefetch(const Trace* before, const Trace* trace) {
  const char *from = reinterpret_cast<const char*>(before), *to = reinterpret_cast<const char*>(trace);
  if (from > to || to - from > 1 << 15) to = from + 1;
  for (; from < to; from += 64) __builtin_prefetch(from);
}

// Fetches the beginning of a trace: the darkness of a usual number of blocks.
inline void prefetch(const Trace* trace) {
  for (int64_t at = 0; at < 1 << 10; at += 64) __builtin_prefetch(reinterpret_cast<const char*>(trace) + at);
}

// Begins the trace of a stroke; null if the arena has no room for it.
inline Trace* new_trace(Arena& arena, const Trace* before, int64_t stroke, int64_t channels) {
  const int64_t most = Trace::most_bytes(channels);
  if (arena.end - arena.at < most && !(arena.more && arena.more(arena, most))) return nullptr;
  arena.at += (64 - reinterpret_cast<uintptr_t>(arena.at) % 64) % 64;
  const bool begins = !before || before->blocks_before + before->blocks >= chunk_blocks;
  Trace* trace = new (arena.at) Trace{before, nullptr, nullptr, stroke, 0, 0, 0, 0, 0};
  trace->first = begins ? trace : before->first;
  trace->canvas_floats = begins && before ? int32_t(tile_pixels * channels) : 0;
  trace->blocks_before = begins ? 0 : before->blocks_before + before->blocks;
  return trace;
}

}  // namespace
}  // namespace maulstick
