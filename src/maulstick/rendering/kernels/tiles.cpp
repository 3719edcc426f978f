// Composition of strokes on one tile, and gradients. Every operation works on blocks of LANES pixels, or on LANES samples
// of a stroke. Blocks that no segment comes near are neither touched nor initialised.
#include <type_traits>

#include "gradient.hpp"
#include "room.hpp"
#include "tight.hpp"

namespace maulstick {
namespace {

template <class Copy>   // copy(pixel, offset in an image, count) for each piece of a row that lies in one block
inline void each_piece(Tile tile, int64_t width, Copy copy) {
  for (int row = 0; row < tile.height; ++row) {
    const int64_t offset = (tile.y + row) * width + tile.x;
    int column = 0;
    for (; column + block_width <= tile.width; column += block_width)
      copy(pixel_at(row, column), offset + column, std::integral_constant<int, block_width>());
    if (column < tile.width) copy(pixel_at(row, column), offset + column, tile.width - column);
  }
}

void copy_in(float* tile_image, const float* image, Tile tile, int64_t channels, int64_t height, int64_t width) {
  for (int64_t k = 0; k < channels; ++k, tile_image += tile_pixels, image += height * width)
    each_piece(tile, width, [&](int at, int64_t offset, auto count) {
      std::memcpy(tile_image + at, image + offset, sizeof(float) * count);
    });
}

void copy_out(const float* tile_image, float* image, Tile tile, int64_t channels, int64_t height, int64_t width) {
  for (int64_t k = 0; k < channels; ++k, tile_image += tile_pixels, image += height * width)
    each_piece(tile, width, [&](int at, int64_t offset, auto count) {
      std::memcpy(image + offset, tile_image + at, sizeof(float) * count);
    });
}

// Paints a stroke, and notes its trace; returns false, with nothing done, if the arena has no room for it.
// last: the trace of the stroke before, then of this one. k: its place among the strokes of the tile.
template <int Slopes>
bool paint_and_trace(Room& room, const Strokes& s, int64_t id, int64_t k, Tile tile, Arena& arena, Trace*& last) {
  using S = typename SlopeOf<Slopes>::type;
  Trace* trace = new_trace(arena, last, k, s.channels);
  if (!trace) return false;
  cover_stroke(*room.cover, s, id, tile);
  int32_t* block = trace->block();
  each_block(*room.cover, [&](int each) { block[trace->blocks++] = each; });
  if (trace->blocks == 0) return true;     // the next trace takes its place
  std::memcpy(trace->canvas(), room.canvas, sizeof(float) * trace->canvas_floats);
  S* slopes = trace->slope<S>();
  int32_t ends = 0;
  room.shade_covered<Slopes>(s, id, [&](const auto& slope) {
    if constexpr (std::is_same_v<decltype(slope), const EndSlope&>)
      room.ends[ends++] = slope;
    else
      slopes[trace->slopes++] = slope;
  });
  if (s.trainable && !s.trainable[id]) trace->slopes = ends = 0;
  for (int32_t n = 0; n < trace->blocks; ++n) {
    store(trace->darkness() + n * LANES, load(room.shade + block[n] * LANES));
    room.lay(s, id, block[n]);
  }
  std::memcpy(trace->end<S>(), room.ends, sizeof(EndSlope) * ends);
  trace->ends = ends;
  arena.at = trace->after<S>();
  if (last) last->next = trace;
  last = trace;
  return true;
}

template <int Slopes>
const Trace* paint_and_trace_all(Room& room, const Strokes& s, const int32_t* ids, int64_t count, Tile tile,
                                 Arena& arena) {
  Trace* last = nullptr;
  int64_t k = 0;
  while (k < count && paint_and_trace<Slopes>(room, s, ids[k], k, tile, arena, last)) ++k;
  if (k == count) return last;
  for (; k < count; ++k) {
    Arena once = room.arena(s.channels);
    last = nullptr;
    paint_and_trace<Slopes>(room, s, ids[k], k, tile, once, last);
  }
  return nullptr;
}

const void* composite(const Strokes& s, const int32_t* ids, int64_t count, Tile tile, int64_t height, int64_t width,
                      const float* canvas, float* out, Arena* arena, char* scratch) {
  Room room(scratch, s.segments, s.channels, count, arena != nullptr);
  const Trace* last = nullptr;
  if (arena) std::memset(room.canvas, 0, 4 * Room::image_floats(s.channels));   // the way back reads unused lanes
  copy_in(room.canvas, canvas, tile, s.channels, height, width);
  if (!arena)
    for (int64_t k = 0; k < count; ++k) {
      room.shade_stroke(s, ids[k], tile);
      each_block(*room.cover, [&](int block) { room.lay(s, ids[k], block); });
    }
  else
    last = (s.shapes ? paint_and_trace_all<2> : paint_and_trace_all<1>)(room, s, ids, count, tile, *arena);
  copy_out(room.canvas, out, tile, s.channels, height, width);
  return last;
}

// Finds the traces of the chunk that ends with one, and what their strokes cover; returns their number. restore() puts the
// canvas beneath the first chunk back.
template <class Restore>
int64_t find_chunk(Room& room, const Strokes& s, const int32_t* ids, const Trace* last, Restore restore) {
  const Trace& first = *last->first;
  if (first.before)
    std::memcpy(room.canvas, first.canvas(), sizeof(float) * first.canvas_floats);
  else
    restore();
  int64_t count = 0;
  for (const Trace* trace = &first;; trace = trace->next) {
    room.chunk[count++] = trace;
    if (trace != last) prefetch(trace->next);
    const float* darkness = trace->darkness();
    float* beneath = room.beneath + trace->blocks_before * LANES * s.channels;
    for (int32_t n = 0; n < trace->blocks; ++n, darkness += LANES, beneath += LANES * s.channels)
      room.lay(s, ids[trace->stroke], trace->block()[n], load(darkness),
               [&](int64_t k, Floats covered) { store(beneath + k * LANES, covered); });
    if (trace == last) return count;
  }
}

// Goes back over a stroke. record: where its gradients are added, or null where it gets none.
template <int Slopes>
void step_back(Room& room, const Strokes& s, int64_t id, const Trace& trace, Tile tile, float* record) {
  using S = typename SlopeOf<Slopes>::type;
  StrokeGradient<Slopes> stroke(s, id, tile, room.sums, record);
  const float* darkness_of = trace.darkness();
  const float* beneath = room.beneath + trace.blocks_before * LANES * s.channels;
  for (int32_t n = 0; n < trace.blocks; ++n, darkness_of += LANES, beneath += LANES * s.channels) {
    const int at = trace.block()[n] * LANES;
    const Floats value = load(darkness_of), darkness = s.o[id] * value;
    Floats grad_darkness{};
    for (int64_t j = 0; j < s.channels; ++j) {
      float* pixel = room.gradient + j * tile_pixels + at;
      const Floats grad = load(pixel);
      if (record) {
        grad_darkness += grad * (s.colours[id * s.channels + j] - load(beneath + j * LANES));
        stroke.colour(j) += grad * darkness;
      }
      store(pixel, grad * (1.0f - darkness));
    }
    stroke.add_opacity(grad_darkness, value);
    store(room.shade + at, grad_darkness);
  }
  if (!record) return;
  const S* slopes = trace.slope<S>();
  for (int32_t n = 0; n < trace.slopes; ++n) stroke.add(slopes[n], room.shade);
  const EndSlope* ends = trace.end<S>();
  for (int32_t n = 0; n < trace.ends; ++n) stroke.add(ends[n], room.shade);
  stroke.finish();
}

template <int Slopes, class Restore>   // restore: as `find_chunk` takes it
void walk_back(Room& room, const Strokes& s, const int32_t* ids, const Trace* last, Tile tile, float* gradients,
               const int64_t* record_of, Restore restore) {
  while (last) {
    for (int64_t i = find_chunk(room, s, ids, last, restore) - 1; i >= 0; --i) {
      const Trace& trace = *room.chunk[i];
      if (i) prefetch(room.chunk[i - 1], &trace);
      const int64_t id = ids[trace.stroke];
      const bool trainable = !s.trainable || s.trainable[id];
      step_back<Slopes>(room, s, id, trace, tile, trainable ? gradients + record_of[trace.stroke] : nullptr);
    }
    last = last->first->before;
  }
}

void restore_canvas(Room& room, const float* canvas, Tile tile, int64_t channels, int64_t height, int64_t width) {
  std::memset(room.canvas, 0, 4 * Room::image_floats(channels));   // the way back reads unused lanes
  copy_in(room.canvas, canvas, tile, channels, height, width);
}

// Paints the tile again, as many strokes at once as there is room for, and goes back over them.
template <int Slopes>
void repaint_and_walk_back(Room& room, const Strokes& s, const int32_t* ids, int64_t count, Tile tile, int64_t height,
                           int64_t width, const float* canvas, float* gradients, const int64_t* record) {
  const int64_t image = Room::image_floats(s.channels);
  Trace* last = nullptr;
  const auto paint = [&](int64_t begin, int64_t end) {
    Arena arena = room.arena(s.channels);
    last = nullptr;
    while (begin < end && paint_and_trace<Slopes>(room, s, ids[begin], begin, tile, arena, last)) ++begin;
    return begin;
  };
  const auto restore = [&](int64_t painting) {
    if (painting)
      std::memcpy(room.canvas, room.checkpoints + painting * image, 4 * image);
    else
      restore_canvas(room, canvas, tile, s.channels, height, width);
  };
  restore(0);
  int64_t paintings = 0, end = 0;
  do {
    if (end) std::memcpy(room.checkpoints + paintings * image, room.canvas, 4 * image);   // else it is the canvas itself
    room.starts[paintings++] = int32_t(end);
    end = paint(end, count);
  } while (end < count);
  for (int64_t p = paintings - 1; p >= 0; --p) {
    if (p < paintings - 1) {
      restore(p);
      paint(room.starts[p], room.starts[p + 1]);
    }
    walk_back<Slopes>(room, s, ids, last, tile, gradients, record, [&] { restore(p); });
  }
}

template <int Slopes>
void composite_backward_with(const Strokes& s, const int32_t* ids, int64_t count, Tile tile, int64_t height,
                             int64_t width, const float* canvas, const float* grad_out, float* grad_canvas,
                             float* gradients, const int64_t* record, const void* traces, char* scratch) {
  Room room(scratch, s.segments, s.channels, count, true);
  // Unused lanes at the right and lower edge of the canvas stay 0, so that they add nothing to the sums.
  std::memset(room.gradient, 0, 4 * Room::image_floats(s.channels));
  copy_in(room.gradient, grad_out, tile, s.channels, height, width);
  if (traces)
    walk_back<Slopes>(room, s, ids, static_cast<const Trace*>(traces), tile, gradients, record,
                      [&] { restore_canvas(room, canvas, tile, s.channels, height, width); });
  else
    repaint_and_walk_back<Slopes>(room, s, ids, count, tile, height, width, canvas, gradients, record);
  if (grad_canvas) copy_out(room.gradient, grad_canvas, tile, s.channels, height, width);
}

void composite_backward(const Strokes& s, const int32_t* ids, int64_t count, Tile tile, int64_t height, int64_t width,
                        const float* canvas, const float* grad_out, float* grad_canvas, float* gradients,
                        const int64_t* record, const void* traces, char* scratch) {
  const auto backward = s.shapes ? composite_backward_with<2> : composite_backward_with<1>;
  backward(s, ids, count, tile, height, width, canvas, grad_out, grad_canvas, gradients, record, traces, scratch);
}

// Alone on black with white paint, a stroke is its darkness.
void darkness(const Strokes& s, int64_t id, Tile tile, int64_t width, float* out, char* scratch) {
  Room room(scratch, s.segments, 1, 1, false);
  std::memset(room.canvas, 0, 4 * tile_pixels);
  room.shade_stroke(s, id, tile);
  each_block(*room.cover, [&](int block) {
    store(room.canvas + block * LANES, s.o[id] * load(room.shade + block * LANES));
  });
  copy_out(room.canvas, out, tile, 1, 0, width);
}

void darkness_backward(const Strokes& s, int64_t id, Tile tile, int64_t width, const float* grad_out, float* gradient,
                       char* scratch) {
  Room room(scratch, s.segments, 1, 1, true);
  std::memset(room.gradient, 0, 4 * tile_pixels);
  copy_in(room.gradient, grad_out, tile, 1, 0, width);
  StrokeGradient<2> stroke(s, id, tile, room.sums, gradient);
  cover_stroke(*room.cover, s, id, tile);
  room.shade_covered<2>(s, id, [&](const auto& slope) { stroke.add(slope, room.gradient); });
  each_block(*room.cover, [&](int block) {
    stroke.add_opacity(load(room.gradient + block * LANES), load(room.shade + block * LANES));
  });
  stroke.finish();
}

}  // namespace

extern const Kernel KERNEL = {INSTRUCTION_SET, find_tight, places_floats, Room::bytes, composite,
                              composite_backward, darkness, darkness_backward};

}  // namespace maulstick
