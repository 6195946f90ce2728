// The divisions of tets with three and four labels, grown from their rules.
//
// Three labels are told in roles: A1 and A2 (nodes 0 and 1) have the first label, B (2) the
// second, C (3) the third. T1 is the triple point of A1 B C, T2 that of A2 B C.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/labels/label_tets.h"
#include "core/lattice/bcc.h"

namespace tet {
namespace internal {

/// A place for each corner, scaled to stay whole; enough to tell orientations.
constexpr LatticeCoord label_reference(LabelCorner corner) {
  constexpr std::array<LatticeCoord, 4> kNode{{{0, 0, 0}, {12, 0, 0}, {0, 12, 0}, {0, 0, 12}}};
  LatticeCoord sum;
  int count = 0;
  const auto add = [&](std::size_t node) {
    sum = sum + kNode[node];
    ++count;
  };
  if (corner < 4) {
    add(corner);
  } else if (corner < 10) {
    for (const std::uint8_t node : kTetEdge[static_cast<std::size_t>(corner - 4)]) add(node);
  } else {
    for (std::size_t node = 0; node < 4; ++node) {
      if (corner != label_triple(node)) add(node);
    }
  }
  return {sum.x / count, sum.y / count, sum.z / count};
}

constexpr LabelTetCorners oriented(LabelTetCorners tet) {
  const LatticeCoord at = label_reference(tet[0]);
  const std::int64_t volume = triple_product(
      label_reference(tet[1]) - at, label_reference(tet[2]) - at, label_reference(tet[3]) - at);
  if (volume < 0) std::swap(tet[2], tet[3]);
  return tet;
}

/// Tets, and the node whose label each has.
template <std::size_t kCount>
struct RoleTets {
  std::size_t count = 0;
  std::array<LabelTetCorners, kCount> tet{};
  std::array<std::uint8_t, kCount> role{};

