// Coverage, composition and their gradients on one tile. Every operation works on blocks of LANES pixels of a row.
//
// Per stroke a tile keeps, for each pixel, the square of distance / thickness of the nearest segment (the maximum of
// darkness over segments, docs/equations.md, is the minimum of that ratio) and the index of that segment. Blocks that
// no segment comes near are neither touched nor initialised.
#include "tiles.hpp"
#include "lanes.hpp"

namespace maulstick {
namespace {

constexpr int tile_pixels = tile_height * tile_width;
constexpr int tile_blocks = tile_pixels / LANES;

struct Coverage {                     // of one stroke over one tile
  alignas(64) float square[tile_pixels];   // (distance / thickness)^2
  alignas(64) int32_t segment[tile_pixels];
  uint32_t touched[tile_height];      // one bit per block of LANES pixels
};

// Finds the columns [left, right] in which the segment, widened by its reach, crosses the row at y.
inline bool crossing(const Segment& s, float y, float* left, float* right) {
  float from = 0, to = 1;
  if (s.wy != 0) {
    float a = (y - s.reach - s.uy) / s.wy, b = (y + s.reach - s.uy) / s.wy;
    from = larger(0.0f, smaller(a, b));
    to = smaller(1.0f, larger(a, b));
    if (from > to) return false;
  }
  float a = s.ux + from * s.wx, b = s.ux + to * s.wx;
  *left = smaller(a, b) - s.reach;
  *right = larger(a, b) + s.reach;
  return true;
}

inline void cover_row(Coverage& cover, const Segment& s, int32_t number, Tile tile, int row, float left, float right) {
  float low = larger(left - tile.x, 0.0f), high = smaller(right - tile.x, tile.width - 0.5f);
  if (!(low <= high)) return;
  const int first = int(low) / LANES, last = int(high) / LANES;
  const Floats dy = all(tile.y + row + 0.5f - s.uy);
  for (int block = first; block <= last; ++block) {
    const int at = row * tile_width + block * LANES;
    Floats dx = lane_numbers() + (tile.x + block * LANES + 0.5f - s.ux);
    Floats t = (dx * s.wx + dy * s.wy) * s.inverse_squared_length;
    t = smaller(larger(t, all(0.0f)), all(1.0f));
    Floats ex = dx - t * s.wx, ey = dy - t * s.wy;
    Floats thickness = s.thickness + t * s.growth;
    Floats square = (ex * ex + ey * ey) / (thickness * thickness);
    square = thickness > all(0.0f) ? smaller(square, all(2.0f)) : all(2.0f);   // 2: no mark, also for NaN
    if (cover.touched[row] >> block & 1) {
      Floats before = load(cover.square + at);
      Ints nearer = square < before;
      Ints owner;
      std::memcpy(&owner, cover.segment + at, sizeof owner);
      owner = nearer ? all(number) : owner;
      store(cover.square + at, nearer ? square : before);
      std::memcpy(cover.segment + at, &owner, sizeof owner);
    } else {
      Ints owner = all(number);
      store(cover.square + at, square);
      std::memcpy(cover.segment + at, &owner, sizeof owner);
      cover.touched[row] |= 1u << block;
    }
  }
}

void cover_stroke(Coverage& cover, const Strokes& strokes, int64_t id, Tile tile) {
  std::memset(cover.touched, 0, sizeof cover.touched);
  const Segment* segments = strokes.segment + id * strokes.segments;
  const float x0 = tile.x, x1 = tile.x + tile.width, y0 = tile.y, y1 = tile.y + tile.height;
  for (int64_t k = 0; k < strokes.segments; ++k) {
    const Segment& s = segments[k];
    if (!(s.reach > 0)) continue;
    const float left = smaller(s.ux, s.ux + s.wx) - s.reach, right = larger(s.ux, s.ux + s.wx) + s.reach;
    const float top = smaller(s.uy, s.uy + s.wy) - s.reach, bottom = larger(s.uy, s.uy + s.wy) + s.reach;
    if (left > x1 || right < x0 || top > y1 || bottom < y0) continue;
    const int first = int(larger(top - y0, 0.0f)), last = int(smaller(bottom - y0, tile.height - 0.5f));
    const bool narrow = __builtin_fabsf(s.wx) < 2 * LANES;       // its box is as tight as its outline
    for (int row = first; row <= last; ++row) {
      float a = left, b = right;
      const float y = y0 + row + 0.5f;
      if (narrow || crossing(s, y, &a, &b)) cover_row(cover, s, int32_t(k), tile, row, a, b);
    }
  }
}

struct Darkness { Floats value, ratio, base, log_base; };

// Darkness of a block from the squared ratio; `log_base` is 0 on the plateau, where no gradient flows.
inline Darkness darken(Floats square, float c, float inverse_ramp, float o) {
  Darkness d;
  Ints inside = square < all(1.0f);
  d.ratio = root(inside ? square : all(1.0f));
  d.base = smaller((1.0f - d.ratio) * inverse_ramp, all(1.0f));
  inside &= d.base > all(1e-30f);
  d.log_base = natural_log(inside ? d.base : all(1.0f));
  d.value = inside ? exponential(d.log_base * c) * o : all(0.0f);
  return d;
}

inline bool reaches(Floats square) { return any(square < all(1.0f)); }

template <class Visit>   // visit(row, offset in the tile) for each block that the stroke reaches
inline void each_block(const Coverage& cover, int rows, Visit visit) {
  for (int row = 0; row < rows; ++row)
    for (uint32_t bits = cover.touched[row]; bits; bits &= bits - 1) {
      const int at = row * tile_width + __builtin_ctz(bits) * LANES;
      if (reaches(load(cover.square + at))) visit(row, at);
    }
}

// Gradients of one stroke over one tile, summed over pixels in a fixed order.
class StrokeGradient {
 public:
  StrokeGradient(const Strokes& strokes, int64_t id, Tile tile, float* record)
      : strokes_(strokes), segments_(strokes.segment + id * strokes.segments), tile_(tile), points_(record),
        rest_(record + 3 * strokes.points), c_(strokes.c[id]), inverse_ramp_(1 / (1 - strokes.q[id])),
        o_(strokes.o[id]), grad_c_{}, grad_q_{}, grad_o_{} {}

