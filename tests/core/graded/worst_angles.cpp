#include "tests/core/graded/worst_angles.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <random>

#include "core/base/dihedral.h"
#include "core/base/tet_geometry.h"
#include "core/graded/split_tet.h"

namespace tet::test {
namespace {

WorldPoint along(LatticeCoord from, LatticeCoord way, double t) {
  return {from.x + t * way.x, from.y + t * way.y, from.z + t * way.z};
}

/// A range that a cut point or a moved node slides in.
struct Slide {
  double low = 0, high = 0;
};

/// One choice of signs, and of edges for the `0` nodes.
class Trial {
 public:
  Trial(const PlacedTet& tet, const GradedLimits& limits, std::size_t number)
      : tet_(tet), limits_(limits) {
    for (std::size_t i = 0; i < 4; ++i, number /= 3) {
      split_.sign[i] = static_cast<NodeSign>(number % 3);
      split_.place[i] = along(tet[i].at, {}, 0);
      if (split_.sign[i] == NodeSign::kZero) zeros_.push_back(i);
    }
    for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
      if (split_.is_cut(kTetEdge[e][0], kTetEdge[e][1])) cuts_.push_back(e);
    }
  }

  bool matters() const {
    return std::ranges::count(split_.sign, NodeSign::kPlus) > 0 &&
           std::ranges::count(split_.sign, NodeSign::kPlus) < 4;
  }
  std::size_t combinations() const {
    std::size_t all = 1;
    for (const std::size_t node : zeros_) all *= tet_[node].edges.size();
    return all;
  }

  /// False where two nodes would have moved towards each other, along their one edge.
  bool choose(std::size_t combination) {
    for (const std::size_t node : zeros_) {
      const auto& edges = tet_[node].edges;
      way_[node] = edges[combination % edges.size()].along;
      part_[node] = part(node, edges[combination % edges.size()]);
      combination /= edges.size();
    }
    for (const std::size_t a : zeros_) {
      for (const std::size_t b : zeros_) {
        const LatticeCoord between = tet_[b].at - tet_[a].at;
        if (a != b && way_[a] == between && way_[b] == LatticeCoord{} - between) return false;
      }
    }
    slides_.clear();
    for (const std::size_t node : zeros_) {
      slides_.push_back({0, part_[node]});
    }
    for (const std::size_t e : cuts_) {
      const auto [low, high] = kTetEdge[e];
      const LatticeCoord along = tet_[high].at - tet_[low].at;
      slides_.push_back({part(low, {along, tet_[high].kind}),
                         1 - part(high, {LatticeCoord{} - along, tet_[low].kind})});
    }
    return true;
  }

  /// Calls `visit` with every corner of the ranges; of those with cut points, their middles,
  /// too.
  template <class Visit>
  void for_each_corner(const Visit& visit) const {
    const std::size_t steps = cuts_.empty() ? 2 : 3;
    std::array<double, 4> at{};
    std::size_t count = 1;
    for (std::size_t k = 0; k < slides_.size(); ++k) count *= steps;
    for (std::size_t i = 0; i < count; ++i) {
      std::size_t rest = i;
      for (std::size_t k = 0; k < slides_.size(); ++k, rest /= steps) {
        const auto [low, high] = slides_[k];
        at[k] = low + static_cast<double>(rest % steps) * (high - low) /
                          static_cast<double>(steps - 1);
      }
      visit(at);
    }
  }

  /// sign(cos) cos^2 of the least and the greatest angle of the tets that stand for it.
  AngleRange angles(const std::array<double, 4>& at) {
    std::array<WorldPoint, kStencilVertices> place{};
    std::size_t next = 0;
    for (std::size_t i = 0; i < 4; ++i) place[i] = along(tet_[i].at, {}, 0);
    for (const std::size_t node : zeros_)
      place[node] = along(tet_[node].at, way_[node], at[next++]);
    for (const std::size_t e : cuts_) {
      const auto [low, high] = kTetEdge[e];
      split_.fraction[e] = static_cast<float>(at[next]);
      place[cut_on_edge(e)] = along(tet_[low].at, tet_[high].at - tet_[low].at, at[next++]);
    }
    AngleRange range;
    for (const auto& [a, b, c, d] : split_.tets()) {
      const auto normals = face_normals(place[a], place[b], place[c], place[d]);
      const bool positive = dot(from_to(place[b], place[a]), normals[0]) > 0;
      if (!positive) return {1, -1};
      for (const double cosine : dihedral_cosines(normals)) range.add(cosine);
    }
    return range;
  }

  /// From there to where no small step makes the least angle smaller.
  double descend(std::array<double, 4> at, std::mt19937& random) {
    double worst = angles(at).largest_cosine;
    double step = 0.1;
    while (step > 1e-3) {
      for (int i = 0; i < 12; ++i) {
        std::array<double, 4> near = at;
        for (std::size_t k = 0; k < slides_.size(); ++k) {
          const double turn = 2 * static_cast<double>(random()) / 4294967295.0 - 1;
          const auto [low, high] = slides_[k];
          near[k] = std::clamp(near[k] + step * turn * (high - low), low, high);
        }
        const double cosine = angles(near).largest_cosine;
        if (cosine <= worst) continue;
        worst = cosine;
        at = near;
      }
      step *= 0.8;
    }
    return worst;
  }

  std::string signs() const {
    std::string text;
    for (const NodeSign sign : {NodeSign::kPlus, NodeSign::kZero, NodeSign::kMinus}) {
      const auto count = static_cast<std::size_t>(std::ranges::count(split_.sign, sign));
      text += std::string(count, sign == NodeSign::kPlus   ? '+'
                                 : sign == NodeSign::kZero ? '0'
                                                           : '-');
    }
    return text;
  }

 private:
  double part(std::size_t node, const PlacedNode::Edge& edge) const {
    return limits_.part({tet_[node].kind, edge.to, edge.along, tet_[node].level});
  }

  const PlacedTet& tet_;
  const GradedLimits& limits_;
  SplitTet split_;
  std::vector<std::size_t> zeros_, cuts_;
  std::array<LatticeCoord, 4> way_{};
  std::array<double, 4> part_{};
  std::vector<Slide> slides_;
};

}  // namespace

WorstAngles worst_angles(const PlacedTet& tet, const GradedLimits& limits, double enough_deg) {
  std::mt19937 random(1);
  const double enough = signed_square_of_cosine(enough_deg);
  AngleRange all;
  WorstAngles worst;
  for (std::size_t number = 0; number < kStencilCases; ++number) {
    Trial trial(tet, limits, number);
    if (!trial.matters()) continue;
    for (std::size_t combination = 0; combination < trial.combinations(); ++combination) {
      if (!trial.choose(combination)) continue;
      trial.for_each_corner([&](const std::array<double, 4>& at) {
        const AngleRange range = trial.angles(at);
        const double before = all.largest_cosine;
        all.add(range);
        if (range.largest_cosine <= before) return;
        all.add(trial.descend(at, random));
        worst.min_signs = trial.signs();
      });
      if (all.largest_cosine > enough) break;
    }
  }
  worst.min_deg = degrees_of(all.largest_cosine);
  worst.max_deg = degrees_of(all.smallest_cosine);
  return worst;
}

}  // namespace tet::test
