// How little the slopes of an image correlate with wanted ones on a pyramid of halved images, and the slope of that.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "pyramid.hpp"

namespace nb = nanobind;

namespace {

using maulstick::Level, maulstick::add_doubled, maulstick::halved;

template <class T, int Dimensions>
using Array = nb::ndarray<T, nb::ndim<Dimensions>, nb::c_contig, nb::device::cpu>;

// A level with its edge pixels repeated once all around it.
std::vector<float> padded(const Level& image) {
  const int64_t across = image.width + 2;
  std::vector<float> out((image.height + 2) * across);
  for (int64_t y = 0; y < image.height + 2; ++y) {
    const float* row = image.values.data() + std::clamp<int64_t>(y - 1, 0, image.height - 1) * image.width;
    float* to = out.data() + y * across;
    to[0] = row[0];
    std::copy(row, row + image.width, to + 1);
    to[across - 1] = row[image.width - 1];
  }
  return out;
}

// Sobel's slopes along x and y, per pixel.
void find_slopes(const Level& image, std::vector<float>& along, std::vector<float>& down) {
  const std::vector<float> values = padded(image);
  const int64_t across = image.width + 2;
  along.resize(image.values.size());
  down.resize(image.values.size());
  for (int64_t y = 0; y < image.height; ++y) {
    const float *a = values.data() + y * across, *b = a + across, *c = b + across;
    float *x_slope = along.data() + y * image.width, *y_slope = down.data() + y * image.width;
    for (int64_t x = 0; x < image.width; ++x) {
      x_slope[x] = ((a[x + 2] - a[x]) + 2 * (b[x + 2] - b[x]) + (c[x + 2] - c[x])) / 8;
      y_slope[x] = ((c[x] - a[x]) + 2 * (c[x + 1] - a[x + 1]) + (c[x + 2] - a[x + 2])) / 8;
    }
  }
}

// Adds to the slope with respect to an image that through its Sobel slopes.
void add_through_slopes(const std::vector<float>& by_along, const std::vector<float>& by_down, Level& slope) {
  const int64_t across = slope.width + 2;
  std::vector<float> out((slope.height + 2) * across, 0.0f);
  for (int64_t y = 0; y < slope.height; ++y) {
    float *a = out.data() + y * across, *b = a + across, *c = b + across;
    const float *x_slope = by_along.data() + y * slope.width, *y_slope = by_down.data() + y * slope.width;
    for (int64_t x = 0; x < slope.width; ++x) {
      const float g = x_slope[x] / 8, h = y_slope[x] / 8;
      a[x] += -g - h;
      b[x] += -2 * g;
      c[x] += h - g;
    }
    for (int64_t x = 0; x < slope.width; ++x) {
      const float h = y_slope[x] / 4;
      a[x + 1] -= h;
      c[x + 1] += h;
    }
    for (int64_t x = 0; x < slope.width; ++x) {
      const float g = x_slope[x] / 8, h = y_slope[x] / 8;
      a[x + 2] += g - h;
      b[x + 2] += 2 * g;
      c[x + 2] += g + h;
    }
  }
  for (int64_t y = 0; y < slope.height + 2; ++y) {
    const float* row = out.data() + y * across;
    float* to = slope.values.data() + std::clamp<int64_t>(y - 1, 0, slope.height - 1) * slope.width;
    to[0] += row[0];
    for (int64_t x = 0; x < slope.width; ++x) to[x] += row[x + 1];
    to[slope.width - 1] += row[across - 1];
  }
}

// Averages in windows four pixels apart.
Level windowed(const std::vector<float>& values, int64_t height, int64_t width) {
  const Level once = halved(values.data(), height, width);
  return halved(once.values.data(), once.height, once.width);
}

// The slope with respect to what was averaged in windows.
std::vector<float> through_windows(const Level& slope, int64_t height, int64_t width) {
  Level once{maulstick::half(height), maulstick::half(width), {}};
  once.values.resize(once.height * once.width);
  add_doubled(slope, once.height, once.width, once.values.data());
  std::vector<float> out(height * width);
  add_doubled(once, height, width, out.data());
  return out;
}

// Adds the slope of one level's loss, times `weight`, to `slope`, and returns that loss times the weight.
double add_level(const Level& image, const float* wanted, const float* energy, const float* shares, float faintest,
                 float weight, Level& slope) {
  const int64_t area = image.height * image.width;
  const float* wanted_down = wanted + area;
  std::vector<float> along, down, products(area), squares(area);
  find_slopes(image, along, down);
  for (int64_t i = 0; i < area; ++i) {
    products[i] = along[i] * wanted[i] + down[i] * wanted_down[i];
    squares[i] = along[i] * along[i] + down[i] * down[i];
  }
  Level both = windowed(products, image.height, image.width), own = windowed(squares, image.height, image.width);
  double loss = 0;
  for (int64_t i = 0; i < int64_t(both.values.size()); ++i) {
    const float b = own.values[i] + faintest, root = 1 / std::sqrt(b * energy[i]);
    const float correlation = (both.values[i] + faintest) * root, share = weight * shares[i];
    loss += static_cast<double>(share * (1 - correlation));
    both.values[i] = -share * root;
    own.values[i] = share * correlation / b;  // twice the half that a root leaves: of a square
  }
  const std::vector<float> by_products = through_windows(both, image.height, image.width);
  const std::vector<float> by_squares = through_windows(own, image.height, image.width);
  for (int64_t i = 0; i < area; ++i) {
    along[i] = by_products[i] * wanted[i] + by_squares[i] * along[i];
    down[i] = by_products[i] * wanted_down[i] + by_squares[i] * down[i];
  }
  add_through_slopes(along, down, slope);
  return loss;
}

// image: (1, H, W).  halvings: levels that are passed over before the first that counts.  wanted: for each level that
// counts, slopes (2, h, w).  energies, shares: (1, h/4, w/4) for each.  faintest: is added to all windows.
// slope: (1, H, W), of the result: the mean over levels of the sum of shares * (1 - correlation).
double uncorrelated(Array<const float, 3> image, int64_t halvings, std::vector<Array<const float, 3>> wanted,
                    std::vector<Array<const float, 3>> energies, std::vector<Array<const float, 3>> shares,
                    float faintest, Array<float, 3> slope) {
  nb::gil_scoped_release release;
  const int64_t height = image.shape(1), width = image.shape(2), count = wanted.size();
  std::vector<Level> levels{{height, width, std::vector<float>(image.data(), image.data() + height * width)}};
  for (int64_t l = 1; l < halvings + count; ++l)
    levels.push_back(halved(levels.back().values.data(), levels.back().height, levels.back().width));
  double loss = 0;
  Level below{0, 0, {}};
  for (int64_t l = halvings + count - 1; l >= 0; --l) {
    Level by{levels[l].height, levels[l].width, std::vector<float>(levels[l].values.size())};
    if (below.height) add_doubled(below, by.height, by.width, by.values.data());
    if (const int64_t i = l - halvings; i >= 0)
      loss += add_level(levels[l], wanted[i].data(), energies[i].data(), shares[i].data(), faintest, 1.0f / count, by);
    below = std::move(by);
  }
  std::copy(below.values.begin(), below.values.end(), slope.data());
  return loss;
}

}  // namespace

NB_MODULE(_edges, m) { m.def("uncorrelated", &uncorrelated); }