  // Adds the gradients of a block; grad: gradient of the loss with respect to its darkness.
  void add(int at, Floats grad, const Darkness& d, Ints owner) {
    Floats weighted = grad * d.value;
    grad_o_ += weighted;
    grad_c_ += weighted * d.log_base;
    Ints ramp = (d.value > all(0.0f)) & (d.base < all(1.0f));
    Floats grad_base = ramp ? weighted * c_ / d.base : all(0.0f);
    grad_q_ += grad_base * d.base;
    Floats grad_ratio = grad_base * -inverse_ramp_;
    Ints pending = grad_ratio != all(0.0f);
    const Floats x = lane_numbers() + (tile_.x + at % tile_width + 0.5f);
    const Floats y = all(tile_.y + at / tile_width + 0.5f);
    int32_t owners[LANES], waits[LANES];
    std::memcpy(owners, &owner, sizeof owners);
    std::memcpy(waits, &pending, sizeof waits);
    for (int lane = 0; lane < LANES; ++lane) {             // once per segment that owns a pixel of the block
      if (!waits[lane]) continue;
      const int32_t k = owners[lane];
      for (int i = lane; i < LANES; ++i) waits[i] = owners[i] == k ? 0 : waits[i];
      Ints mine = pending & (owner == all(k));
      add_segment(k, x, y, mine ? grad_ratio : all(0.0f), d.ratio);
    }
  }

  void finish() {
    float* tail = rest_ + strokes_.channels;
    tail[0] += sum(grad_c_);
    tail[1] += sum(grad_q_) * inverse_ramp_;
    tail[2] += sum(grad_o_) / o_;
  }

  float* colour() { return rest_; }

