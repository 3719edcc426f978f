// Native module: what Python calls. It prepares segments and bands, and chooses the instruction set.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>

#include <iterator>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string>

#include "scene.hpp"

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
  if (name == kernel_avx512.name)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                   __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") ? &kernel_avx512 : nullptr;
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
  for (const char* name : {"avx512", "avx2", "baseline"})
    if (supported(name)) names.append(name);
  return names;
}

// Whether all is finite and in its range, as `check_strokes` in arguments.py asks for.
bool drawable(Array<const float, 3> xy, Array<const float, 2> thickness, Array<const float, 1> c,
              Array<const float, 1> q, Array<const float, 1> o) {
  nb::gil_scoped_release release;
  const auto all = [](const auto& numbers, auto valid) {
    bool good = true;
    for (size_t i = 0; i < numbers.size(); ++i) good &= valid(numbers.data()[i]);
    return good;
  };
  const auto finite = [](float x) { return std::abs(x) <= std::numeric_limits<float>::max(); };
  return all(xy, finite) && all(thickness, finite) && all(c, [&](float x) { return x > 0 && finite(x); }) &&
         all(q, [](float x) { return x >= 0 && x < 1; }) && all(o, [](float x) { return x > 0 && x <= 1; });
}

Strokes strokes_of(const Segments& segments, Array<const float, 3> xy, int64_t channels,
                   const float* colours, Array<const float, 1> c, Array<const float, 1> q, Array<const float, 1> o,
                   const uint8_t* trainable, bool shapes) {
  const int64_t points = xy.shape(1);
  return {int64_t(xy.shape(0)), points, std::max<int64_t>(points - 1, 1), channels, segments.segment.get(),
          segments.shape.get(), segments.box.data(), colours, c.data(), q.data(), o.data(), trainable, shapes};
}

constexpr int64_t piece_bytes = 1 << 20;

// Pieces of memory that are kept from one painting to the next: the system's cost as much as what is written into them.
class Spare {
 public:
  Buffer take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (buffers_.empty()) return Buffer(piece_bytes);
    Buffer buffer = std::move(buffers_.back());
    buffers_.pop_back();
    return buffer;
  }

  void give_back(std::vector<Buffer> buffers, int64_t most) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (Buffer& buffer : buffers)
      if (int64_t(buffers_.size()) < most) buffers_.push_back(std::move(buffer));
  }

 private:
  std::mutex mutex_;
  std::vector<Buffer> buffers_;
} spare;

// Memory of one thread for traces.
struct Pieces : Arena {
  std::vector<Buffer> buffers;
  std::atomic<int64_t>& left;                // of the pieces that all threads may take

  explicit Pieces(std::atomic<int64_t>& left) : Arena{nullptr, nullptr, another}, left(left) {}

  static bool another(Arena& arena, int64_t bytes) {
    Pieces& self = static_cast<Pieces&>(arena);
    if (bytes > piece_bytes || self.left.fetch_sub(1) <= 0) return false;
    self.buffers.push_back(spare.take());
    self.at = self.buffers.back().bytes.get(), self.end = self.at + piece_bytes;
    return true;
  }
};

// What the way back over a painted canvas needs.
struct Traces {
  Segments segments;
  Bands bands;
  int64_t most_pieces;
  std::vector<const void*> last;             // of each tile
  std::vector<Buffer> memory;

  Traces(Segments&& segments, Bands&& bands, int64_t most_pieces, std::vector<const void*>&& last)
      : segments(std::move(segments)), bands(std::move(bands)), most_pieces(most_pieces), last(std::move(last)) {}
  Traces(const Traces&) = delete;            // they point into the memory
  ~Traces() { spare.give_back(std::move(memory), most_pieces); }
};

void composite(const std::string& instructions, int64_t threads, Array<const float, 3> canvas,
               Array<const float, 3> xy, Array<const float, 2> thickness, Array<const float, 2> colours,
               Array<const float, 1> c, Array<const float, 1> q, Array<const float, 1> o, Array<float, 3> out) {
  nb::gil_scoped_release release;
  const Kernel& kernel = kernel_for(instructions);
  const int64_t height = canvas.shape(1), width = canvas.shape(2);
  const Segments segments(kernel, xy.data(), thickness.data(), xy.shape(0), xy.shape(1), threads);
  const Strokes s = strokes_of(segments, xy, canvas.shape(0), colours.data(), c, q, o, nullptr, false);
  const Bands bands(s, height, width);
  each_tile(kernel, s, bands, height, width, threads_for(bands.count(), threads), false, [&](const Visit& at) {
    kernel.composite(s, at.strokes.ids.data(), at.strokes.ids.size(), at.tile, height, width, canvas.data(),
                     out.data(), nullptr, at.scratch);
  });
}

