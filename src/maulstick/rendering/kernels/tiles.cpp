// Composition of strokes on one tile, and gradients. Every operation works on blocks of LANES pixels, or on LANES samples
// of a stroke. Blocks that no segment comes near are neither touched nor initialised.
#include <initializer_list>
#include <type_traits>

#include "samples.hpp"
#include "tight.hpp"

namespace maulstick {
namespace {

inline Profile profile_of(const Strokes& s, int64_t id) { return {s.c[id], s.q[id], s.o[id]}; }

// What is kept of LANES samples for the way back: where they are, and their weight times the slopes of their darkness.
struct Slope {
  Floats x, y, by_distance, by_thickness, by_c, by_q;
  Ints owner, at;
};

template <int Slopes>
inline Slope slope_of(const Samples& samples, int first, const Mean& mean) {
  Slope slope{load(samples.x + first), load(samples.y + first), mean.by_distance, mean.by_thickness, {}, {},
              load(samples.owner + first), load(samples.at + first)};
  if (Slopes > 1) slope.by_c = mean.by_c, slope.by_q = mean.by_q;
  return slope;
}

// And of a sample whose weight grows or falls as an end of the stroke moves outwards.
struct EndSlope {
  float by_start, by_end;
  int32_t owner, at;
};

// Gradients of one stroke over one tile, summed in a fixed order.
template <int Slopes>
class StrokeGradient {
 public:
  // sums: 6 vectors for each segment, all 0 before and after.
  StrokeGradient(const Strokes& strokes, int64_t id, Floats* sums, float* record)
      : strokes_(strokes), segments_(strokes.segment + id * strokes.segments),
        shapes_(strokes.shape + id * strokes.segments), sums_(sums), points_(record),
        rest_(record + 3 * strokes.points), o_(strokes.o[id]), first_(INT32_MAX), last_(-1), grad_c_{}, grad_q_{},
        grad_o_{} {}

  // grad: gradient of the loss by the darkness of LANES pixels; value: that before the opacity.
  void add_opacity(Floats grad, Floats value) { grad_o_ += grad * value; }

  // Adds the gradients of LANES samples. grads: gradient of the loss by the darkness of each pixel of the tile.
  void add(const Slope& slope, const float* grads) {
    Floats grad;
    for (int i = 0; i < LANES; ++i) grad[i] = grads[slope.at[i]];
    grad *= o_;
    if (Slopes > 1) {
      grad_c_ += grad * slope.by_c;
      grad_q_ += grad * slope.by_q;
    }
    const Floats by_distance = grad * slope.by_distance, by_thickness = grad * slope.by_thickness;
    const Ints pending = (by_distance != all(0.0f)) | (by_thickness != all(0.0f));
    int32_t owners[LANES], waits[LANES];
    std::memcpy(owners, &slope.owner, sizeof owners);
    std::memcpy(waits, &pending, sizeof waits);
    for (int lane = 0; lane < LANES; ++lane) {             // once per segment that owns a sample
      if (!waits[lane]) continue;
      const int32_t k = owners[lane];
      for (int i = lane; i < LANES; ++i) waits[i] = owners[i] == k ? 0 : waits[i];
      const Ints mine = pending & (slope.owner == all(k));
      add_segment(k, slope.x, slope.y, mine ? by_distance : all(0.0f), mine ? by_thickness : all(0.0f));
    }
  }

  // Adds those of a sample whose weight changes as the stroke grows.
  void add(const EndSlope& slope, const float* grads) {
    const Shape& shape = shapes_[slope.owner];
    const float grad = o_ * grads[slope.at];
    float* last = points_ + 3 * (strokes_.points - 1);
    points_[0] += grad * slope.by_start * shape.direction_x, points_[1] += grad * slope.by_start * shape.direction_y;
    last[0] -= grad * slope.by_end * shape.direction_x, last[1] -= grad * slope.by_end * shape.direction_y;
  }