 private:
  void add_segment(int32_t k, Floats x, Floats y, Floats grad_ratio, Floats ratio) {
    const Segment& s = segments_[k];
    Floats dx = x - s.ux, dy = y - s.uy;
    Floats free = (dx * s.wx + dy * s.wy) * s.inverse_squared_length;
    Floats t = smaller(larger(free, all(0.0f)), all(1.0f));
    Floats ex = dx - t * s.wx, ey = dy - t * s.wy;
    Floats thickness = s.thickness + t * s.growth;
    // ratio = distance / thickness; in the distance to the foot of the perpendicular, the derivative by t is 0 ...
    Floats per_distance = ratio > all(0.0f) ? grad_ratio / (ratio * thickness * thickness) : all(0.0f);
    Floats foot_x = -per_distance * ex, foot_y = -per_distance * ey;
    Floats grad_thickness = thickness > all(0.0f) ? -grad_ratio * ratio / thickness : all(0.0f);
    // ... but the thickness depends on t wherever t is not clamped
    Ints moves = (free > all(0.0f)) & (free < all(1.0f));
    Floats grad_t = moves ? grad_thickness * (s.growth * s.inverse_squared_length) : all(0.0f);
    Floats end_x = grad_t * (dx - 2 * t * s.wx), end_y = grad_t * (dy - 2 * t * s.wy);
    float* u = points_ + 3 * k;
    float* v = points_ + 3 * (strokes_.points > 1 ? k + 1 : k);
    u[0] += sum(foot_x * (1.0f - t) - grad_t * s.wx - end_x);
    u[1] += sum(foot_y * (1.0f - t) - grad_t * s.wy - end_y);
    u[2] += sum(grad_thickness * (1.0f - t));
    v[0] += sum(foot_x * t + end_x);
    v[1] += sum(foot_y * t + end_y);
    v[2] += sum(grad_thickness * t);
  }

  const Strokes& strokes_;
  const Segment* segments_;
  Tile tile_;
  float *points_, *rest_;
  float c_, inverse_ramp_, o_;
  Floats grad_c_, grad_q_, grad_o_;
};

void copy_in(float* tile_image, const float* image, Tile tile, int64_t channels, int64_t height, int64_t width) {
  for (int64_t k = 0; k < channels; ++k)
    for (int row = 0; row < tile.height; ++row)
      std::memcpy(tile_image + k * tile_pixels + row * tile_width,
                  image + (k * height + tile.y + row) * width + tile.x, sizeof(float) * tile.width);
}

void copy_out(const float* tile_image, float* image, Tile tile, int64_t channels, int64_t height, int64_t width) {
  for (int64_t k = 0; k < channels; ++k)
    for (int row = 0; row < tile.height; ++row)
      std::memcpy(image + (k * height + tile.y + row) * width + tile.x,
                  tile_image + k * tile_pixels + row * tile_width, sizeof(float) * tile.width);
}

inline Darkness darken_at(const Coverage& cover, const Strokes& s, int64_t id, int at) {
  return darken(load(cover.square + at), s.c[id], 1 / (1 - s.q[id]), s.o[id]);
}

void paint(float* canvas, Coverage& cover, const Strokes& s, int64_t id, Tile tile) {
  cover_stroke(cover, s, id, tile);
  each_block(cover, tile.height, [&](int, int at) {
    Floats d = darken_at(cover, s, id, at).value;
    for (int64_t k = 0; k < s.channels; ++k) {
      float* pixel = canvas + k * tile_pixels + at;
      Floats beneath = load(pixel);
      store(pixel, beneath + d * (s.colours[id * s.channels + k] - beneath));
    }
  });
}

// Layout of a thread's scratch: a tile of the canvas and of its gradient, the coverage of one stroke, and for the
// strokes of one chunk one record per block with what the backward pass needs: darkness, owners, the canvas beneath.
struct Room {
  Coverage* cover;
  float *canvas, *gradient, *checkpoints, *records;
  int32_t *offsets, *begins;
  int64_t record_floats;

  static int64_t aligned(int64_t bytes) { return (bytes + 63) / 64 * 64; }

