// Native module: prepares segments and bands, distributes the bands over threads, and chooses the instruction set.
//
// The canvas is cut into bands of tile_height rows. A band belongs to one thread, walks its tiles from left to right
// and keeps its own gradients for each stroke that crosses it; these are then summed in the order of the bands. So the
// result does not depend on the number of threads or on their speed.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "tiles.hpp"

namespace nb = nanobind;
using namespace maulstick;

namespace {

template <class T, int Dimensions>
using Array = nb::ndarray<T, nb::ndim<Dimensions>, nb::c_contig, nb::device::cpu>;

const Kernel* supported(const std::string& name) {
#ifdef MAULSTICK_X86
  __builtin_cpu_init();
  if (name == kernel_avx2.name)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? &kernel_avx2 : nullptr;
#endif
  return name == kernel_baseline.name ? &kernel_baseline : nullptr;
}

const Kernel& kernel_for(const std::string& instructions) {
  const Kernel* kernel = supported(instructions);
  if (!kernel) throw std::invalid_argument("this processor or build has no instruction set " + instructions);
  return *kernel;
}

nb::list instruction_sets() {                // fastest first
  nb::list names;
  for (const char* name : {"avx2", "baseline"})
    if (supported(name)) names.append(name);
  return names;
}

// Runs work(task, thread) for each task on up to `threads` threads.
template <class Work>
void share_out(int64_t tasks, int64_t threads, Work work) {
  std::atomic<int64_t> next{0};
  auto run = [&](int64_t thread) {
    for (int64_t task; (task = next.fetch_add(1)) < tasks;) work(task, thread);
  };
  std::vector<std::thread> helpers;
  try {
    for (int64_t i = 1; i < std::min(threads, tasks); ++i) helpers.emplace_back(run, i);
  } catch (const std::system_error&) {       // the system gives no more threads: go on with fewer
  }
  run(0);
  for (std::thread& helper : helpers) helper.join();
}

struct Buffer {                              // uninitialised, so that unused pages are never touched
  std::unique_ptr<char[]> bytes;
  explicit Buffer(int64_t size) : bytes(new char[size]) {}
};

// Twice the tangent of half the turn from one direction to another, 8 at most (nearest.py, _turned).
float turn_between(float ax, float ay, float bx, float by) {
  const float across = std::abs(ax * by - ay * bx);
  const float along = ax * bx + ay * by + std::sqrt((ax * ax + ay * ay) * (bx * bx + by * by));
  return across < 4 * along ? 2 * across / along : 8;
}

// Wider than any canvas, while its square and differences stay finite.
float bounded(float thickness) { return std::clamp(thickness, -1e9f, 1e9f); }

float faded(float turn, float least) { return std::clamp((turn - least) / turn_fade, 0.0f, 1.0f); }

struct Segments {
  std::vector<Segment> segment;              // (count, segments)
  std::vector<Shape> shape;                  // (count, segments)

  Segments(const Kernel& kernel, const float* xy, const float* thickness, int64_t count, int64_t points) {
    const int64_t each = std::max<int64_t>(points - 1, 1);
    segment.resize(count * each), shape.resize(count * each);
    std::vector<float> places(kernel.places_floats(each));
    for (int64_t i = 0; i < count; ++i) {
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
      }
      find_shape(segment.data() + i * each, shape.data() + i * each, each);
      kernel.find_tight(segment.data() + i * each, shape.data() + i * each, each, places.data());
    }
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
  std::vector<float> left, right;            // of each stroke: the range of its columns
  std::vector<int32_t> first, last;          // of each stroke: the range of its bands; empty where last < first
  std::vector<int64_t> slot;                 // of each stroke: its first gradient record; one more at the end
  std::vector<int64_t> begin;                // of each band: its first entry in ids and record; one more at the end
  std::vector<int32_t> ids;                  // strokes, band after band
  std::vector<int64_t> record;               // of each of these: where its gradients of this band begin

