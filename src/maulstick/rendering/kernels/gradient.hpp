// Gradients of a stroke's points, thickness, colour and shape from the slopes of its samples.
#pragma once
#include "trace.hpp"

namespace maulstick {
namespace {

// Gradients of one stroke over one tile, summed in a fixed order.
template <int Slopes>
class StrokeGradient {
 public:
  // sums: 6 vectors for each segment, then one for each channel; all 0 before and after.
  StrokeGradient(const Strokes& strokes, int64_t id, Tile tile, Floats* sums, float* record)
      : strokes_(strokes), tile_(tile), segments_(strokes.segment + id * strokes.segments),
        shapes_(strokes.shape + id * strokes.segments), sums_(sums), points_(record),
        rest_(record + 3 * strokes.points), o_(strokes.o[id]), first_(INT32_MAX), last_(-1), grad_c_{}, grad_q_{},
        grad_o_{} {}

  Floats& colour(int64_t channel) { return sums_[6 * strokes_.segments + channel]; }

  // grad: gradient of the loss by the darkness of LANES pixels; value: that before the opacity.
  void add_opacity(Floats grad, Floats value) { grad_o_ += grad * value; }

  // Adds the gradients of LANES samples. grads: gradient of the loss by the darkness of each pixel of the tile.
  void add(const typename SlopeOf<Slopes>::type& slope, const float* grads) {
    const Ints pixel = pixel_of(slope.place), owner = owner_of(slope.place);
    Floats grad;
    for (int i = 0; i < LANES; ++i) grad[i] = grads[pixel[i]];
    grad *= o_;
    if constexpr (Slopes > 1) {
      grad_c_ += grad * slope.by_c;
      grad_q_ += grad * slope.by_q;
    }
    const Floats by_distance = grad * slope.by_distance, by_thickness = grad * slope.by_thickness;
    const Ints counts = (by_distance != all(0.0f)) | (by_thickness != all(0.0f));
    const Floats x = pixels_x(tile_, pixel), y = pixels_y(tile_, pixel);
    each_owner(owner, counts, [&](int32_t k, Ints mine) {
      add_segment(k, x, y, mine ? by_distance : all(0.0f), mine ? by_thickness : all(0.0f));
    });
  }

  // Adds those of a sample whose weight changes as the stroke grows.
  void add(const EndSlope& slope, const float* grads) {
    const Shape& shape = shapes_[owner_of(slope.place)];
    const float grad = o_ * grads[pixel_of(slope.place)];
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
    for (int64_t j = 0; j < strokes_.channels; ++j) {
      rest_[j] += sum(colour(j));
      colour(j) = Floats{};
    }
    float* tail = rest_ + strokes_.channels;
    tail[0] += sum(grad_c_);
    tail[1] += sum(grad_q_);
    tail[2] += sum(grad_o_);
  }

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
  const Tile tile_;
  const Segment* segments_;
  const Shape* shapes_;
  Floats* sums_;
  float *points_, *rest_;
  float o_;
  int32_t first_, last_;
  Floats grad_c_, grad_q_, grad_o_;
};

}  // namespace
}  // namespace maulstick
