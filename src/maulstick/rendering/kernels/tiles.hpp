// Interface between cpu.cpp and tiles.cpp. tiles.cpp is compiled once per instruction set; cpu.cpp picks the widest one
// that this processor has. Only plain pointers cross this interface: the linker keeps one copy of a standard-library
// template, and that must not be one compiled for AVX.
#pragma once
#include <cstddef>
#include <cstdint>

namespace maulstick {

constexpr int tile_height = 16;   // pixels; also the rows of a band
constexpr int tile_width = 64;    // pixels: at most 32 blocks of LANES, which `touched` has bits for

constexpr int64_t most_segments = 2'000'000;   // of a stroke, so that a segment and a pixel fit into one number

constexpr float half_diagonal = 0.70710678f;

// As in nearest.py and reference.py: _THINNEST, _TURN, _FADE, _ROOM, _LONG, _CLOSE.
constexpr float thinnest = 1e-6f, sharp_turn = 0.8f, turn_fade = 0.3f, crease_room = 1.0f, long_segment = 4.0f, close_by = 1.25f;

struct Segment {
  float ux, uy, wx, wy;           // starts at u, ends at u + w (pixels)
  float inverse_squared_length;   // 0 for a segment without length
  float thickness, growth;        // half-width at u, and its increase towards the end
  float reach;                    // half the diagonal more than the larger half-width of the two ends; 0 for no mark
};

// How a stroke goes on around a segment (nearest.py, _Segments).
struct Shape {
  float direction_x, direction_y, length;
  float before, after;                       // pixels along the stroke, on either side
  float turned_before, turned, turned_after; // by how much it has turned up to the segments before, here and after
  float sharp_start, sharp_end;              // from 0 to 1: how round the outer sides of its corners are
  float tight_from;                          // pixels from it from which on another part may be as near
  bool may_round;                            // whether pixels near it may lie around an end or a corner
};

struct Box;                       // around the pixels that a stroke reaches (scene.hpp)

struct Strokes {
  int64_t count, points, segments, channels;
  const Segment* segment;         // (count, segments)
  const Shape* shape;             // (count, segments)
  const Box* box;                 // (count,)
  const float* colours;           // (count, channels)
  const float *c, *q, *o;         // (count,): falloff, plateau, opacity
  const uint8_t* trainable;       // (count,), or null for all
  bool shapes;                    // whether c and q get gradients
};

// One gradient record per stroke (and band): x, y, thickness of each point, then the colour, c, q, o.
inline int64_t gradient_size(const Strokes& s) { return 3 * s.points + s.channels + 3; }

struct Tile { int x, y, width, height; };   // pixels; at most tile_width x tile_height

// Memory for traces of strokes, which the way back needs, piece after piece.
struct Arena {
  char *at, *end;
  bool (*more)(Arena&, int64_t bytes);  // moves on to another piece of at least so many bytes, if there is one; or null
};

struct Kernel {
  const char* name;
  // Finds `tight_from` of one stroke's shapes; places: places_floats(count) numbers of scratch.
  void (*find_tight)(const Segment*, Shape*, int64_t count, float* places);
  int64_t (*places_floats)(int64_t segments);
  // Bytes of the memory of one thread, which is reused for every tile; most of it is hardly ever touched.
  int64_t (*scratch_bytes)(int64_t segments, int64_t channels, int64_t strokes, bool traced);
  // Paints `ids` (in order) over the tile of `canvas` and writes the tile of `out`; both (C, H, W). Unless the arena is
  // null or has not enough room, returns traces for the way back, which live in it.
  const void* (*composite)(const Strokes&, const int32_t* ids, int64_t count, Tile, int64_t height, int64_t width,
                           const float* canvas, float* out, Arena*, char* scratch);
  // Backward pass: reads the gradient of `out`, writes that of `canvas` (unless null), and adds to the record of each
  // stroke, which begins at gradients + record[k]. Without traces it paints again.
  void (*composite_backward)(const Strokes&, const int32_t* ids, int64_t count, Tile, int64_t height, int64_t width,
                             const float* canvas, const float* grad_out, float* grad_canvas, float* gradients,
                             const int64_t* record, const void* traces, char* scratch);
  // Draws one stroke's own darkness image (H, W), and adds its gradient to the stroke's record.
  void (*darkness)(const Strokes&, int64_t id, Tile, int64_t width, float* out, char* scratch);
  void (*darkness_backward)(const Strokes&, int64_t id, Tile, int64_t width, const float* grad_out, float* gradient,
                            char* scratch);
};

extern const Kernel kernel_baseline;
#ifdef MAULSTICK_X86
extern const Kernel kernel_avx2, kernel_avx512;
#endif

}  // namespace maulstick
