#include "core/labels/label_tets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/base/tet_geometry.h"
#include "core/labels/label_tables.h"
#include "core/stuffing/cut_tet.h"

namespace tet {
namespace {

double square_of_cosine(double degrees) noexcept {
  const double cosine = std::cos(degrees * std::numbers::pi / 180);
  return cosine * cosine;
}

/// What a division costs that is exactly good. The greatest angle is weighed so that both
/// limits cost the same: whatever is best is good if anything is.
const double kGoodCost = square_of_cosine(kGoodLeast);
const double kObtuseCost = kGoodCost / square_of_cosine(kGoodGreatest);
constexpr double kInverted = std::numeric_limits<double>::infinity();

/// The larger of cos^2 of the least angle and the weighted one of the greatest, both with the
/// sign of what is bad.
double cost_of(const WorldPoint& a,
               const WorldPoint& b,
               const WorldPoint& c,
               const WorldPoint& d) noexcept {
  const std::array<Vector, 4> normal = face_normals(a, b, c, d);
  if (!(dot(from_to(a, b), normal[1]) > 0)) return kInverted;
  std::array<double, 4> square;
  for (std::size_t i = 0; i < 4; ++i) square[i] = dot(normal[i], normal[i]);
  double worst = -1;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double product = dot(normal[i], normal[j]);  // minus the cosine, times the areas
      const double cosine = product * std::abs(product) / (square[i] * square[j]);
      worst = std::max({worst, -cosine, kObtuseCost * cosine});
    }
  }
  return worst;
}

/// The places of a tet's corners, positive as `shape` has its nodes.
struct CornerPlaces {
  std::array<WorldPoint, kLabelCorners> at;
  bool negative;

  /// `of` may be a LabelTetCorners or one in other names.
  double cost(const LabelTetCorners& tet) const noexcept {
    const auto [a, b, c, d] = tet;
    return negative ? cost_of(at[a], at[b], at[d], at[c]) : cost_of(at[a], at[b], at[c], at[d]);
  }
};

/// The nodes of a tet by role, and what each corner is called there.
class Roles {
 public:
  /// A1, A2, B, C of a tet of three labels.
  explicit Roles(const std::array<Label, 4>& label) noexcept {
    const auto [first, second] = pair_of(label);
    node_ = {first, second, 0, 0};
    std::size_t next = 2;
    for (std::uint8_t i = 0; i < 4; ++i) {
      if (i != first && i != second) node_[next++] = i;
    }
    int inversions = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) inversions += node_[i] > node_[j] ? 1 : 0;
    }
    odd_ = inversions % 2 != 0;
  }

  std::uint8_t operator[](std::size_t role) const noexcept { return node_[role]; }
  bool odd() const noexcept { return odd_; }

  LabelCorner corner(LabelCorner in_roles) const noexcept {
    if (in_roles < 4) return node_[in_roles];
    if (in_roles == kLabelMiddle) return kLabelMiddle;
    if (in_roles >= 10) return label_triple(node_[in_roles - std::size_t{10}]);
    const auto [a, b] = kTetEdge[in_roles - std::size_t{4}];
    return label_cut(node_[a], node_[b]);
  }
  LabelTetCorners corners(const LabelTetCorners& in_roles) const noexcept {
    LabelTetCorners tet{corner(in_roles[0]), corner(in_roles[1]), corner(in_roles[2]),
                        corner(in_roles[3])};
    if (odd_) std::swap(tet[2], tet[3]);
    return tet;
  }

 private:
  static std::pair<std::uint8_t, std::uint8_t> pair_of(
      const std::array<Label, 4>& label) noexcept {
    for (std::uint8_t i = 0; i < 3; ++i) {
      for (std::uint8_t j = static_cast<std::uint8_t>(i + 1); j < 4; ++j) {
        if (label[i] == label[j]) return {i, j};
      }
    }
    return {0, 1};
  }

  std::array<std::uint8_t, 4> node_{};
  bool odd_ = false;
};

/// Whether the diagonal of the quad that two nodes of one label leave on the face with `other`
/// starts at the second of them: that of the longer column, or else the lower.
bool second_starts(const LabelledTet& tet,
                   std::size_t first,
                   std::size_t second,
                   std::size_t other) noexcept {
  const auto column = [&](std::size_t node) {
    const float fraction = tet.fraction[edge_between(node, other)];
    return node < other ? fraction : 1 - fraction;
  };
  return column(second) > column(first);
}

/// Two nodes of one label, A, and two other labels.
class ThreeLabels {
 public:
  explicit ThreeLabels(const LabelledTet& tet) noexcept
      : tet_(tet),
        places_(tet, {}),
        roles_(tet.label),
        starts_{second_starts(tet, roles_[0], roles_[1], roles_[2]),
                second_starts(tet, roles_[0], roles_[1], roles_[3])} {
    corner_.negative = tet.shape.negative != roles_.odd();
    for (LabelCorner role = 0; role < 4; ++role) {
      corner_.at[role] = places_.node(roles_[role]);
    }
    for (std::size_t e = 1; e < kTetEdge.size(); ++e) {  // A1 and A2 are alike
      const auto [a, b] = kTetEdge[e];
      corner_.at[4 + e] = places_.cut(edge_between(roles_[a], roles_[b]));
    }
    for (const std::size_t opposite : {std::size_t{0}, std::size_t{1}}) {
      corner_.at[label_triple(opposite)] = places_.triple(roles_[opposite]);
    }
  }