  static int64_t bytes(int64_t channels, int64_t chunk, int64_t checkpoints) {
    return aligned(sizeof(Coverage)) + aligned(4 * tile_pixels * channels) * (2 + checkpoints) +
           aligned(4 * LANES * (5 + channels)) * tile_blocks * chunk + aligned(4 * tile_blocks * chunk) +
           aligned(4 * (chunk + 1)) + 64;
  }

  Room(Scratch scratch, int64_t channels, int64_t checkpoint_count) {
    char* p = scratch.bytes + (64 - reinterpret_cast<uintptr_t>(scratch.bytes) % 64) % 64;
    auto take = [&p](int64_t size) { char* taken = p; p += aligned(size); return taken; };
    record_floats = aligned(4 * LANES * (5 + channels)) / 4;
    cover = reinterpret_cast<Coverage*>(take(sizeof(Coverage)));
    canvas = reinterpret_cast<float*>(take(4 * tile_pixels * channels));
    gradient = reinterpret_cast<float*>(take(4 * tile_pixels * channels));
    checkpoints = reinterpret_cast<float*>(take(aligned(4 * tile_pixels * channels) * checkpoint_count));
    records = reinterpret_cast<float*>(take(4 * record_floats * tile_blocks * scratch.chunk));
    offsets = reinterpret_cast<int32_t*>(take(4 * tile_blocks * scratch.chunk));
    begins = reinterpret_cast<int32_t*>(take(4 * (scratch.chunk + 1)));
  }
};

void composite(const Strokes& s, const int32_t* ids, int64_t count, Tile tile, int64_t height, int64_t width,
               const float* canvas, float* out, Scratch scratch) {
  Room room(scratch, s.channels, 0);
  copy_in(room.canvas, canvas, tile, s.channels, height, width);
  for (int64_t k = 0; k < count; ++k) paint(room.canvas, *room.cover, s, ids[k], tile);
  copy_out(room.canvas, out, tile, s.channels, height, width);
}

// Paints strokes [0, count) of a chunk forwards, keeping a record per block.
void paint_and_record(Room& room, const Strokes& s, const int32_t* ids, int64_t count, Tile tile) {
  int32_t n = 0;
  for (int64_t k = 0; k < count; ++k) {
    const int64_t id = ids[k];
    room.begins[k] = n;
    cover_stroke(*room.cover, s, id, tile);
    each_block(*room.cover, tile.height, [&](int, int at) {
      const Darkness d = darken_at(*room.cover, s, id, at);
      float* record = room.records + n * room.record_floats;
      room.offsets[n++] = at;
      store(record, d.value);
      store(record + LANES, d.ratio);
      store(record + 2 * LANES, d.base);
      store(record + 3 * LANES, d.log_base);
      std::memcpy(record + 4 * LANES, room.cover->segment + at, 4 * LANES);
      for (int64_t j = 0; j < s.channels; ++j) {
        float* pixel = room.canvas + j * tile_pixels + at;
        Floats beneath = load(pixel);
        store(record + (5 + j) * LANES, beneath);
        store(pixel, beneath + d.value * (s.colours[id * s.channels + j] - beneath));
      }
    });
  }
  room.begins[count] = n;
}

void walk_back(Room& room, const Strokes& s, const int32_t* ids, int64_t count, Tile tile, float* gradients,
               const int64_t* record_of) {
  for (int64_t k = count - 1; k >= 0; --k) {
    const int64_t id = ids[k];
    const bool trainable = !s.trainable || s.trainable[id];
    if (room.begins[k] == room.begins[k + 1]) continue;
    StrokeGradient stroke(s, id, tile, trainable ? gradients + record_of[k] : nullptr);
    for (int32_t n = room.begins[k]; n < room.begins[k + 1]; ++n) {
      const float* record = room.records + n * room.record_floats;
      const int at = room.offsets[n];
      Darkness d{load(record), load(record + LANES), load(record + 2 * LANES), load(record + 3 * LANES)};
      Floats grad_darkness{};
      for (int64_t j = 0; j < s.channels; ++j) {
        float* pixel = room.gradient + j * tile_pixels + at;
        Floats grad = load(pixel);
        if (trainable) {
          grad_darkness += grad * (s.colours[id * s.channels + j] - load(record + (5 + j) * LANES));
          stroke.colour()[j] += sum(grad * d.value);
        }
        store(pixel, grad * (1.0f - d.value));
      }
      if (!trainable) continue;
      Ints owner;
      std::memcpy(&owner, record + 4 * LANES, sizeof owner);
      stroke.add(at, grad_darkness, d, owner);
    }
    if (trainable) stroke.finish();
  }
}

void composite_backward(const Strokes& s, const int32_t* ids, int64_t count, Tile tile, int64_t height, int64_t width,
                        const float* canvas, const float* grad_out, float* grad_canvas, float* gradients,
                        const int64_t* record, Scratch scratch) {
  const int64_t chunks = (count + scratch.chunk - 1) / scratch.chunk;
  const int64_t image = Room::aligned(4 * tile_pixels * s.channels) / 4;
  Room room(scratch, s.channels, chunks);
  // Unused lanes at the right and lower edge of the canvas stay 0, so that they add nothing to the sums.
  std::memset(room.canvas, 0, 4 * tile_pixels * s.channels);
  std::memset(room.gradient, 0, 4 * tile_pixels * s.channels);
  copy_in(room.canvas, canvas, tile, s.channels, height, width);
  copy_in(room.gradient, grad_out, tile, s.channels, height, width);
  for (int64_t c = 0; c < chunks; ++c) {
    std::memcpy(room.checkpoints + c * image, room.canvas, 4 * image);
    for (int64_t k = c * scratch.chunk; c + 1 < chunks && k < (c + 1) * scratch.chunk; ++k)
      paint(room.canvas, *room.cover, s, ids[k], tile);
  }
  for (int64_t c = chunks - 1; c >= 0; --c) {
    const int64_t first = c * scratch.chunk, size = count - first < scratch.chunk ? count - first : scratch.chunk;
    std::memcpy(room.canvas, room.checkpoints + c * image, 4 * image);
    paint_and_record(room, s, ids + first, size, tile);
    walk_back(room, s, ids + first, size, tile, gradients, record + first);
  }
  if (grad_canvas) copy_out(room.gradient, grad_canvas, tile, s.channels, height, width);
}

void darkness(const Strokes& s, int64_t id, Tile tile, int64_t width, float* out, Scratch scratch) {
  Room room(scratch, 1, 0);
  cover_stroke(*room.cover, s, id, tile);
  each_block(*room.cover, tile.height, [&](int row, int at) {
    alignas(64) float values[LANES];
    store(values, darken_at(*room.cover, s, id, at).value);
    const int column = at % tile_width, n = tile.width - column < LANES ? tile.width - column : LANES;
    std::memcpy(out + (tile.y + row) * width + tile.x + column, values, sizeof(float) * n);
  });
}

void darkness_backward(const Strokes& s, int64_t id, Tile tile, int64_t width, const float* grad_out, float* gradient,
                       Scratch scratch) {
  Room room(scratch, 1, 0);
  cover_stroke(*room.cover, s, id, tile);
  StrokeGradient stroke(s, id, tile, gradient);
  each_block(*room.cover, tile.height, [&](int row, int at) {
    alignas(64) float grad[LANES] = {};
    const int column = at % tile_width, n = tile.width - column < LANES ? tile.width - column : LANES;
    std::memcpy(grad, grad_out + (tile.y + row) * width + tile.x + column, sizeof(float) * n);
    Ints owner;
    std::memcpy(&owner, room.cover->segment + at, sizeof owner);
    stroke.add(at, load(grad), darken_at(*room.cover, s, id, at), owner);
  });
  stroke.finish();
}

}  // namespace

extern const Kernel KERNEL = {INSTRUCTION_SET, Room::bytes, composite, composite_backward, darkness, darkness_backward};

}  // namespace maulstick
