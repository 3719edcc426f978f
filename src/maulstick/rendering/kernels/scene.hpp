// How the canvas is cut into bands and tiles, and the work shared out to threads.
//
// The canvas is cut into bands of tile_height rows. A band belongs to one thread, walks its tiles from left to right
// and keeps its own gradients for each stroke that crosses it; these are then summed in the order of the bands. So the
// result does not depend on the number of threads or on their speed.
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "share_out.hpp"
#include "tiles.hpp"

namespace maulstick {

struct Buffer {                              // uninitialised, so that unused pages are never touched
  std::unique_ptr<char[]> bytes;
  explicit Buffer(int64_t size) : bytes(new char[size]) {}
};

// Twice the tangent of half the turn from one direction to another, 8 at most (nearest.py, _turned).
inline float turn_between(float ax, float ay, float bx, float by) {
  const float across = std::abs(ax * by - ay * bx);
  const float along = ax * bx + ay * by + std::sqrt((ax * ax + ay * ay) * (bx * bx + by * by));
  return across < 4 * along ? 2 * across / along : 8;
}

// Wider than any canvas, while its square and differences stay finite.
inline float bounded(float thickness) { return std::clamp(thickness, -1e9f, 1e9f); }

inline float faded(float turn, float least) { return std::clamp((turn - least) / turn_fade, 0.0f, 1.0f); }

// Calls work(begin, end) for ranges of strokes, each of which a thread takes: few are not worth a thread of their own.
template <class Work>
void share_out_strokes(int64_t count, int64_t threads, Work work) {
  constexpr int64_t at_once = 64;
  share_out((count + at_once - 1) / at_once, threads, [&](int64_t task, int64_t) {
    work(task * at_once, std::min((task + 1) * at_once, count));
  });
}

struct Box {                                 // around the pixels that a stroke reaches; empty where right < left
  float left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY;

  void include(const Segment& g) {
    if (!(g.reach > 0)) return;
    left = std::min(left, std::min(g.ux, g.ux + g.wx) - g.reach);
    right = std::max(right, std::max(g.ux, g.ux + g.wx) + g.reach);
    top = std::min(top, std::min(g.uy, g.uy + g.wy) - g.reach);
    bottom = std::max(bottom, std::max(g.uy, g.uy + g.wy) + g.reach);
  }
};

struct Segments {
  std::unique_ptr<Segment[]> segment;        // (count, segments)
  std::unique_ptr<Shape[]> shape;            // (count, segments)
  std::vector<Box> box;                      // (count,)

  Segments(const Kernel& kernel, const float* xy, const float* thickness, int64_t count, int64_t points,
           int64_t threads) {
    const int64_t each = std::max<int64_t>(points - 1, 1);
    if (each > most_segments)
      throw std::invalid_argument("a stroke has " + std::to_string(points) + " points; it may have 2,000,000");
    segment.reset(new Segment[count * each]), shape.reset(new Shape[count * each]), box.resize(count);
    share_out_strokes(count, threads, [&](int64_t begin, int64_t end) {
      std::vector<float> places(kernel.places_floats(each));
      for (int64_t i = begin; i < end; ++i) {
        for (int64_t k = 0; k < each; ++k) {
          const int64_t u = i * points + k, v = points > 1 ? u + 1 : u;
          Segment& s = segment[i * each + k];
          s.ux = xy[2 * u], s.uy = xy[2 * u + 1];
          s.wx = xy[2 * v] - s.ux, s.wy = xy[2 * v + 1] - s.uy;
          const float squared_length = s.wx * s.wx + s.wy * s.wy;
          s.inverse_squared_length = squared_length > 0 ? 1 / squared_length : 0;
          const float at_u = bounded(thickness[u]), at_v = bounded(thickness[v]), widest = std::max(at_u, at_v);
          s.thickness = at_u, s.growth = at_v - at_u;
          s.reach = widest > 0 ? widest + half_diagonal : 0;
          box[i].include(s);
        }
        find_shape(&segment[i * each], &shape[i * each], each);
        kernel.find_tight(&segment[i * each], &shape[i * each], each, places.data());
      }
    });
  }

 private:
  static void find_shape(const Segment* s, Shape* shape, int64_t count) {
    float turned = 0, heading_x = 0, heading_y = 0, along = 0;
    for (int64_t k = 0; k < count; ++k) {
      Shape& p = shape[k];
      p.length = std::sqrt(s[k].wx * s[k].wx + s[k].wy * s[k].wy);
      if (!(p.length < INFINITY)) p.length = 0;
      p.direction_x = p.length > 0 ? s[k].wx / p.length : 0;
      p.direction_y = p.length > 0 ? s[k].wy / p.length : 0;
      p.before = along;
      along += p.length;
      p.turned_before = turned;
      if (s[k].wx != 0 || s[k].wy != 0) {
        if (heading_x != 0 || heading_y != 0) turned += turn_between(heading_x, heading_y, s[k].wx, s[k].wy);
        heading_x = s[k].wx, heading_y = s[k].wy;
      }
      p.turned = turned;
    }
    for (int64_t k = 0; k < count; ++k) {
      Shape& p = shape[k];
      p.after = k + 1 < count ? along - shape[k + 1].before : 0;
      p.turned_after = k + 1 < count ? shape[k + 1].turned : p.turned;
      p.sharp_start = faded(p.turned - p.turned_before, sharp_turn);
      p.sharp_end = faded(p.turned_after - p.turned, sharp_turn);
      p.may_round = p.before < 0.5f || p.after < 0.5f || p.sharp_start > 0 || p.sharp_end > 0;
    }
  }
};

struct Bands {                               // bands of rows, and the strokes that cross each, in order
  std::vector<int32_t> first, last;          // of each stroke: the range of its bands; empty where last < first
  std::vector<int64_t> slot;                 // of each stroke: its first gradient record; one more at the end
  std::vector<int64_t> begin;                // of each band: its first entry in ids and record; one more at the end
  std::vector<int32_t> ids;                  // strokes, band after band
  std::vector<int64_t> record;               // of each of these: where its gradients of this band begin