  void divide(LabelDivision& out) noexcept {
    const Twelve twelve = best_twelve();
    if (twelve.cost <= kGoodCost) {
      for (std::size_t side = 0; side < 2; ++side) {
        const std::size_t diagonal = twelve.diagonal[side];
        add(kLabelHalves[side][starts_[side] ? 1 : 0][twelve.shared][diagonal], out);
        add(kLabelParts[side][diagonal], out);
      }
      return;
    }
    add(fan_tets(), out);
    out.middle = cost_of_fan(LabelMiddle::kOfTriples) <= kGoodCost ? LabelMiddle::kOfTriples
                                                                   : LabelMiddle::kOfNodes;
  }

 private:
  struct Twelve {
    double cost = kInverted;
    std::size_t shared = 0;                 ///< diagonal of A1 T1 T2 A2
    std::array<std::size_t, 2> diagonal{};  ///< towards B and C
  };

  const internal::RoleTets<18>& fan_tets() const noexcept {
    return kLabelFans[starts_[0] ? 1 : 0][starts_[1] ? 1 : 0];
  }

  template <class Tets>
  double cost_of_all(const Tets& tets) const noexcept {
    double worst = tets.count == 0 ? kInverted : -1;
    for (std::size_t i = 0; i < tets.count; ++i) {
      worst = std::max(worst, corner_.cost(tets.tet[i]));
    }
    return worst;
  }

  /// The combination of least cost; of equal ones the first. On either side of the quad
  /// A1 T1 T2 A2 the choice is free.
  Twelve best_twelve() const noexcept {
    std::array<std::array<double, 2>, 2> part;
    for (std::size_t i = 0; i < 4; ++i) {
      part[i >> 1][i & 1] = cost_of_all(kLabelParts[i >> 1][i & 1]);
    }
    Twelve best;
    for (std::size_t shared = 0; shared < 2; ++shared) {
      Twelve found{-1, shared, {}};
      for (std::size_t side = 0; side < 2; ++side) {
        std::array<double, 2> cost;
        for (std::size_t d = 0; d < 2; ++d) {
          cost[d] = std::max(part[side][d],
                             cost_of_all(kLabelHalves[side][starts_[side] ? 1 : 0][shared][d]));
        }
        found.diagonal[side] = cost[1] < cost[0] ? 1 : 0;
        found.cost = std::max(found.cost, cost[found.diagonal[side]]);
      }
      if (found.cost < best.cost) best = found;
    }
    return best;
  }

  double cost_of_fan(LabelMiddle middle) noexcept {
    corner_.at[kLabelMiddle] = places_.middle(middle);
    return cost_of_all(fan_tets());
  }

  template <class Tets>
  void add(const Tets& tets, LabelDivision& out) const noexcept {
    for (std::size_t i = 0; i < tets.count; ++i) {
      out.add(roles_.corners(tets.tet[i]), tet_.label[roles_[tets.role[i]]]);
    }
  }

  const LabelledTet& tet_;
  const LabelPlaces places_;
  const Roles roles_;
  const std::array<bool, 2> starts_;
  CornerPlaces corner_;
};

void divide_four_labels(const LabelledTet& tet, LabelDivision& out) noexcept {
  const LabelPlaces places(tet, {});
  CornerPlaces corner;
  corner.negative = tet.shape.negative;
  for (LabelCorner i = 0; i < 4; ++i) {
    corner.at[i] = places.node(i);
    corner.at[label_triple(i)] = places.triple(i);
  }
  for (std::size_t e = 0; e < kTetEdge.size(); ++e) corner.at[4 + e] = places.cut(e);
  corner.at[kLabelMiddle] = places.middle(LabelMiddle::kOfTriples);
  double cost = -1;
  for (const LabelTetCorners& corners : kFourLabels.tet) {
    cost = std::max(cost, corner.cost(corners));
  }
  out.middle = cost <= kGoodCost ? LabelMiddle::kOfTriples : LabelMiddle::kOfNodes;
  for (std::size_t i = 0; i < kFourLabels.count; ++i) {
    out.add(kFourLabels.tet[i], tet.label[kFourLabels.role[i]]);
  }
}

/// What the present rules make of two labels: each sees itself as `+`, the lower one as the
/// inside.
void divide_two_labels(const LabelledTet& tet,
                       Label low,
                       Label high,
                       LabelDivision& out) noexcept {
  static constexpr StuffingRules kBothSides{.limits = {}, .both_sides = true};
  for (const Label label : {low, high}) {
    const auto sign = [&](std::size_t i) {
      if (tet.label[i] == kJoker) return NodeSign::kZero;
      return tet.label[i] == label ? NodeSign::kPlus : NodeSign::kMinus;
    };
    const std::size_t number = stencil_number(sign(0), sign(1), sign(2), sign(3));
    const MeshRegion region = label == low ? MeshRegion::kInside : MeshRegion::kOutside;
    const CutTet cut(tet.shape, number, tet.fraction, region, kBothSides);
    for (auto [a, b, c, d] : cut.tets()) {
      const auto corner = [](StencilVertex v) { return v == kQuadCentre ? kLabelMiddle : v; };
      out.add({corner(a), corner(b), corner(c), corner(d)}, label);
    }
    if (cut.has_fan()) out.middle = LabelMiddle::kOfCuts;
  }
}

