// A short way through strokes that are each drawn once: from stroke to nearest stroke, then local search (2-opt, Or-opt
// and exchanges of neighbouring runs) after many small disturbances, each kept only if it led to a shorter way.
//
// An element of the way is a stroke as it is drawn: it enters at the point 2 * stroke + turned and leaves at its other
// point, which is that number ^ 1. Two elements are no strokes: the pen's first place, and an end at distance 0 of all.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace nb = nanobind;

namespace {

template <class T, int Dimensions>
using Array = nb::ndarray<T, nb::ndim<Dimensions>, nb::c_contig, nb::device::cpu>;

constexpr double least_gain = 1e-9;          // metres: less is rounding
constexpr int64_t longest_insert = 3;        // strokes that Or-opt moves together
constexpr int64_t longest_kick = 10;         // strokes in each of the two runs that a disturbance exchanges
constexpr int64_t farthest_repair = 3000;    // strokes that a move after a disturbance touches; more would take longer

struct Move {                                // positions in the way, with the meanings that `perform` gives them
  enum Kind { none, reverse, exchange, insert } kind = none;
  int64_t i = 0, j = 0, k = 0;
  double gain = least_gain;
};

class Way {
 public:
  Way(const double* points, const uint8_t* reversible, const int32_t* near, const double* gaps, int64_t neighbours,
      int64_t strokes)
      : points_(points), reversible_(reversible), near_(near), gaps_(gaps), neighbours_(neighbours), strokes_(strokes),
        all_reversible_(std::all_of(reversible, reversible + strokes, [](uint8_t each) { return each; })),
        place_(strokes + 2), waits_(strokes + 2, 0) {
    start_with_nearest();
  }

  void shorten(int64_t disturbances) {
    for (int64_t k = 0; k <= strokes_; ++k) wake(k);
    search();
    if (strokes_ < 2) return;
    reach_ = farthest_repair;
    std::mt19937_64 rng(0);                  // any seed will do: it only says where to try
    auto below = [&](int64_t limit) { return int64_t(rng() % uint64_t(limit)); };
    for (int64_t n = 0; n < disturbances; ++n) {
      const int64_t first = 1 + below(std::min(longest_kick, strokes_ - 1));
      const int64_t second = 1 + below(std::min(longest_kick, strokes_ - first));
      const int64_t i = 1 + below(strokes_ - first - second + 1);
      takes_back_.clear();
      const Move kick{Move::exchange, i, i + first, i + first + second - 1, 0};
      double gained = exchange_gain(kick.i, kick.j, kick.k);
      perform(kick);
      gained += search();
      if (gained < 0) undo();
    }
  }

  const int32_t* begin() const { return at_.data() + 1; }
  const int32_t* end() const { return at_.data() + 1 + strokes_; }

 private:
  int32_t enter(int64_t k) const { return at_[k]; }
  int32_t leave(int64_t k) const { return at_[k] ^ 1; }

  double gap(int32_t from, int32_t to) const {
    if (to == 2 * strokes_ + 2) return 0;
    const double x = points_[2 * from] - points_[2 * to], y = points_[2 * from + 1] - points_[2 * to + 1];
    return std::sqrt(x * x + y * y);
  }
  double gap_after(int64_t k) const { return gap(leave(k), enter(k + 1)); }

  bool may_reverse(int64_t i, int64_t j) const {
    if (all_reversible_) return true;
    for (int64_t k = i; k <= j; ++k)
      if (!reversible_[at_[k] >> 1]) return false;
    return true;
  }

  void start_with_nearest() {
    std::vector<int32_t> left(strokes_), index(strokes_);
    for (int32_t s = 0; s < strokes_; ++s) left[s] = index[s] = s;
    at_.push_back(int32_t(2 * strokes_));
    while (!left.empty()) {
      const int32_t from = at_.back() ^ 1;
      const int32_t* row = near_ + from * neighbours_;
      const int32_t* free = std::find_if(row, row + neighbours_, [&](int32_t to) { return index[to >> 1] >= 0; });
      int32_t nearest = 2 * left.front();
      if (free != row + neighbours_) nearest = *free;
      else
        for (int32_t s : left)
          for (int32_t to = 2 * s; to <= 2 * s + (reversible_[s] ? 1 : 0); ++to)
            if (gap(from, to) < gap(from, nearest)) nearest = to;
      const int32_t taken = nearest >> 1;
      left[index[taken]] = left.back();
      index[left.back()] = index[taken];
      index[taken] = -1;
      left.pop_back();
      at_.push_back(nearest);
    }
    at_.push_back(int32_t(2 * strokes_ + 2));
    for (int64_t k = 0; k < int64_t(at_.size()); ++k) put(k, at_[k]);
  }