  Bands(const Strokes& s, int64_t height, int64_t width) {
    const int64_t bands = (height + tile_height - 1) / tile_height;
    left.assign(s.count, INFINITY), right.assign(s.count, -INFINITY);
    first.resize(s.count), last.resize(s.count), slot.resize(s.count + 1), begin.assign(bands + 1, 0);
    for (int64_t i = 0; i < s.count; ++i) {
      float top = INFINITY, bottom = -INFINITY;
      for (int64_t k = 0; k < s.segments; ++k) {
        const Segment& g = s.segment[i * s.segments + k];
        if (!(g.reach > 0)) continue;
        left[i] = std::min(left[i], std::min(g.ux, g.ux + g.wx) - g.reach);
        right[i] = std::max(right[i], std::max(g.ux, g.ux + g.wx) + g.reach);
        top = std::min(top, std::min(g.uy, g.uy + g.wy) - g.reach);
        bottom = std::max(bottom, std::max(g.uy, g.uy + g.wy) + g.reach);
      }
      const bool seen = left[i] <= width && right[i] >= 0 && top <= height && bottom >= 0;
      first[i] = seen ? int32_t(std::max(top, 0.0f) / tile_height) : 0;
      last[i] = seen ? int32_t(std::min<int64_t>(int64_t(std::min(bottom, float(height)) / tile_height), bands - 1)) : -1;
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
      if (bands.left[id] > tile.x + tile.width || bands.right[id] < tile.x) continue;
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

Tile tile_at(int64_t x, int64_t y, int64_t height, int64_t width) {
  return {int(x), int(y), int(std::min<int64_t>(tile_width, width - x)), int(std::min<int64_t>(tile_height, height - y))};
}

Strokes strokes_of(const Segments& segments, Array<const float, 3> xy, int64_t channels,
                   const float* colours, Array<const float, 1> c, Array<const float, 1> q, Array<const float, 1> o,
                   const uint8_t* trainable, bool shapes) {
  const int64_t points = xy.shape(1);
  return {int64_t(xy.shape(0)), points, std::max<int64_t>(points - 1, 1), channels, segments.segment.data(),
          segments.shape.data(), colours, c.data(), q.data(), o.data(), trainable, shapes};
}

// Calls visit(tile, strokes, scratch) for each tile of the canvas, band by band.
template <class Visit>
void each_tile(const Kernel& kernel, const Strokes& s, const Bands& bands, int64_t height, int64_t width,
               int64_t threads, bool backward, Visit visit) {
  const int64_t most = std::max<int64_t>(bands.most(), 1);
  const int64_t size = kernel.scratch_bytes(s.segments, s.channels, most, backward);
  const int64_t used = std::max<int64_t>(std::min(threads, bands.count()), 1);
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
      visit(tile, chosen[thread], buffers[thread].bytes.get());
    }
  });
}

void composite(const std::string& instructions, int64_t threads, Array<const float, 3> canvas,
               Array<const float, 3> xy, Array<const float, 2> thickness, Array<const float, 2> colours,
               Array<const float, 1> c, Array<const float, 1> q, Array<const float, 1> o, Array<float, 3> out) {
  nb::gil_scoped_release release;
  const Kernel& kernel = kernel_for(instructions);
  const int64_t height = canvas.shape(1), width = canvas.shape(2);
  const Segments segments(kernel, xy.data(), thickness.data(), xy.shape(0), xy.shape(1));
  const Strokes s = strokes_of(segments, xy, canvas.shape(0), colours.data(), c, q, o, nullptr, false);
  each_tile(kernel, s, Bands(s, height, width), height, width, threads, false,
            [&](Tile tile, const TileStrokes& chosen, char* scratch) {
              kernel.composite(s, chosen.ids.data(), chosen.ids.size(), tile, height, width, canvas.data(),
                               out.data(), scratch);
            });
}

// grad_canvas: as canvas, or empty where it is not needed. gradients: (count, 3 points + channels + 3), see
// gradient_size.
void composite_backward(const std::string& instructions, int64_t threads, Array<const float, 3> canvas,
                        Array<const float, 3> xy, Array<const float, 2> thickness, Array<const float, 2> colours,
                        Array<const float, 1> c, Array<const float, 1> q, Array<const float, 1> o,
                        Array<const uint8_t, 1> trainable, bool shapes, Array<const float, 3> grad_out,
                        Array<float, 3> grad_canvas, Array<float, 2> gradients) {
  nb::gil_scoped_release release;
  const Kernel& kernel = kernel_for(instructions);
  const int64_t height = canvas.shape(1), width = canvas.shape(2);
  const Segments segments(kernel, xy.data(), thickness.data(), xy.shape(0), xy.shape(1));
  const Strokes s = strokes_of(segments, xy, canvas.shape(0), colours.data(), c, q, o, trainable.data(), shapes);
  const Bands bands(s, height, width);
  const int64_t size = gradient_size(s);
  std::vector<float> partial(bands.slot.back() * size);
  each_tile(kernel, s, bands, height, width, threads, true,
            [&](Tile tile, const TileStrokes& chosen, char* scratch) {
              kernel.composite_backward(s, chosen.ids.data(), chosen.ids.size(), tile, height, width, canvas.data(),
                                        grad_out.data(), grad_canvas.size() ? grad_canvas.data() : nullptr,
                                        partial.data(), chosen.record.data(), scratch);
            });
  for (int64_t i = 0; i < s.count; ++i) {
    float* total = gradients.data() + i * size;
    std::fill(total, total + size, 0.0f);
    for (int64_t n = bands.slot[i]; n < bands.slot[i + 1]; ++n)
      for (int64_t k = 0; k < size; ++k) total[k] += partial[n * size + k];
  }
}

// Calls visit(stroke, tile, scratch) for each stroke and each tile of its own image, one stroke per thread.
template <class Visit>
void each_image(const Kernel& kernel, const Strokes& s, int64_t height, int64_t width, int64_t threads, Visit visit) {
  const int64_t used = std::max<int64_t>(std::min(threads, s.count), 1);
  std::vector<Buffer> buffers;
  for (int64_t i = 0; i < used; ++i) buffers.emplace_back(kernel.scratch_bytes(s.segments, 1, 1, true));
  share_out(s.count, used, [&](int64_t i, int64_t thread) {
    for (int64_t y = 0; y < height; y += tile_height)
      for (int64_t x = 0; x < width; x += tile_width)
        visit(i, tile_at(x, y, height, width), buffers[thread].bytes.get());
  });
}

void darkness(const std::string& instructions, int64_t threads, Array<const float, 3> xy,
              Array<const float, 2> thickness, Array<const float, 1> c, Array<const float, 1> q,
              Array<const float, 1> o, Array<float, 3> out) {
  nb::gil_scoped_release release;
  const Kernel& kernel = kernel_for(instructions);
  const int64_t height = out.shape(1), width = out.shape(2);
  const Segments segments(kernel, xy.data(), thickness.data(), xy.shape(0), xy.shape(1));
  const Strokes s = strokes_of(segments, xy, 0, nullptr, c, q, o, nullptr, true);
  std::fill(out.data(), out.data() + out.size(), 0.0f);
  each_image(kernel, s, height, width, threads, [&](int64_t i, Tile tile, char* scratch) {
    kernel.darkness(s, i, tile, width, out.data() + i * height * width, scratch);
  });
}

void darkness_backward(const std::string& instructions, int64_t threads, Array<const float, 3> xy,
                       Array<const float, 2> thickness, Array<const float, 1> c, Array<const float, 1> q,
                       Array<const float, 1> o, Array<const float, 3> grad_out, Array<float, 2> gradients) {
  nb::gil_scoped_release release;
  const Kernel& kernel = kernel_for(instructions);
  const int64_t height = grad_out.shape(1), width = grad_out.shape(2);
  const Segments segments(kernel, xy.data(), thickness.data(), xy.shape(0), xy.shape(1));
  const Strokes s = strokes_of(segments, xy, 0, nullptr, c, q, o, nullptr, true);
  std::fill(gradients.data(), gradients.data() + gradients.size(), 0.0f);
  each_image(kernel, s, height, width, threads, [&](int64_t i, Tile tile, char* scratch) {
    kernel.darkness_backward(s, i, tile, width, grad_out.data() + i * height * width,
                             gradients.data() + i * gradient_size(s), scratch);
  });
}

}  // namespace

NB_MODULE(_cpu, m) {
  m.def("instruction_sets", &instruction_sets);
  m.def("composite", &composite);
  m.def("composite_backward", &composite_backward);
  m.def("darkness", &darkness);
  m.def("darkness_backward", &darkness_backward);
}