// Paints as `composite` does, and returns what the way back needs, for a call with the same arrays. most_pieces: MiB that
// traces may take; tiles that find no more of it are painted again on the way back.
std::unique_ptr<Traces> composite_traced(const std::string& instructions, int64_t threads, int64_t most_pieces,
                                         Array<const float, 3> canvas, Array<const float, 3> xy,
                                         Array<const float, 2> thickness, Array<const float, 2> colours,
                                         Array<const float, 1> c, Array<const float, 1> q, Array<const float, 1> o,
                                         Array<const uint8_t, 1> trainable, bool shapes, Array<float, 3> out) {
  nb::gil_scoped_release release;
  const Kernel& kernel = kernel_for(instructions);
  const int64_t height = canvas.shape(1), width = canvas.shape(2);
  Segments segments(kernel, xy.data(), thickness.data(), xy.shape(0), xy.shape(1), threads);
  const Strokes s = strokes_of(segments, xy, canvas.shape(0), colours.data(), c, q, o, trainable.data(), shapes);
  Bands bands(s, height, width);
  std::atomic<int64_t> left{most_pieces};
  std::vector<Pieces> pieces;
  const int64_t used = threads_for(bands.count(), threads);
  for (int64_t i = 0; i < used; ++i) pieces.emplace_back(left);
  std::vector<const void*> last(bands.count() * tiles_across(width));
  each_tile(kernel, s, bands, height, width, used, true, [&](const Visit& at) {
    last[at.number] = kernel.composite(s, at.strokes.ids.data(), at.strokes.ids.size(), at.tile, height, width,
                                       canvas.data(), out.data(), &pieces[at.thread], at.scratch);
  });
  auto traces = std::make_unique<Traces>(std::move(segments), std::move(bands), most_pieces, std::move(last));
  for (Pieces& each : pieces) std::move(each.buffers.begin(), each.buffers.end(), std::back_inserter(traces->memory));
  return traces;
}

// traces: of `composite_traced`. grad_canvas: as canvas, or empty where it is not needed. gradients: (count, 3 points +
// channels + 3), see gradient_size.
void composite_backward(const std::string& instructions, int64_t threads, Array<const float, 3> canvas,
                        Array<const float, 3> xy, Array<const float, 2> colours,
                        Array<const float, 1> c, Array<const float, 1> q, Array<const float, 1> o,
                        Array<const uint8_t, 1> trainable, bool shapes, const Traces& traces,
                        Array<const float, 3> grad_out, Array<float, 3> grad_canvas, Array<float, 2> gradients) {
  nb::gil_scoped_release release;
  const Kernel& kernel = kernel_for(instructions);
  const int64_t height = canvas.shape(1), width = canvas.shape(2);
  const Bands& bands = traces.bands;
  const Strokes s =
      strokes_of(traces.segments, xy, canvas.shape(0), colours.data(), c, q, o, trainable.data(), shapes);
  const int64_t size = gradient_size(s);
  const std::unique_ptr<float[]> partial(new float[bands.slot.back() * size]);
  each_tile(kernel, s, bands, height, width, threads_for(bands.count(), threads), true, [&](const Visit& at) {
    if (at.tile.x == 0) {                    // the band's first
      const int64_t band = at.tile.y / tile_height;
      for (int64_t n = bands.begin[band]; n < bands.begin[band + 1]; ++n)
        std::fill_n(partial.get() + bands.record[n], size, 0.0f);
    }
    kernel.composite_backward(s, at.strokes.ids.data(), at.strokes.ids.size(), at.tile, height, width, canvas.data(),
                              grad_out.data(), grad_canvas.size() ? grad_canvas.data() : nullptr, partial.get(),
                              at.strokes.record.data(), traces.last[at.number], at.scratch);
  });
  share_out_strokes(s.count, threads, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      float* total = gradients.data() + i * size;
      std::fill(total, total + size, 0.0f);
      for (int64_t n = bands.slot[i]; n < bands.slot[i + 1]; ++n)
        for (int64_t k = 0; k < size; ++k) total[k] += partial[n * size + k];
    }
  });
}

// Calls visit(stroke, tile, scratch) for each stroke and each tile of its own image, one stroke per thread.
template <class Visit>
void each_image(const Kernel& kernel, const Strokes& s, int64_t height, int64_t width, int64_t threads, Visit visit) {
  const int64_t used = threads_for(s.count, threads);
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
  const Segments segments(kernel, xy.data(), thickness.data(), xy.shape(0), xy.shape(1), threads);
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
  const Segments segments(kernel, xy.data(), thickness.data(), xy.shape(0), xy.shape(1), threads);
  const Strokes s = strokes_of(segments, xy, 0, nullptr, c, q, o, nullptr, true);
  std::fill(gradients.data(), gradients.data() + gradients.size(), 0.0f);
  each_image(kernel, s, height, width, threads, [&](int64_t i, Tile tile, char* scratch) {
    kernel.darkness_backward(s, i, tile, width, grad_out.data() + i * height * width,
                             gradients.data() + i * gradient_size(s), scratch);
  });
}

}  // namespace

NB_MODULE(_cpu, m) {
  nb::set_leak_warnings(false);              // a graph that is alive when Python ends holds its traces
  m.def("instruction_sets", &instruction_sets);
  m.def("drawable", &drawable);
  m.def("composite", &composite);
  nb::class_<Traces>(m, "Traces");
  m.def("composite_traced", &composite_traced);
  m.def("composite_backward", &composite_backward);
  m.def("darkness", &darkness);
  m.def("darkness_backward", &darkness_backward);
}
