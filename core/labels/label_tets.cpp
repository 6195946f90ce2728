#include "core/labels/label_tets.h"

#include <algorithm>
#include <utility>

#include "core/labels/label_tables.h"
#include "core/stuffing/cut_tet.h"

namespace tet {
namespace {

/// Middles in the order in which they are tried; the last one is taken if no other is good.
constexpr std::array kMiddles{LabelMiddle::kOfTriples, LabelMiddle::kThreeQuarters,
                              LabelMiddle::kHalfWay, LabelMiddle::kQuarter,
                              LabelMiddle::kOfNodes};

/// How far each lies from the mean of the nodes, on the way to that of the triple points.
double part_towards_triples(LabelMiddle of) noexcept {
  return 0.25 * (static_cast<double>(of) - static_cast<double>(LabelMiddle::kOfNodes));
}

/// The first middle around which `cost` is good.
template <class Cost>
LabelMiddle first_good_middle(const Cost& cost) noexcept {
  for (const LabelMiddle middle : kMiddles) {
    if (middle == kMiddles.back() || cost(middle) <= kGoodCost) return middle;
  }
  return kMiddles.back();
}

/// The places of a tet's corners, positive as `shape` has its nodes.
struct CornerPlaces {
  std::array<WorldPoint, kLabelCorners> at;
  bool negative;

  /// `of` may be a LabelTetCorners or one in other names.
  double cost(const LabelTetCorners& tet) const noexcept {
    const auto [a, b, c, d] = tet;
    return negative ? tet_cost(at[a], at[b], at[d], at[c])
                    : tet_cost(at[a], at[b], at[c], at[d]);
  }

  /// The largest cost of some tets, or of the first that is not good; none cost too much.
  template <class Tets>
  double worst_of(const Tets& tets) const noexcept {
    double worst = tets.count == 0 ? kNeverTaken : -1;
    for (std::size_t i = 0; i < tets.count && worst <= kGoodCost; ++i) {
      worst = std::max(worst, cost(tets.tet[i]));
    }
    return worst;
  }
};

/// The mean of two or four places.
class Mean {
 public:
  void add(const WorldPoint& place) noexcept {
    sum_ = {sum_.x + place.x, sum_.y + place.y, sum_.z + place.z};
    ++count_;
  }
  WorldPoint value() const noexcept {
    const double share = 1.0 / count_;
    return {share * sum_.x, share * sum_.y, share * sum_.z};
  }

 private:
  WorldPoint sum_;
  int count_ = 0;
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
    const bool needs_middle = tet_.decided.value_or(LabelMiddle::kNone) != LabelMiddle::kNone;
    const Twelve twelve = needs_middle ? Twelve{} : best_twelve();
    if (twelve.cost <= kGoodCost) {
      for (std::size_t side = 0; side < 2; ++side) {
        const std::size_t diagonal = twelve.diagonal[side];
        add(kLabelHalves[side][starts_[side] ? 1 : 0][twelve.shared][diagonal], out);
        add(kLabelParts[side][diagonal], out);
      }
      return;
    }
    add(fan_tets(), out);
    out.middle = needs_middle
                     ? *tet_.decided
                     : first_good_middle([&](LabelMiddle of) { return cost_of_fan(of); });
  }

 private:
  struct Twelve {
    double cost = kNeverTaken;
    std::size_t shared = 0;                 ///< diagonal of A1 T1 T2 A2
    std::array<std::size_t, 2> diagonal{};  ///< towards B and C
  };

  const internal::RoleTets<18>& fan_tets() const noexcept {
    return kLabelFans[starts_[0] ? 1 : 0][starts_[1] ? 1 : 0];
  }

  /// The combination of least cost; of equal ones the first. On either side of the quad
  /// A1 T1 T2 A2 the choice is free.
  Twelve best_twelve() const noexcept {
    std::array<std::array<double, 2>, 2> part;
    for (std::size_t i = 0; i < 4; ++i) {
      part[i >> 1][i & 1] = corner_.worst_of(kLabelParts[i >> 1][i & 1]);
    }
    Twelve best;
    for (std::size_t shared = 0; shared < 2; ++shared) {
      Twelve found{-1, shared, {}};
      for (std::size_t side = 0; side < 2; ++side) {
        std::array<double, 2> cost;
        for (std::size_t d = 0; d < 2; ++d) {
          cost[d] =
              std::max(part[side][d],
                       corner_.worst_of(kLabelHalves[side][starts_[side] ? 1 : 0][shared][d]));
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
    return corner_.worst_of(fan_tets());
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

/// The middle around which four labels are good, or else that of the nodes.
LabelMiddle middle_of_four_labels(const LabelledTet& tet) noexcept {
  const LabelPlaces places(tet, {});
  CornerPlaces corner;
  corner.negative = tet.shape.negative;
  for (LabelCorner i = 0; i < 4; ++i) {
    corner.at[i] = places.node(i);
    corner.at[label_triple(i)] = places.triple(i);
  }
  for (std::size_t e = 0; e < kTetEdge.size(); ++e) corner.at[4 + e] = places.cut(e);
  return first_good_middle([&](LabelMiddle of) {
    corner.at[kLabelMiddle] = places.middle(of);
    return corner.worst_of(kFourLabels);
  });
}

void divide_four_labels(const LabelledTet& tet, LabelDivision& out) noexcept {
  out.middle = tet.decided ? *tet.decided : middle_of_four_labels(tet);
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

LatticeCoord LabelPlaces::node_at(std::size_t i) const noexcept {
  return node_coord(tet_.shape.kind[i], halo_index(0, 0, 0) + tet_.shape.offset[i]) + cell_;
}

WorldPoint LabelPlaces::node(std::size_t i) const noexcept {
  const LatticeCoord at = node_at(i);
  return {0.5 * at.x, 0.5 * at.y, 0.5 * at.z};
}

WorldPoint LabelPlaces::cut(std::size_t edge) const noexcept {
  return place_on_edge(node_at(kTetEdge[edge][0]),
                       family_direction(tet_.shape.edge_family[edge]), tet_.fraction[edge]);
}

WorldPoint LabelPlaces::triple(std::size_t opposite_node) const noexcept {
  std::array<LatticeCoord, 3> node;
  const auto nodes = nodes_of_face(opposite_node);
  for (std::size_t i = 0; i < 3; ++i) node[i] = node_at(nodes[i]);
  return place_on_face(node, tet_.triple[opposite_node]);
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
  Mean triples, nodes;
  if (of == LabelMiddle::kOfCuts) {
    for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
      if (is_cut(e)) triples.add(cut(e));
    }
    return triples.value();
  }
  for (std::size_t i = 0; i < 4; ++i) {
    nodes.add(node(i));
    // With three labels the lower A's opposite face comes first.
    if (is_triple(i)) triples.add(triple(i));
  }
  if (of == LabelMiddle::kOfNodes) return nodes.value();
  const WorldPoint from = nodes.value(), to = triples.value();
  const double part = part_towards_triples(of), rest = 1 - part;
  return {rest * from.x + part * to.x, rest * from.y + part * to.y,
          rest * from.z + part * to.z};
}

}  // namespace tet