  constexpr void add(const LabelTetCorners& corners, std::uint8_t of) {
    tet[count] = oriented(corners);
    role[count++] = of;
  }
};

/// A face of three labels, seen from `apex`: each node's quad is divided by the diagonal to
/// the triple point.
template <std::size_t kCount>
constexpr void add_cone_of_triple(RoleTets<kCount>& out, std::size_t face, LabelCorner apex) {
  for (std::uint8_t from = 0; from < 4; ++from) {
    for (std::uint8_t to = 0; to < 4; ++to) {
      if (from == to || from == face || to == face) continue;
      out.add({from, label_cut(from, to), label_triple(face), apex}, from);
    }
  }
}

/// A face of two A and one other, seen from the middle: a triangle at the other, and a quad
/// whose diagonal starts at the A with the longer column.
template <std::size_t kCount>
constexpr void add_cone_of_pair(RoleTets<kCount>& out, std::uint8_t other, bool second_starts) {
  const std::uint8_t longer = second_starts ? 1 : 0, shorter = second_starts ? 0 : 1;
  out.add({other, label_cut(other, 0), label_cut(other, 1), kLabelMiddle}, other);
  out.add({longer, shorter, label_cut(shorter, other), kLabelMiddle}, longer);
  out.add({longer, label_cut(shorter, other), label_cut(longer, other), kLabelMiddle}, longer);
}

/// Three columns from `bottom` to `top`: on the side of columns i and j the diagonal runs from
/// bottom[i] to top[j] where i comes before j in `order`.
template <std::size_t kCount>
constexpr void add_columns(RoleTets<kCount>& out,
                           const std::array<LabelCorner, 3>& bottom,
                           const std::array<LabelCorner, 3>& top,
                           const std::array<std::uint8_t, 3>& order,
                           std::uint8_t role) {
  const auto [i, j, k] = order;
  out.add({bottom[i], bottom[j], bottom[k], top[k]}, role);
  out.add({bottom[i], bottom[j], top[j], top[k]}, role);
  out.add({bottom[i], top[i], top[j], top[k]}, role);
}

inline constexpr LabelCorner kT1 = label_triple(1), kT2 = label_triple(0);

/// The part of B or C: a prism whose columns are its node to the cut point between B and C,
/// and the cut point towards each A to that one's triple point. `diagonal` 0 leads from the
/// cut point towards A1 to T2, 1 from T1 to the cut point towards A2.
constexpr RoleTets<3> make_part(std::uint8_t role, std::size_t diagonal) {
  RoleTets<3> part;
  const std::array<std::uint8_t, 3> first{0, 1, 2}, second{0, 2, 1};
  add_columns(part, {role, label_cut(0, role), label_cut(1, role)}, {label_cut(2, 3), kT1, kT2},
              diagonal == 0 ? first : second, role);
  return part;
}

/// Half of A's part, next to B or C: columns A1 to A2, cut point to cut point, T1 to T2. Empty
/// where the three diagonals would chase each other around.
///
/// `second_starts`: the diagonal of the quad in the face A1 A2 and B (or C) starts at A2.
/// `shared` 0 leads from A1 to T2, 1 from A2 to T1; `diagonal` as in make_part.
constexpr RoleTets<3> make_half(std::uint8_t other,
                                bool second_starts,
                                std::size_t shared,
                                std::size_t diagonal) {
  RoleTets<3> half;
  const bool zero_one = !second_starts, zero_two = shared == 0, one_two = diagonal == 0;
  const std::size_t rank_of_zero = (zero_one ? 0U : 1U) + (zero_two ? 0U : 1U);
  const std::size_t rank_of_one = (zero_one ? 1U : 0U) + (one_two ? 0U : 1U);
  if (rank_of_zero == rank_of_one) return half;
  std::array<std::uint8_t, 3> order{2, 2, 2};
  order[rank_of_zero] = 0;
  order[rank_of_one] = 1;
  add_columns(half, {0, label_cut(0, other), kT1}, {1, label_cut(1, other), kT2}, order, 0);
  return half;
}

}  // namespace internal

/// The tets of a part of B or C, by role less two and diagonal.
inline constexpr auto kLabelParts = [] {
  std::array<std::array<internal::RoleTets<3>, 2>, 2> parts;
  for (std::size_t i = 0; i < 4; ++i) {
    parts[i >> 1][i & 1] = internal::make_part(static_cast<std::uint8_t>(2 + (i >> 1)), i & 1);
  }
  return parts;
}();

/// The tets of half of A's part, by the other's role less two, who starts, and the two
/// diagonals.
inline constexpr auto kLabelHalves = [] {
  using Halves = std::array<std::array<std::array<internal::RoleTets<3>, 2>, 2>, 2>;
  std::array<Halves, 2> halves;
  for (std::size_t i = 0; i < 16; ++i) {
    halves[i >> 3][i >> 2 & 1][i >> 1 & 1][i & 1] = internal::make_half(
        static_cast<std::uint8_t>(2 + (i >> 3)), (i >> 2 & 1) != 0, i >> 1 & 1, i & 1);
  }
  return halves;
}();

/// Three labels around a middle, by who starts towards B and towards C.
inline constexpr auto kLabelFans = [] {
  std::array<std::array<internal::RoleTets<18>, 2>, 2> fans;
  for (std::size_t i = 0; i < 4; ++i) {
    internal::RoleTets<18>& fan = fans[i >> 1][i & 1];
    internal::add_cone_of_triple(fan, 1, kLabelMiddle);
    internal::add_cone_of_triple(fan, 0, kLabelMiddle);
    internal::add_cone_of_pair(fan, 2, (i >> 1) != 0);
    internal::add_cone_of_pair(fan, 3, (i & 1) != 0);
  }
  return fans;
}();

/// Four labels around a middle.
inline constexpr auto kFourLabels = [] {
  internal::RoleTets<24> tets;
  for (std::size_t face = 0; face < 4; ++face) {
    internal::add_cone_of_triple(tets, face, kLabelMiddle);
  }
  return tets;
}();

/// Three labels and a joker: the cone from it over the face opposite to it.
inline constexpr auto kJokerCones = [] {
  std::array<internal::RoleTets<6>, 4> cones;
  for (std::uint8_t joker = 0; joker < 4; ++joker) {
    internal::add_cone_of_triple(cones[joker], joker, joker);
  }
  return cones;
}();

static_assert(kLabelFans[0][0].count == 18 && kFourLabels.count == 24);

}  // namespace tet