  void finish() {
    for (int32_t k = first_; k <= last_; ++k) {
      Floats* here = sums_ + 6 * k;
      float* u = points_ + 3 * k;
      float* v = points_ + 3 * (strokes_.points > 1 ? k + 1 : k);
      for (int i = 0; i < 3; ++i) {
        u[i] += sum(here[i]);
        v[i] += sum(here[3 + i]);
      }
      std::memset(here, 0, 6 * sizeof(Floats));
    }
    float* tail = rest_ + strokes_.channels;
    tail[0] += sum(grad_c_);
    tail[1] += sum(grad_q_);
    tail[2] += sum(grad_o_);
  }

  float* colour() { return rest_; }

 private:
  void add_segment(int32_t k, Floats x, Floats y, Floats by_distance, Floats by_thickness) {
    const Segment& s = segments_[k];
    const Foot foot = foot_on(s, x, y);
    const Floats squared = foot.offset_x * foot.offset_x + foot.offset_y * foot.offset_y;
    const Floats per_pixel = squared > all(0.0f) ? by_distance / root(squared) : all(0.0f);
    // In the distance to the foot of the perpendicular, the derivative by t is 0 ...
    const Floats foot_x = -per_pixel * foot.offset_x, foot_y = -per_pixel * foot.offset_y, t = foot.t;
    // ... but the thickness depends on t wherever t is not clamped
    const Ints moves = (foot.free > all(0.0f)) & (foot.free < all(1.0f));
    const Floats by_t = moves ? by_thickness * (s.growth * s.inverse_squared_length) : all(0.0f);
    const Floats end_x = by_t * (x - s.ux - 2 * t * s.wx), end_y = by_t * (y - s.uy - 2 * t * s.wy);
    Floats* here = sums_ + 6 * k;
    here[0] += foot_x * (1.0f - t) - by_t * s.wx - end_x;
    here[1] += foot_y * (1.0f - t) - by_t * s.wy - end_y;
    here[2] += by_thickness * (1.0f - t);
    here[3] += foot_x * t + end_x;
    here[4] += foot_y * t + end_y;
    here[5] += by_thickness * t;
    first_ = k < first_ ? k : first_;
    last_ = k > last_ ? k : last_;
  }

  const Strokes& strokes_;
  const Segment* segments_;
  const Shape* shapes_;
  Floats* sums_;
  float *points_, *rest_;
  float o_;
  int32_t first_, last_;
  Floats grad_c_, grad_q_, grad_o_;
};

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

// A thread's scratch: a tile of the canvas, of its gradient and of a stroke's darkness; the coverage and samples of one
// stroke; and for the strokes of one chunk what the way back needs: slopes of samples, and of each block its darkness and
// in each channel the canvas beneath.
struct Room {
  Coverage* cover;
  Samples* samples;
  Parts* parts;
  Floats* sums;
  Slope* slopes;
  EndSlope* ends;
  float *shade, *canvas, *gradient, *kept, *checkpoints;
  int32_t *blocks, *starts;           // starts: of each chunk, its first stroke
  int64_t *block_begins, *slope_begins, *end_begins;

  static int64_t aligned(int64_t bytes) { return (bytes + 63) / 64 * 64; }
  static int64_t image_floats(int64_t channels) { return tile_pixels * channels; }

  // Calls take(bytes) for each part and returns the sum; the least likely to be used come last.
  template <class Take>
  static int64_t each_part(int64_t segments, int64_t channels, int64_t strokes, bool backward, Take take) {
    const int64_t kept_strokes = backward ? strokes : 0, kept = backward ? kept_slopes + most_slopes : 0;
    int64_t total = 0;
    for (int64_t bytes :
         {int64_t(sizeof(Coverage)), int64_t(sizeof(Samples)), int64_t(sizeof(Parts)),
          4 * tile_blocks * runs_of(segments), runs_of(segments), int64_t(6 * sizeof(Floats)) * segments,
          int64_t(4 * tile_pixels), 4 * image_floats(channels),
          4 * image_floats(channels), int64_t(sizeof(Slope)) * kept, int64_t(sizeof(EndSlope)) * LANES * kept, 4 * kept,
          4 * LANES * (1 + channels) * kept, 8 * (kept_strokes + 1), 8 * (kept_strokes + 1), 8 * (kept_strokes + 1), 4 * (kept_strokes + 1),
          4 * image_floats(channels) * kept_strokes}) {
      take(bytes);
      total += aligned(bytes);
    }
    return total;
  }

