#include "tests/certificate/isometries.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <tuple>
#include <utility>

namespace tet::certificate {
namespace {

/// One of the 48 isometries that fix the lattice's axes.
struct Turn {
  std::array<std::uint8_t, 3> axis;
  std::array<int, 3> sign;

  Place operator()(const Place& at) const {
    return {sign[0] * at[axis[0]], sign[1] * at[axis[1]], sign[2] * at[axis[2]]};
  }
  bool reflects() const {
    const bool odd = (axis[0] > axis[1]) ^ (axis[0] > axis[2]) ^ (axis[1] > axis[2]);
    return odd ^ (sign[0] * sign[1] * sign[2] < 0);
  }
};

std::vector<Turn> make_turns() {
  std::vector<Turn> turns;
  for (std::uint8_t first = 0; first < 3; ++first) {
    for (std::uint8_t second = 0; second < 3; ++second) {
      if (second == first) continue;
      const auto third = static_cast<std::uint8_t>(3 - first - second);
      for (int bits = 0; bits < 8; ++bits) {
        turns.push_back({{first, second, third},
                         {bits & 1 ? -1 : 1, bits & 2 ? -1 : 1, bits & 4 ? -1 : 1}});
      }
    }
  }
  return turns;
}

/// Corners in ascending order, with the last two swapped where that keeps the orientation.
Tet sorted(Tet tet, bool reflected) {
  bool odd = reflected;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      if (tet[j] < tet[i]) {
        std::swap(tet[i], tet[j]);
        odd = !odd;
      }
    }
  }
  if (odd) std::swap(tet[2], tet[3]);
  return tet;
}

/// The least and the greatest coordinates of a problem's corners where no parameter moves them.
struct Extent {
  Place low, high;

  explicit Extent(const Problem& problem) : low(problem.tets[0][0].base), high(low) {
    for (const Tet& tet : problem.tets) {
      for (const Corner& corner : tet) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], corner.base[axis]);
          high[axis] = std::max(high[axis], corner.base[axis]);
        }
      }
    }
  }

  /// The lowest corner of the turned extent.
  Place lowest(const Turn& turn) const {
    const Place a = turn(low), b = turn(high);
    return {std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2])};
  }
};

/// The slides of a problem turned and moved to the origin, in ascending order.
struct TurnedSlides {
  std::size_t count;
  std::array<Slide, kParameters> slide{};
  std::array<std::uint8_t, kParameters> new_number{};
  Place lowest;

  TurnedSlides(const Problem& problem, const Extent& extent, const Turn& turn)
      : count(problem.parameter_count), lowest(extent.lowest(turn)) {
    std::array<Slide, kParameters> turned{};
    for (std::size_t k = 0; k < count; ++k) {
      const Slide& from = problem.slide[k];
      turned[k] = {moved(turn(from.base)), turn(from.along), from.range};
    }
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t other = 0; other < count; ++other) {
        if (turned[other] < turned[k]) ++new_number[k];
      }
    }
    for (std::size_t k = 0; k < count; ++k) slide[new_number[k]] = turned[k];
  }

  Place moved(const Place& at) const {
    return {at[0] - lowest[0], at[1] - lowest[1], at[2] - lowest[2]};
  }
};

std::vector<Tet> turned(const std::vector<Tet>& tets,
                        const TurnedSlides& slides,
                        const Turn& turn) {
  std::vector<Tet> all;
  all.reserve(tets.size());
  for (const Tet& tet : tets) {
    Tet corners;
    for (std::size_t i = 0; i < 4; ++i) {
      corners[i].base = slides.moved(turn(tet[i].base));
      for (std::size_t k = 0; k < slides.count; ++k) {
        corners[i].along[slides.new_number[k]] = turn(tet[i].along[k]);
      }
    }
    all.push_back(sorted(corners, turn.reflects()));
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// A problem turned, moved to the origin, and with everything in a fixed order.
Problem turned(const Problem& problem, const TurnedSlides& slides, const Turn& turn) {
  Problem out;
  out.name = problem.name;
  out.parameter_count = problem.parameter_count;
  out.slide = slides.slide;
  for (const auto& [longer, shorter] : problem.orders) {
    out.orders.push_back({slides.new_number[longer], slides.new_number[shorter]});
  }
  std::sort(out.orders.begin(), out.orders.end());
  out.tets = turned(problem.tets, slides, turn);
  out.contender = turned(problem.contender, slides, turn);
  out.rival = turned(problem.rival, slides, turn);
  return out;
}

struct LessGeometry {
  bool operator()(const Problem& a, const Problem& b) const {
    return std::tie(a.name, a.slide, a.orders, a.tets, a.contender, a.rival) <
           std::tie(b.name, b.slide, b.orders, b.tets, b.contender, b.rival);
  }
};

/// The least of all turns of a problem. Slides are compared first, and only what ties with the
/// least of them is turned whole, since that takes far longer.
Problem least_turn(const Problem& problem, const std::vector<Turn>& turns) {
  const Extent extent(problem);
  std::vector<std::pair<TurnedSlides, const Turn*>> least;
  for (const Turn& turn : turns) {
    const TurnedSlides slides(problem, extent, turn);
    if (!least.empty()) {
      const auto order = slides.slide <=> least.front().first.slide;
      if (order > 0) continue;
      if (order < 0) least.clear();
    }
    least.emplace_back(slides, &turn);
  }
  Problem best = turned(problem, least.front().first, *least.front().second);
  for (std::size_t i = 1; i < least.size(); ++i) {
    Problem other = turned(problem, least[i].first, *least[i].second);
    if (LessGeometry{}(other, best)) best = std::move(other);
  }
  return best;
}

}  // namespace

std::vector<Problem> without_copies(const std::vector<Problem>& problems) {
  static const std::vector<Turn> turns = make_turns();
  std::set<Problem, LessGeometry> distinct;
  for (const Problem& problem : problems) distinct.insert(least_turn(problem, turns));
  return {distinct.begin(), distinct.end()};
}

}  // namespace tet::certificate
