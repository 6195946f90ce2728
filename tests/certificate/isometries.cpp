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

/// A problem turned, moved to the origin, and with everything in a fixed order.
class TurnedProblem {
 public:
  TurnedProblem(const Problem& problem, const Turn& turn) : problem_(problem), turn_(turn) {
    const auto slide = [&](std::size_t k) {
      const Slide& from = problem.slide[k];
      return Slide{turn(from.base), turn(from.along), from.range};
    };
    for (std::size_t k = 0; k < problem.parameter_count; ++k) {
      for (std::size_t other = 0; other < problem.parameter_count; ++other) {
        if (slide(other) < slide(k)) ++new_number_[k];
      }
    }
    find_lowest();
    for (std::size_t k = 0; k < problem.parameter_count; ++k) {
      out.slide[new_number_[k]] = slide(k);
      out.slide[new_number_[k]].base = moved(out.slide[new_number_[k]].base);
    }
    for (const auto& [longer, shorter] : problem.orders) {
      out.orders.push_back({new_number_[longer], new_number_[shorter]});
    }
    std::sort(out.orders.begin(), out.orders.end());
    out.tets = turned(problem.tets);
    out.contender = turned(problem.contender);
    out.rival = turned(problem.rival);
    out.name = problem.name;
    out.parameter_count = problem.parameter_count;
  }

  Problem out;

 private:
  void find_lowest() {
    lowest_ = turn_(problem_.tets[0][0].base);
    for (const Tet& tet : problem_.tets) {
      for (const Corner& corner : tet) {
        const Place at = turn_(corner.base);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          lowest_[axis] = std::min(lowest_[axis], at[axis]);
        }
      }
    }
  }

  Place moved(const Place& at) const {
    return {at[0] - lowest_[0], at[1] - lowest_[1], at[2] - lowest_[2]};
  }

  std::vector<Tet> turned(const std::vector<Tet>& tets) const {
    std::vector<Tet> all;
    for (const Tet& tet : tets) {
      Tet corners;
      for (std::size_t i = 0; i < 4; ++i) {
        corners[i].base = moved(turn_(tet[i].base));
        for (std::size_t k = 0; k < problem_.parameter_count; ++k) {
          corners[i].along[new_number_[k]] = turn_(tet[i].along[k]);
        }
      }
      all.push_back(sorted(corners, turn_.reflects()));
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  const Problem& problem_;
  const Turn& turn_;
  std::array<std::uint8_t, kParameters> new_number_{};
  Place lowest_{};
};

struct LessGeometry {
  bool operator()(const Problem& a, const Problem& b) const {
    return std::tie(a.name, a.slide, a.orders, a.tets, a.contender, a.rival) <
           std::tie(b.name, b.slide, b.orders, b.tets, b.contender, b.rival);
  }
};

}  // namespace

std::vector<Problem> without_copies(const std::vector<Problem>& problems) {
  static const std::vector<Turn> turns = make_turns();
  std::set<Problem, LessGeometry> distinct;
  for (const Problem& problem : problems) {
    Problem least = TurnedProblem(problem, turns[0]).out;
    for (std::size_t i = 1; i < turns.size(); ++i) {
      Problem other = TurnedProblem(problem, turns[i]).out;
      if (LessGeometry{}(other, least)) least = std::move(other);
    }
    distinct.insert(std::move(least));
  }
  return {distinct.begin(), distinct.end()};
}

}  // namespace tet::certificate