  static int64_t bytes(int64_t segments, int64_t channels, int64_t strokes, bool backward) {
    return 64 + each_part(segments, channels, strokes, backward, [](int64_t) {});
  }

  Room(char* bytes, int64_t segments, int64_t channels, int64_t strokes, bool backward) {
    char *p = bytes + (64 - reinterpret_cast<uintptr_t>(bytes) % 64) % 64, *places[20];
    int n = 0;
    each_part(segments, channels, strokes, backward, [&](int64_t size) { places[n++] = p; p += aligned(size); });
    n = 0;
    const auto place = [&](auto*& pointer) {
      pointer = reinterpret_cast<std::remove_reference_t<decltype(pointer)>>(places[n++]);
    };
    place(cover), place(samples), place(parts), place(cover->reaching), place(cover->comes_near), place(sums);
    place(shade), place(canvas), place(gradient), place(slopes), place(ends), place(blocks), place(kept);
    place(block_begins), place(slope_begins), place(end_begins), place(starts), place(checkpoints);
    samples->count = parts->count = 0;
    std::memset(static_cast<void*>(sums), 0, 6 * sizeof(Floats) * segments);
  }

  static constexpr int64_t most_slopes = 5 * tile_blocks;      // of one stroke: pixels or four parts of each, and padding
  static constexpr int64_t kept_slopes = (4 << 20) / sizeof(Slope);                   // after which a chunk ends

  // Finds the darkness of a stroke before its opacity, into `shade`; keep(slope) gets what the way back needs.
  template <int Slopes, class Keep>
  void shade_stroke(const Strokes& s, int64_t id, Tile tile, Keep keep) {
    const Profile profile = profile_of(s, id);
    cover_stroke(*cover, s, id, tile);
    each_block(*cover, [&](int block) {
      store(shade + block * LANES, on_plateau(cover->near[block], profile) ? all(1.0f) : all(0.0f));
    });
    const auto across = [](const Samples& samples, int first) {
      return across_pixels(load(samples.offset_x + first), load(samples.offset_y + first));
    };
    each_batch(
        *samples, *parts, *cover, profile, tile,
        [&](const Samples& batch) {
          for (int first = 0; first < batch.count; first += LANES) {
            const Mean mean = mean_across<Slopes, false>(across(batch, first), load(batch.thickness + first), profile);
            for (int i = 0; i < LANES; ++i) shade[batch.at[first + i]] += mean.value[i];
            if constexpr (Slopes > 0) keep(slope_of<Slopes>(batch, first, mean));
          }
        },
        [&](const Parts& batch) {
          for (int first = 0; first < batch.count; first += LANES) {
            const Floats weight = load(batch.weight + first);
            Mean mean = mean_of_parts<Slopes>(across(batch, first), load(batch.thickness + first),
                                              load(batch.shift + first), load(batch.scale + first),
                                              load(batch.point + first), profile);
            for (int i = 0; i < LANES; ++i) {
              shade[batch.at[first + i]] += weight[i] * mean.value[i];
              if (const int32_t end = batch.ends[first + i]; Slopes > 0 && end) {
                const float by = batch.share[first + i] * (end & 4 ? -mean.value[i] : mean.value[i]);
                keep(EndSlope{end & 1 ? by : 0, end & 2 ? by : 0, batch.owner[first + i], batch.at[first + i]});
              }
            }
            mean.by_distance *= weight, mean.by_thickness *= weight, mean.by_c *= weight, mean.by_q *= weight;
            if constexpr (Slopes > 0) keep(slope_of<Slopes>(batch, first, mean));
          }
        });
  }

