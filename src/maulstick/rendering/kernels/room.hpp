// A thread's scratch, in which strokes are drawn over a tile.
#pragma once
#include <initializer_list>
#include <type_traits>

#include "trace.hpp"

namespace maulstick {
namespace {

template <int Slopes>
inline auto slope_of(Ints place, const Mean& mean) {
  typename SlopeOf<Slopes>::type slope;
  slope.place = place, slope.by_distance = mean.by_distance, slope.by_thickness = mean.by_thickness;
  if constexpr (Slopes > 1) slope.by_c = mean.by_c, slope.by_q = mean.by_q;
  return slope;
}

// A thread's scratch: a tile of the canvas, of its gradient and of a stroke's darkness; the coverage, samples and ends of
// one stroke; a chunk of traces; and room for some traces, where there is no other.
struct Room {
  Coverage* cover;
  Samples* samples;
  Parts* parts;
  Floats* sums;
  EndSlope* ends;
  float *shade, *canvas, *gradient, *beneath, *checkpoints;
  const Trace** chunk;                // traces of a chunk; `beneath` is what their blocks cover of the canvas
  int32_t* starts;                    // of each painting of `traces`, its first stroke
  char* traces;

  static int64_t aligned(int64_t bytes) { return (bytes + 63) / 64 * 64; }
  static int64_t image_floats(int64_t channels) { return tile_pixels * channels; }
  static constexpr int64_t most_blocks = chunk_blocks + tile_blocks;
  static int64_t trace_bytes(int64_t channels) { return Trace::most_bytes(channels) + (4 << 20); }   // fits a cache

  // Calls take(bytes) for each part and returns the sum; the least likely to be used come last.
  template <class Take>
  static int64_t each_part(int64_t segments, int64_t channels, int64_t strokes, bool traced, Take take) {
    const int64_t once = traced ? 1 : 0;
    int64_t total = 0;
    for (int64_t bytes :
         {int64_t(sizeof(Coverage)), int64_t(sizeof(Samples)), int64_t(sizeof(Parts)),
          4 * tile_blocks * runs_of(segments), int64_t(sizeof(Run)) * runs_of(segments),
          int64_t(sizeof(Floats)) * (6 * segments + channels), int64_t(sizeof(EndSlope)) * LANES * Trace::most_slopes,
          int64_t(4 * tile_pixels), 4 * image_floats(channels), 4 * image_floats(channels),
          once * 4 * LANES * channels * most_blocks, once * int64_t(sizeof(Trace*)) * most_blocks,
          once * trace_bytes(channels), once * 4 * (strokes + 1), once * 4 * image_floats(channels) * strokes}) {
      take(bytes);
      total += aligned(bytes);
    }
    return total;
  }

  static int64_t bytes(int64_t segments, int64_t channels, int64_t strokes, bool traced) {
    return 64 + each_part(segments, channels, strokes, traced, [](int64_t) {});
  }

  Room(char* bytes, int64_t segments, int64_t channels, int64_t strokes, bool traced) {
    char *p = bytes + (64 - reinterpret_cast<uintptr_t>(bytes) % 64) % 64, *places[15];
    int n = 0;
    each_part(segments, channels, strokes, traced, [&](int64_t size) { places[n++] = p; p += aligned(size); });
    n = 0;
    const auto place = [&](auto*& pointer) {
      pointer = reinterpret_cast<std::remove_reference_t<decltype(pointer)>>(places[n++]);
    };
    place(cover), place(samples), place(parts), place(cover->reaching), place(cover->run), place(sums);
    place(ends), place(shade), place(canvas), place(gradient), place(beneath), place(chunk);
    place(traces), place(starts), place(checkpoints);
    samples->count = parts->count = 0;
    std::memset(static_cast<void*>(sums), 0, sizeof(Floats) * (6 * segments + channels));
  }

  Arena arena(int64_t channels) { return {traces, traces + trace_bytes(channels), nullptr}; }

  // Finds the darkness of a stroke before its opacity, into `shade`.
  void shade_stroke(const Strokes& s, int64_t id, Tile tile) {
    cover_stroke(*cover, s, id, tile);
    shade_covered<0>(s, id, [](const auto&) {});
  }

  // Finds that of a stroke whose coverage is known; keep(slope) gets what the way back needs.
  template <int Slopes, class Keep>
  void shade_covered(const Strokes& s, int64_t id, Keep keep) {
    const Profile profile = profile_of(s, id);
    each_block(*cover, [&](int block) {
      store(shade + block * LANES, on_plateau(cover->near[block], profile) ? all(1.0f) : all(0.0f));
    });
    const auto across = [](const Samples& samples, int first) {
      return across_pixels(load(samples.offset_x + first), load(samples.offset_y + first));
    };
    each_batch(
        *samples, *parts, *cover, profile,
        [&](const Samples& batch) {
          for (int first = 0; first < batch.count; first += LANES) {
            const Mean mean = mean_across<Slopes, false>(across(batch, first), load(batch.thickness + first), profile);
            for (int i = 0; i < LANES; ++i) shade[pixel_of(batch.place[first + i])] += mean.value[i];
            if constexpr (Slopes > 0) keep(slope_of<Slopes>(load(batch.place + first), mean));
          }
        },
        [&](const Parts& batch) {
          for (int first = 0; first < batch.count; first += LANES) {
            const Floats weight = load(batch.weight + first);
            Mean mean = mean_of_parts<Slopes>(across(batch, first), load(batch.thickness + first),
                                              load(batch.shift + first), load(batch.scale + first),
                                              load(batch.point + first), profile);
            for (int i = 0; i < LANES; ++i) {
              const int32_t place = batch.place[first + i];
              shade[pixel_of(place)] += weight[i] * mean.value[i];
              if (const int32_t end = batch.ends[first + i]; Slopes > 0 && end) {
                const float by = batch.share[first + i] * (end & 4 ? -mean.value[i] : mean.value[i]);
                keep(EndSlope{end & 1 ? by : 0, end & 2 ? by : 0, place});
              }
            }
            mean.by_distance *= weight, mean.by_thickness *= weight, mean.by_c *= weight, mean.by_q *= weight;
            if constexpr (Slopes > 0) keep(slope_of<Slopes>(load(batch.place + first), mean));
          }
        });
  }

  // Lays a stroke of a darkness, that before its opacity, onto a block of the canvas; covers(channel, floats) gets what
  // was there.
  template <class Covers>
  void lay(const Strokes& s, int64_t id, int block, Floats darkness, Covers covers) {
    const Floats d = s.o[id] * darkness;
    for (int64_t k = 0; k < s.channels; ++k) {
      float* pixel = canvas + k * tile_pixels + block * LANES;
      const Floats beneath = load(pixel);
      covers(k, beneath);
      store(pixel, beneath + d * (s.colours[id * s.channels + k] - beneath));
    }
  }

  // Lays it, of the darkness in `shade`.
  void lay(const Strokes& s, int64_t id, int block) {
    lay(s, id, block, load(shade + block * LANES), [](int64_t, Floats) {});
  }
};

}  // namespace
}  // namespace maulstick