  void wake(int64_t k) {
    const int32_t stroke = at_[k] >> 1;
    if (stroke == strokes_ + 1 || waits_[stroke]) return;
    waits_[stroke] = 1;
    waiting_.push_back(stroke);
  }

  // Improve the way until no move near the waiting strokes gains anything; returns metres gained.
  double search() {
    double gained = 0;
    while (!waiting_.empty()) {
      const int32_t stroke = waiting_.back();
      waiting_.pop_back();
      waits_[stroke] = 0;
      for (Move best; best = best_at(place_[stroke]), best.kind != Move::none;) {
        gained += best.gain;
        perform(best);
      }
    }
    return gained;
  }

  Move best_at(int64_t k) const {
    Move best;
    after(k, best);
    if (k > 0) before(k, best);
    return best;
  }

  // Find moves that join the point where the stroke at k leaves to a point nearby.
  void after(int64_t k, Move& best) const {
    const int32_t a = leave(k);
    const double removed = gap_after(k);
    if (k < strokes_) exchanges(k, strokes_ + 1, removed, best);
    for (int64_t n = a * neighbours_; n < (a + 1) * neighbours_ && gaps_[n] < removed; ++n) {
      const int32_t c = near_[n];
      const int64_t m = place_[c >> 1];
      if (enter(m) == c) {
        exchanges(k, m, removed - gaps_[n], best);
      } else {
        if (m > k) turn(k + 1, m, best);
        else turn(m + 1, k, best);
        for (int64_t p = m; p > std::max<int64_t>(m - longest_insert, 0) && p != k + 1 && p != k; --p)
          insertion(p, m, k, best);
      }
    }
  }

  // Find moves that join the point where the stroke at k enters to a point nearby.
  void before(int64_t k, Move& best) const {
    const int32_t a = enter(k);
    const double removed = gap_after(k - 1);
    for (int64_t n = a * neighbours_; n < (a + 1) * neighbours_ && gaps_[n] < removed; ++n) {
      const int32_t c = near_[n];
      const int64_t m = place_[c >> 1];
      if (enter(m) != c || !(reversible_[a >> 1] || reversible_[c >> 1])) continue;
      if (m > k) turn(k, m - 1, best);
      else turn(m, k - 1, best);
      for (int64_t q = m; q < std::min(m + longest_insert, strokes_ + 1) && q != k - 1 && q != k; ++q)
        insertion(m, q, k - 1, best);
    }
  }

  void turn(int64_t i, int64_t j, Move& best) const {
    const double gain = gap_after(i - 1) + gap_after(j) - gap(leave(i - 1), leave(j)) - gap(enter(i), enter(j + 1));
    if (gain > best.gain && j - i < reach_ && may_reverse(i, j)) best = {Move::reverse, i, j, 0, gain};
  }

  // Insert the strokes from p to q, reversed, between those at g and g + 1.
  void insertion(int64_t p, int64_t q, int64_t g, Move& best) const {
    const double gain = gap_after(p - 1) + gap_after(q) + gap_after(g) - gap(leave(g), leave(q)) -
                        gap(enter(p), enter(g + 1)) - gap(leave(p - 1), enter(q + 1));
    if (gain > best.gain && std::abs(g - p) < reach_ && may_reverse(p, q)) best = {Move::insert, p, q, g, gain};
  }

