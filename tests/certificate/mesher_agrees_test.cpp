// What the mesher writes is among the cases that are proven.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "core/lattice/background.h"
#include "core/plan/mesh_request.h"
#include "core/stuffing/cut_tet.h"
#include "tests/certificate/contest.h"
#include "tests/certificate/stuffing_cases.h"
#include "tests/core/stuffing/stuff.h"
#include "tests/support/solids.h"

namespace tet::certificate {
namespace {

constexpr double kNear = 1e-6;

using Point = std::array<double, 3>;
using MesherTet = std::array<Point, 4>;

/// A lattice tet of a stuffed brick, and its parameters as they really are.
class RealTet {
 public:
  RealTet(const StuffedLattice& lattice, const TetShape& shape, int cell)
      : signed_tet_(unsigned_tet(shape)), lattice_(lattice), shape_(shape), cell_(cell) {
    for (std::size_t i = 0; i < 4; ++i) {
      const int node = cell + shape.offset[i];
      const NodeKind kind = shape.kind[i];
      signed_tet_.sign[i] = lattice.warped.zero[kind].test(node)   ? NodeSign::kZero
                            : lattice.warped.plus[kind].test(node) ? NodeSign::kPlus
                                                                   : NodeSign::kMinus;
      signed_tet_.direction[i] =
          lattice.warped.warped[kind].test(node)
              ? lattice.warped.direction[kind][static_cast<std::size_t>(node)]
              : 0;
    }
  }

  const SignedTet& signs() const { return signed_tet_; }

  /// A place of the mesher, in the units and from the origin of the proof.
  Point moved(const WorldPoint& at) const {
    const Cell origin(cell_);
    return {kSpacing * (at.x - origin.x), kSpacing * (at.y - origin.y),
            kSpacing * (at.z - origin.z)};
  }

  /// How far along its slide a warped node or a cut point lies.
  double parameter(const Slide& slide) const {
    for (std::size_t i = 0; i < 4; ++i) {
      if (slide.base != place_of_node(i)) continue;
      if (signed_tet_.sign[i] == NodeSign::kZero) {
        return along(slide, lattice_.place_of_node(shape_.kind[i], cell_ + shape_.offset[i]));
      }
      for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
        const auto [low, high] = kTetEdge[e];
        const std::size_t other = low == i ? high : low;
        if ((low != i && high != i) || !leads_to(slide, other)) continue;
        return along(slide,
                     lattice_.place_of_cut(shape_.edge_family[e], cell_ + shape_.offset[low]));
      }
    }
    ADD_FAILURE() << "no such slide";
    return 0;
  }

 private:
  Place place_of_node(std::size_t i) const {
    const LatticeCoord at = signed_tet_.node[i];
    return {kUnit * at.x, kUnit * at.y, kUnit * at.z};
  }
  bool leads_to(const Slide& slide, std::size_t node) const {
    const Place end = place_of_node(node);
    return slide.base[0] + slide.along[0] == end[0] &&
           slide.base[1] + slide.along[1] == end[1] && slide.base[2] + slide.along[2] == end[2];
  }
  double along(const Slide& slide, const WorldPoint& place) const {
    const Point at = moved(place);
    double dot = 0, square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      dot += (at[axis] - slide.base[axis]) * slide.along[axis];
      square += slide.along[axis] * slide.along[axis];
    }
    return dot / square;
  }

  SignedTet signed_tet_;
  const StuffedLattice& lattice_;
  const TetShape& shape_;
  int cell_;
};

bool holds(const Problem& problem, const std::array<double, kParameters>& t) {
  for (std::size_t k = 0; k < problem.parameter_count; ++k) {
    const Range& range = problem.slide[k].range;
    if (t[k] < range.low - kNear || t[k] > range.high + kNear) return false;
  }
  for (const auto& [longer, shorter] : problem.orders) {
    if (t[longer] < t[shorter] - kNear) return false;
  }
  if (problem.rival.empty()) return true;
  const RoundUpward upward;
  Box box{};
  for (std::size_t k = 0; k < problem.parameter_count; ++k) box[k] = Interval(t[k]);
  return !Contest(problem, box).lost();
}

bool same(const Tet& tet, const std::array<double, kParameters>& t, const MesherTet& written) {
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double at = tet[i].base[axis];
      for (std::size_t k = 0; k < kParameters; ++k) at += t[k] * tet[i].along[k][axis];
      if (std::abs(at - written[i][axis]) > kNear) return false;
    }
  }
  return true;
}