  // Lays a stroke of the darkness in `shade` onto a block of the canvas.
  void lay(const Strokes& s, int64_t id, int block) {
    const int at = block * LANES;
    const Floats d = s.o[id] * load(shade + at);
    for (int64_t k = 0; k < s.channels; ++k) {
      float* pixel = canvas + k * tile_pixels + at;
      const Floats beneath = load(pixel);
      store(pixel, beneath + d * (s.colours[id * s.channels + k] - beneath));
    }
  }
};

void composite(const Strokes& s, const int32_t* ids, int64_t count, Tile tile, int64_t height, int64_t width,
               const float* canvas, float* out, char* scratch) {
  Room room(scratch, s.segments, s.channels, count, false);
  copy_in(room.canvas, canvas, tile, s.channels, height, width);
  for (int64_t k = 0; k < count; ++k) {
    room.shade_stroke<0>(s, ids[k], tile, [](const auto&) {});
    each_block(*room.cover, [&](int block) { room.lay(s, ids[k], block); });
  }
  copy_out(room.canvas, out, tile, s.channels, height, width);
}

// Paints strokes from `begin` on and keeps what the way back needs, until `end` or until there is much of it. Returns the
// first stroke that is not painted.
template <int Slopes>
int64_t paint_and_keep(Room& room, const Strokes& s, const int32_t* ids, int64_t begin, int64_t end, Tile tile) {
  int64_t blocks = 0, slopes = 0, ends = 0, k = begin;
  for (; k < end && slopes < Room::kept_slopes && blocks < Room::kept_slopes; ++k) {
    const int64_t id = ids[k], first_block = blocks;
    room.block_begins[k] = blocks, room.slope_begins[k] = slopes, room.end_begins[k] = ends;
    room.shade_stroke<Slopes>(s, id, tile, [&](const auto& slope) {
      if constexpr (std::is_same_v<decltype(slope), const EndSlope&>)
        room.ends[ends++] = slope;
      else
        room.slopes[slopes++] = slope;
    });
    each_block(*room.cover, [&](int block) { room.blocks[blocks++] = block; });
    for (int64_t n = first_block; n < blocks; ++n) {
      const int at = room.blocks[n] * LANES;
      float* kept = room.kept + n * LANES * (1 + s.channels);
      store(kept, load(room.shade + at));
      for (int64_t j = 0; j < s.channels; ++j)
        store(kept + (1 + j) * LANES, load(room.canvas + j * tile_pixels + at));
      room.lay(s, id, room.blocks[n]);
    }
  }
  room.block_begins[k] = blocks, room.slope_begins[k] = slopes, room.end_begins[k] = ends;
  return k;
}

template <int Slopes>
void walk_back(Room& room, const Strokes& s, const int32_t* ids, int64_t begin, int64_t end, float* gradients,
               const int64_t* record_of) {
  for (int64_t k = end - 1; k >= begin; --k) {
    const int64_t id = ids[k];
    const bool trainable = !s.trainable || s.trainable[id];
    if (room.block_begins[k] == room.block_begins[k + 1]) continue;
    StrokeGradient<Slopes> stroke(s, id, room.sums, trainable ? gradients + record_of[k] : nullptr);
    for (int64_t n = room.block_begins[k]; n < room.block_begins[k + 1]; ++n) {
      const float* kept = room.kept + n * LANES * (1 + s.channels);
      const int at = room.blocks[n] * LANES;
      const Floats value = load(kept), darkness = s.o[id] * value;
      Floats grad_darkness{};
      for (int64_t j = 0; j < s.channels; ++j) {
        float* pixel = room.gradient + j * tile_pixels + at;
        const Floats grad = load(pixel);
        if (trainable) {
          grad_darkness += grad * (s.colours[id * s.channels + j] - load(kept + (1 + j) * LANES));
          stroke.colour()[j] += sum(grad * darkness);
        }
        store(pixel, grad * (1.0f - darkness));
      }
      stroke.add_opacity(grad_darkness, value);
      store(room.shade + at, grad_darkness);
    }
    if (!trainable) continue;
    for (int64_t n = room.slope_begins[k]; n < room.slope_begins[k + 1]; ++n) stroke.add(room.slopes[n], room.shade);
    for (int64_t n = room.end_begins[k]; n < room.end_begins[k + 1]; ++n) stroke.add(room.ends[n], room.shade);
    stroke.finish();
  }
}

template <int Slopes>
void composite_backward_with(const Strokes& s, const int32_t* ids, int64_t count, Tile tile, int64_t height,
                             int64_t width, const float* canvas, const float* grad_out, float* grad_canvas,
                             float* gradients, const int64_t* record, char* scratch) {
  Room room(scratch, s.segments, s.channels, count, true);
  const int64_t image = Room::image_floats(s.channels);
  // Unused lanes at the right and lower edge of the canvas stay 0, so that they add nothing to the sums.
  std::memset(room.canvas, 0, 4 * image);
  std::memset(room.gradient, 0, 4 * image);
  copy_in(room.canvas, canvas, tile, s.channels, height, width);
  copy_in(room.gradient, grad_out, tile, s.channels, height, width);
  int64_t chunks = 0, end = 0;
  do {
    if (end) std::memcpy(room.checkpoints + chunks * image, room.canvas, 4 * image);   // else it is the canvas itself
    room.starts[chunks++] = int32_t(end);
    end = paint_and_keep<Slopes>(room, s, ids, end, count, tile);
  } while (end < count);
  walk_back<Slopes>(room, s, ids, room.starts[chunks - 1], count, gradients, record);
  for (int64_t c = chunks - 2; c >= 0; --c) {
    if (c)
      std::memcpy(room.canvas, room.checkpoints + c * image, 4 * image);
    else
      copy_in(room.canvas, canvas, tile, s.channels, height, width);
    end = paint_and_keep<Slopes>(room, s, ids, room.starts[c], room.starts[c + 1], tile);
    walk_back<Slopes>(room, s, ids, room.starts[c], end, gradients, record);
  }
  if (grad_canvas) copy_out(room.gradient, grad_canvas, tile, s.channels, height, width);
}

void composite_backward(const Strokes& s, const int32_t* ids, int64_t count, Tile tile, int64_t height, int64_t width,
                        const float* canvas, const float* grad_out, float* grad_canvas, float* gradients,
                        const int64_t* record, char* scratch) {
  const auto backward = s.shapes ? composite_backward_with<2> : composite_backward_with<1>;
  backward(s, ids, count, tile, height, width, canvas, grad_out, grad_canvas, gradients, record, scratch);
}

// Alone on black with white paint, a stroke is its darkness.
void darkness(const Strokes& s, int64_t id, Tile tile, int64_t width, float* out, char* scratch) {
  Room room(scratch, s.segments, 1, 1, false);
  std::memset(room.canvas, 0, 4 * tile_pixels);
  room.shade_stroke<0>(s, id, tile, [](const auto&) {});
  each_block(*room.cover, [&](int block) { store(room.canvas + block * LANES, s.o[id] * load(room.shade + block * LANES)); });
  copy_out(room.canvas, out, tile, 1, 0, width);
}

void darkness_backward(const Strokes& s, int64_t id, Tile tile, int64_t width, const float* grad_out, float* gradient,
                       char* scratch) {
  Room room(scratch, s.segments, 1, 1, true);
  std::memset(room.gradient, 0, 4 * tile_pixels);
  copy_in(room.gradient, grad_out, tile, 1, 0, width);
  StrokeGradient<2> stroke(s, id, room.sums, gradient);
  room.shade_stroke<2>(s, id, tile, [&](const auto& slope) { stroke.add(slope, room.gradient); });
  each_block(*room.cover, [&](int block) {
    stroke.add_opacity(load(room.gradient + block * LANES), load(room.shade + block * LANES));
  });
  stroke.finish();
}

}  // namespace

extern const Kernel KERNEL = {INSTRUCTION_SET, find_tight, places_floats, Room::bytes, composite, composite_backward, darkness, darkness_backward};

}  // namespace maulstick