  // Exchange two neighbouring runs so that the stroke at m follows the one at k, which alone gains `gained`.
  void exchanges(int64_t k, int64_t m, double gained, Move& best) const {
    const int32_t x = leave(m - 1);
    gained += gap_after(m - 1);
    const auto lead_to = [&](int64_t j, double added) {   // by joining the stroke that led to m to the one at j
      Move move{Move::exchange};
      if (m > k + 1 && j > m) move.i = k + 1, move.j = m, move.k = j - 1;
      else if (m > k + 1 && j <= k) move.i = j, move.j = k + 1, move.k = m - 1;
      else if (m < j && j <= k) move.i = m, move.j = j, move.k = k;
      else return;
      move.gain = gained - added + gap_after(j - 1);
      if (move.gain <= best.gain || move.k - move.i >= reach_) return;
      move.gain -= gap(leave(j - 1), enter(k + 1));
      if (move.gain > best.gain) best = move;
    };
    lead_to(strokes_ + 1, 0);
    for (int64_t n = x * neighbours_; n < (x + 1) * neighbours_ && gaps_[n] < gained; ++n) {
      const int64_t j = place_[near_[n] >> 1];
      if (enter(j) == near_[n]) lead_to(j, gaps_[n]);
    }
  }

  // Gain of exchanging the runs from i to j - 1 and from j to k.
  double exchange_gain(int64_t i, int64_t j, int64_t k) const {
    return gap_after(i - 1) + gap_after(j - 1) + gap_after(k) - gap(leave(i - 1), enter(j)) - gap(leave(k), enter(i)) -
           gap(leave(j - 1), enter(k + 1));
  }

  void perform(const Move& move) {
    const auto [kind, i, j, k, gain] = move;
    if (kind == Move::exchange) return exchange(i, j, k);
    reverse(i, j);
    if (kind == Move::reverse) return;
    if (j < k) exchange(i, j + 1, k);
    else exchange(k + 1, i, j);
  }

  void reverse(int64_t i, int64_t j) {
    turn_run(i, j);
    for (int64_t k : {i - 1, i, j, j + 1}) wake(k);
    takes_back_.push_back({Move::reverse, i, j});
  }

  void exchange(int64_t i, int64_t j, int64_t k) {
    exchange_runs(i, j, k);
    const int64_t second = i + k + 1 - j;    // where the second run begins now
    for (int64_t n : {i - 1, i, second - 1, second, k, k + 1}) wake(n);
    takes_back_.push_back({Move::exchange, i, second, k});
  }

  void undo() {
    for (; !takes_back_.empty(); takes_back_.pop_back()) {
      const auto [kind, i, j, k, gain] = takes_back_.back();
      if (kind == Move::reverse) turn_run(i, j);
      else exchange_runs(i, j, k);
    }
  }

  void put(int64_t k, int32_t element) {
    at_[k] = element;
    place_[element >> 1] = int32_t(k);
  }

  void turn_run(int64_t i, int64_t j) {
    for (; i <= j; ++i, --j) {
      const int32_t first = at_[i] ^ 1, last = at_[j] ^ 1;
      put(i, last);
      put(j, first);
    }
  }

  void exchange_runs(int64_t i, int64_t j, int64_t k) {
    was_.assign(at_.begin() + i, at_.begin() + k + 1);
    const int64_t first = j - i, both = k + 1 - i;
    for (int64_t n = first; n < both; ++n) put(i++, was_[n]);
    for (int64_t n = 0; n < first; ++n) put(i++, was_[n]);
  }

  const double* points_;
  const uint8_t* reversible_;
  const int32_t* near_;
  const double* gaps_;
  int64_t neighbours_, strokes_;
  bool all_reversible_;
  int64_t reach_ = INT64_MAX;                // a move touches fewer strokes than this
  std::vector<int32_t> at_;                  // elements in the order of the way
  std::vector<int32_t> place_;               // where each stroke is in it
  std::vector<int32_t> was_;                 // what an exchange overwrites
  std::vector<uint8_t> waits_;
  std::vector<int32_t> waiting_;             // strokes near which something changed
  std::vector<Move> takes_back_;             // moves that undo all since the last disturbance, the last first
};

// points: (2 N + 2, 2) ends of strokes, then the pen's first place twice. near: (2 N + 2, K) points where
// another stroke may begin, the nearest first; gaps: their distances. out: (N,) elements in the order of the way.
void shortest(Array<const double, 2> points, Array<const uint8_t, 1> reversible, Array<const int32_t, 2> near,
              Array<const double, 2> gaps, int64_t disturbances, Array<int32_t, 1> out) {
  nb::gil_scoped_release release;
  Way way(points.data(), reversible.data(), near.data(), gaps.data(), near.shape(1), reversible.shape(0));
  way.shorten(disturbances);
  std::copy(way.begin(), way.end(), out.data());
}

}  // namespace

NB_MODULE(_tour, m) { m.def("shortest", &shortest); }