/// Whether some problem has the tet, with these parameters within its ranges and orders.
bool is_case(const std::vector<Problem>& problems,
             const RealTet& real,
             const MesherTet& written) {
  return std::any_of(problems.begin(), problems.end(), [&](const Problem& problem) {
    std::array<double, kParameters> t{};
    for (std::size_t k = 0; k < problem.parameter_count; ++k) {
      t[k] = real.parameter(problem.slide[k]);
    }
    return holds(problem, t) &&
           std::any_of(problem.tets.begin(), problem.tets.end(),
                       [&](const Tet& tet) { return same(tet, t, written); });
  });
}

/// Where the mesher puts a corner of a stencil.
WorldPoint place_of(StencilVertex vertex,
                    const StuffedLattice& lattice,
                    const TetShape& shape,
                    int cell) {
  if (vertex < 4) {
    return lattice.place_of_node(shape.kind[vertex], cell + shape.offset[vertex]);
  }
  const auto place_of_cut = [&](std::size_t edge) {
    return lattice.place_of_cut(shape.edge_family[edge],
                                cell + shape.offset[kTetEdge[edge][0]]);
  };
  if (vertex != kQuadCentre) return place_of_cut(static_cast<std::size_t>(vertex - 4));
  WorldPoint sum;
  for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
    if (!lattice.warped.cut[shape.edge_family[e]].test(cell + shape.offset[kTetEdge[e][0]])) {
      continue;
    }
    const WorldPoint cut = place_of_cut(e);
    sum = {sum.x + cut.x, sum.y + cut.y, sum.z + cut.z};
  }
  return {0.25 * sum.x, 0.25 * sum.y, 0.25 * sum.z};
}

/// Tets of one region of a brick, and how many of them no case has.
struct Comparison {
  std::size_t tets = 0, unknown = 0;
};

void compare(const StuffedLattice& lattice,
             const FinestNodes& nodes,
             const StuffingRules& rules,
             Comparison& out) {
  for (int axis = 0; axis < 3; ++axis) {
    const FaceSigns faces = signs_around_faces(nodes, axis);
    for (const TetShape& shape : shapes_across(axis)) {
      const ShapeSigns signs = signs_of_shape(faces, shape);
      for_each_bit(signs.cut | signs.whole, [&](int cell) {
        const RealTet real(lattice, shape, cell);
        const auto problems = problems_of(real.signs(), rules);
        const EdgeFractions fraction = edge_fractions(lattice, shape, cell);
        const CutTet cut_tet(shape, stencil_number(signs, cell), fraction, signs.region, rules);
        const std::array<std::array<StencilVertex, 4>, 1> whole{{{0, 1, 2, 3}}};
        for (auto vertices : signs.cut.test(cell) ? cut_tet.tets() : std::span(whole)) {
          if (shape.negative) std::swap(vertices[2], vertices[3]);
          MesherTet written;
          for (std::size_t i = 0; i < 4; ++i) {
            written[i] = real.moved(place_of(vertices[i], lattice, shape, cell));
          }
          ++out.tets;
          out.unknown += is_case(problems, real, written) ? 0 : 1;
        }
      });
    }
  }
}

TEST(Cases, HoldEveryTetTheMesherWrites) {
  for (const Preset preset : {Preset::kDefault, Preset::kBothSides}) {
    const StuffingRules rules = stuffing_rules(preset);
    for (const int zero_every : {0, 3}) {
      const auto stuffed =
          test::stuff(test::random_signs(16, 31, zero_every), {0, 0, 0}, rules.limits);
      const auto lattice =
          std::make_unique<StuffedLattice>(StuffedLattice{stuffed->cuts, stuffed->warped});
      FinestNodes nodes;
      nodes.plus = lattice->warped.plus;
      nodes.zero = lattice->warped.zero;
      nodes.leaf = halo_cube(kNodeMin, kNodeMax);
      Comparison found;
      compare(*lattice, nodes, rules, found);
      if (rules.both_sides) compare(*lattice, seen_from_outside(nodes), rules, found);
      EXPECT_GT(found.tets, 3000U);
      EXPECT_EQ(found.unknown, 0U);
    }
  }
}

}  // namespace
}  // namespace tet::certificate