void divide_cone(const LabelledTet& tet, LabelDivision& out) noexcept {
  const auto joker =
      static_cast<std::size_t>(std::ranges::find(tet.label, kJoker) - tet.label.begin());
  const auto& cone = kJokerCones[joker];
  for (std::size_t i = 0; i < cone.count; ++i) {
    out.add(cone.tet[i], tet.label[cone.role[i]]);
  }
}

/// Different labels of a tet's nodes, ascending.
struct TetLabels {
  std::array<Label, 4> label;
  std::size_t count = 0, jokers = 0;

  explicit TetLabels(std::array<Label, 4> of) noexcept : label(of) {
    std::ranges::sort(label);
    for (std::size_t i = 0; i < 4 && label[i] != kJoker; ++i) {
      if (count == 0 || label[count - 1] != label[i]) label[count++] = label[i];
    }
    jokers = static_cast<std::size_t>(std::ranges::count(of, kJoker));
  }
};

}  // namespace

Label elected(const JokerVotes& votes) noexcept {
  std::array<Label, 8> all;
  for (std::size_t i = 0; i < 8; ++i) all[i] = votes[i >> 1][i & 1];
  std::ranges::sort(all);
  Label best = all[0];
  std::size_t most = 0;
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && all[end] == all[begin]) ++end;
    if (end - begin < most) continue;
    most = end - begin;
    best = all[begin];
  }
  return best;
}

void divide(const LabelledTet& tet, const JokerVotes& votes, LabelDivision& out) noexcept {
  out.count = 0;
  out.middle = LabelMiddle::kNone;
  const TetLabels labels(tet.label);
  if (labels.count < 2) {
    out.add({0, 1, 2, 3}, labels.count == 1 ? labels.label[0] : elected(votes));
  } else if (labels.count == 2) {
    divide_two_labels(tet, labels.label[0], labels.label[1], out);
  } else if (labels.jokers == 1) {
    divide_cone(tet, out);
  } else if (labels.count == 3) {
    ThreeLabels(tet).divide(out);
  } else {
    divide_four_labels(tet, out);
  }
}

WorldPoint LabelPlaces::node(std::size_t i) const noexcept {
  const LatticeCoord at =
      node_coord(tet_.shape.kind[i], halo_index(0, 0, 0) + tet_.shape.offset[i]) + cell_;
  return {0.5 * at.x, 0.5 * at.y, 0.5 * at.z};
}

WorldPoint LabelPlaces::cut(std::size_t edge) const noexcept {
  const std::size_t low = kTetEdge[edge][0];
  return place_on_edge(
      node_coord(tet_.shape.kind[low], halo_index(0, 0, 0) + tet_.shape.offset[low]) + cell_,
      family_direction(tet_.shape.edge_family[edge]), tet_.fraction[edge]);
}

WorldPoint LabelPlaces::triple(std::size_t opposite_node) const noexcept {
  const auto [a, b, c] = nodes_of_face(opposite_node);
  return triple_place(cut(edge_between(a, b)), cut(edge_between(b, c)),
                      cut(edge_between(a, c)));
}

bool LabelPlaces::is_cut(std::size_t edge) const noexcept {
  const auto [a, b] = kTetEdge[edge];
  return tet_.label[a] != tet_.label[b] && tet_.label[a] != kJoker && tet_.label[b] != kJoker;
}

bool LabelPlaces::is_triple(std::size_t opposite_node) const noexcept {
  const auto [a, b, c] = nodes_of_face(opposite_node);
  return is_cut(edge_between(a, b)) && is_cut(edge_between(b, c)) && is_cut(edge_between(a, c));
}

WorldPoint LabelPlaces::middle(LabelMiddle of) const noexcept {
  WorldPoint sum;
  int count = 0;
  const auto add = [&](const WorldPoint& place) {
    sum = {sum.x + place.x, sum.y + place.y, sum.z + place.z};
    ++count;
  };
  for (std::size_t e = 0; of == LabelMiddle::kOfCuts && e < kTetEdge.size(); ++e) {
    if (is_cut(e)) add(cut(e));
  }
  for (std::size_t i = 0; of != LabelMiddle::kOfCuts && i < 4; ++i) {
    if (of == LabelMiddle::kOfNodes) add(node(i));
    // With three labels the lower A's opposite face comes first.
    if (of == LabelMiddle::kOfTriples && is_triple(i)) add(triple(i));
  }
  const double share = 1.0 / count;  // a half or a quarter
  return {share * sum.x, share * sum.y, share * sum.z};
}

}  // namespace tet