  Bands(const Strokes& s, int64_t height, int64_t width) {
    const int64_t bands = (height + tile_height - 1) / tile_height;
    first.resize(s.count), last.resize(s.count), slot.resize(s.count + 1), begin.assign(bands + 1, 0);
    for (int64_t i = 0; i < s.count; ++i) {
      const Box& box = s.box[i];
      const bool seen = box.left <= width && box.right >= 0 && box.top <= height && box.bottom >= 0;
      first[i] = seen ? int32_t(std::max(box.top, 0.0f) / tile_height) : 0;
      last[i] = seen ? int32_t(std::min<int64_t>(int64_t(std::min(box.bottom, float(height)) / tile_height), bands - 1))
                     : -1;
      slot[i + 1] = slot[i] + std::max(last[i] - first[i] + 1, 0);
      for (int32_t b = first[i]; b <= last[i]; ++b) ++begin[b + 1];
    }
    for (int64_t b = 0; b < bands; ++b) begin[b + 1] += begin[b];
    ids.resize(begin[bands]), record.resize(begin[bands]);
    std::vector<int64_t> at(begin.begin(), begin.end() - 1);
    for (int64_t i = 0; i < s.count; ++i)
      for (int32_t b = first[i]; b <= last[i]; ++b) {
        ids[at[b]] = int32_t(i);
        record[at[b]++] = (slot[i] + b - first[i]) * gradient_size(s);
      }
  }

  int64_t count() const { return int64_t(begin.size()) - 1; }
  int64_t most() const {
    int64_t most = 0;
    for (int64_t b = 0; b < count(); ++b) most = std::max(most, begin[b + 1] - begin[b]);
    return most;
  }
};

// Strokes of one tile, chosen from those of its band.
struct TileStrokes {
  std::vector<int32_t> ids;
  std::vector<int64_t> record;

  void choose(const Strokes& s, const Bands& bands, int64_t band, Tile tile) {
    ids.clear(), record.clear();
    for (int64_t n = bands.begin[band]; n < bands.begin[band + 1]; ++n) {
      const int32_t id = bands.ids[n];
      if (s.box[id].left > tile.x + tile.width || s.box[id].right < tile.x) continue;
      const Segment* segment = s.segment + id * s.segments;
      bool near = false;
      for (int64_t k = 0; k < s.segments && !near; ++k) {
        const Segment& g = segment[k];
        near = g.reach > 0 && std::min(g.ux, g.ux + g.wx) - g.reach <= tile.x + tile.width &&
               std::max(g.ux, g.ux + g.wx) + g.reach >= tile.x &&
               std::min(g.uy, g.uy + g.wy) - g.reach <= tile.y + tile.height &&
               std::max(g.uy, g.uy + g.wy) + g.reach >= tile.y;
      }
      if (near) ids.push_back(id), record.push_back(bands.record[n]);
    }
  }
};

inline Tile tile_at(int64_t x, int64_t y, int64_t height, int64_t width) {
  return {int(x), int(y), int(std::min<int64_t>(tile_width, width - x)), int(std::min<int64_t>(tile_height, height - y))};
}

inline int64_t tiles_across(int64_t width) { return (width + tile_width - 1) / tile_width; }

inline int64_t threads_for(int64_t tasks, int64_t threads) { return std::max<int64_t>(std::min(threads, tasks), 1); }

struct Visit {
  Tile tile;
  int64_t number, thread;                    // of the tile, band after band; and of the thread
  const TileStrokes& strokes;
  char* scratch;
};

// Calls visit(Visit) for each tile of the canvas, band by band, on `used` threads.
template <class Work>
void each_tile(const Kernel& kernel, const Strokes& s, const Bands& bands, int64_t height, int64_t width,
               int64_t used, bool traced, Work work) {
  const int64_t most = std::max<int64_t>(bands.most(), 1);
  const int64_t size = kernel.scratch_bytes(s.segments, s.channels, most, traced);
  std::vector<Buffer> buffers;
  std::vector<TileStrokes> chosen(used);
  for (int64_t i = 0; i < used; ++i) {
    buffers.emplace_back(size);
    chosen[i].ids.reserve(most), chosen[i].record.reserve(most);
  }
  share_out(bands.count(), used, [&](int64_t band, int64_t thread) {
    for (int64_t x = 0; x < width; x += tile_width) {
      const Tile tile = tile_at(x, band * tile_height, height, width);
      chosen[thread].choose(s, bands, band, tile);
      work(Visit{tile, band * tiles_across(width) + x / tile_width, thread, chosen[thread], buffers[thread].bytes.get()});
    }
  });
}

}  // namespace maulstick
