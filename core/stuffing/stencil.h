// The stencils: which tets stand for the inside part of one lattice tet, by the signs of its
// nodes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/lattice/bcc.h"

namespace tet {

/// Sign of a lattice node after the warp, as a digit of a stencil's number.
enum class NodeSign : std::uint8_t { kMinus = 0, kZero = 1, kPlus = 2 };

/// A corner of a stencil tet: 0..3 is a node of the lattice tet, 4 + e the cut point on its
/// edge e (in the order of kTetEdge).
using StencilVertex = std::uint8_t;
constexpr StencilVertex cut_on_edge(std::size_t edge) {
  return static_cast<StencilVertex>(4 + edge);
}

/// The middle of the surface quad of `++--`: the mean of its four cut points.
inline constexpr StencilVertex kQuadCentre = 10;
inline constexpr std::size_t kStencilVertices = 11;

/// Some tets, positive when the nodes 0..3 of the lattice tet are.
using StencilTets = std::span<const std::array<StencilVertex, 4>>;
template <std::size_t kMaxTets>
struct TetList {
  std::uint8_t tet_count = 0;
  std::array<std::array<StencilVertex, 4>, kMaxTets> tet{};

  constexpr StencilTets tets() const noexcept { return std::span(tet).first(tet_count); }
};

/// The tets that stand for the inside part of a lattice tet.
using Stencil = TetList<3>;
/// The tets that stand for the inside part of `++--` when its surface quad is left undivided:
/// they meet in the quad's middle.
using Fan = TetList<6>;

/// What the signs leave open is told by three bits, 0 for the first of each pair:
///   bit 0: which of the first two `+` nodes stands on the longer column, at the first `-`
///   node; bit 1: `+++-`: the same of the first and third; `++--`: of the two, at the second
///   `-` node; bit 2: `+++-`: the same of the second and third; `++--`: the diagonal on the
///   surface, 0 from
///          the first `+` node's first cut point to the second's second.
/// A column's length is the cut fraction from its `+` node; equal ones go to the lower node.
inline constexpr std::size_t kStencilChoices = 8;

constexpr std::size_t stencil_number(NodeSign a, NodeSign b, NodeSign c, NodeSign d) {
  return static_cast<std::size_t>(a) + 3 * static_cast<std::size_t>(b) +
         9 * static_cast<std::size_t>(c) + 27 * static_cast<std::size_t>(d);
}

inline constexpr std::size_t kStencilCases = 81;

/// The edge between nodes i and j of a tet.
constexpr std::size_t edge_between(std::size_t i, std::size_t j) {
  const std::size_t low = i < j ? i : j, high = i < j ? j : i;
  return low == 0 ? high - 1 : low + high;
}

namespace internal {

/// Plus, zero and minus nodes of a case, each in ascending order.
struct SortedNodes {
  std::array<std::uint8_t, 4> plus{}, zero{}, minus{};
  std::size_t plus_count = 0, zero_count = 0, minus_count = 0;

  constexpr SortedNodes() = default;
  constexpr explicit SortedNodes(std::size_t number) {
    for (std::uint8_t node = 0; node < 4; ++node, number /= 3) {
      if (number % 3 == 2) plus[plus_count++] = node;
      if (number % 3 == 1) zero[zero_count++] = node;
      if (number % 3 == 0) minus[minus_count++] = node;
    }
  }
};

/// By `stencil_number`.
inline constexpr auto kSortedNodes = [] {
  std::array<SortedNodes, kStencilCases> nodes;
  for (std::size_t number = 0; number < kStencilCases; ++number) {
    nodes[number] = SortedNodes(number);
  }
  return nodes;
}();

/// A reference place for each stencil vertex, scaled to stay whole: nodes of a regular corner,
/// cut points in the middle of edges. Enough to tell a tet's orientation.
constexpr LatticeCoord reference_place(StencilVertex vertex) {
  constexpr std::array<LatticeCoord, 4> kNode{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}}};
  if (vertex < 4) return kNode[vertex] + kNode[vertex];
  if (vertex == kQuadCentre) return {1, 1, 1};  // half the sum of the nodes
  const auto edge = kTetEdge[static_cast<std::size_t>(vertex - 4)];
  return kNode[edge[0]] + kNode[edge[1]];
}

template <std::size_t kMaxTets>
constexpr void add_tet(TetList<kMaxTets>& stencil, std::array<StencilVertex, 4> tet) {
  const LatticeCoord at = reference_place(tet[0]);
  const std::int64_t volume = triple_product(
      reference_place(tet[1]) - at, reference_place(tet[2]) - at, reference_place(tet[3]) - at);
  if (volume < 0) std::swap(tet[2], tet[3]);
  stencil.tet[stencil.tet_count++] = tet;
}

/// A prism between two triangles, column i from `bottom[i]` to `top[i]`. On the side of columns
/// i and j the diagonal runs from bottom[i] to top[j] where i comes before j in `order`.
constexpr void add_prism(Stencil& stencil,
                         const std::array<StencilVertex, 3>& bottom,
                         const std::array<StencilVertex, 3>& top,
                         const std::array<std::uint8_t, 3>& order) {
  const auto [i, j, k] = order;
  add_tet(stencil, {bottom[i], bottom[j], bottom[k], top[k]});
  add_tet(stencil, {bottom[i], bottom[j], top[j], top[k]});
  add_tet(stencil, {bottom[i], top[i], top[j], top[k]});
}

/// The order of three columns from who precedes whom in the pairs 01, 02, 12. Cyclic answers,
/// which no comparison of lengths gives, yield some order.
constexpr std::array<std::uint8_t, 3> column_order(bool zero_one, bool zero_two, bool one_two) {
  const int rank_of_zero = !zero_one + !zero_two;
  const int rank_of_one = zero_one + !one_two;
  if (rank_of_zero == rank_of_one) return {0, 1, 2};  // cyclic
  std::array<std::uint8_t, 3> order{2, 2, 2};
  order[static_cast<std::size_t>(rank_of_zero)] = 0;
  order[static_cast<std::size_t>(rank_of_one)] = 1;
  return order;
}

/// `+00-`, `++--` and their kin.
constexpr Stencil make_stencil(std::size_t number, std::size_t choice) {
  Stencil stencil;
  const SortedNodes nodes(number);
  if (nodes.plus_count == 0) return stencil;
  if (nodes.minus_count == 0) {
    add_tet(stencil, {0, 1, 2, 3});
    return stencil;
  }
  const auto cut = [](std::uint8_t a, std::uint8_t b) {
    return cut_on_edge(edge_between(a, b));
  };
  const auto [p, q, r, unused_plus] = nodes.plus;
  const auto [m, n, unused_minus, unused_minus2] = nodes.minus;
  const bool first = (choice & 1) == 0, second = (choice & 2) == 0, third = (choice & 4) == 0;
  if (nodes.plus_count == 1) {  // +--- +0-- +00-: every - becomes the cut point before it
    std::array<StencilVertex, 4> tet{0, 1, 2, 3};
    for (std::size_t i = 0; i < nodes.minus_count; ++i) {
      tet[nodes.minus[i]] = cut(p, nodes.minus[i]);
    }
    add_tet(stencil, tet);
  } else if (nodes.plus_count == 2 && nodes.zero_count == 1) {  // ++0-: a pyramid over one quad
    const std::uint8_t apex = nodes.zero[0];
    if (first) {
      add_tet(stencil, {p, q, cut(q, m), apex});
      add_tet(stencil, {p, cut(q, m), cut(p, m), apex});
    } else {
      add_tet(stencil, {q, p, cut(p, m), apex});
      add_tet(stencil, {q, cut(p, m), cut(q, m), apex});
    }
  } else if (nodes.plus_count ==
             2) {  // ++--: columns p-q, and the cut points on m's and n's side
    add_prism(stencil, {p, cut(p, m), cut(p, n)}, {q, cut(q, m), cut(q, n)},
              column_order(first, second, third));
  } else {  // +++-: columns run from the + nodes to the cut points, the longest comes first
    add_prism(stencil, {p, q, r}, {cut(p, m), cut(q, m), cut(r, m)},
              column_order(first, second, third));
  }
  return stencil;
}

/// `++--` around its quad's middle: both ends of the prism, and the two faces that have a
/// column of each `+` node, divided by the longer-column rule.
constexpr Fan make_fan(std::size_t number, std::size_t choice) {
  Fan fan;
  const SortedNodes nodes(number);
  if (nodes.plus_count != 2 || nodes.minus_count != 2) return fan;
  const std::uint8_t p = nodes.plus[0], q = nodes.plus[1];
  const auto cut = [](std::uint8_t a, std::uint8_t b) {
    return cut_on_edge(edge_between(a, b));
  };
  for (const std::uint8_t plus : {p, q}) {
    add_tet(fan, {plus, cut(plus, nodes.minus[0]), cut(plus, nodes.minus[1]), kQuadCentre});
  }
  for (std::size_t side = 0; side < 2; ++side) {
    const std::uint8_t m = nodes.minus[side];
    const bool first = (choice >> side & 1) == 0;
    const std::uint8_t longer = first ? p : q, shorter = first ? q : p;
    add_tet(fan, {longer, shorter, cut(shorter, m), kQuadCentre});
    add_tet(fan, {longer, cut(shorter, m), cut(longer, m), kQuadCentre});
  }
  return fan;
}

template <class List, std::size_t kChoices, class Make>
constexpr auto make_for_every_case(const Make& make) {
  std::array<std::array<List, kChoices>, kStencilCases> lists;
  for (std::size_t number = 0; number < kStencilCases; ++number) {
    for (std::size_t choice = 0; choice < kChoices; ++choice) {
      lists[number][choice] = make(number, choice);
    }
  }
  return lists;
}

}  // namespace internal

/// Every stencil, by `stencil_number` and choice, grown from the rules above.
inline constexpr auto kStencils =
    internal::make_for_every_case<Stencil, kStencilChoices>(internal::make_stencil);

/// Every fan of `++--`, by `stencil_number` and the first two bits of the choice.
inline constexpr std::size_t kFanChoices = 4;
inline constexpr auto kFans =
    internal::make_for_every_case<Fan, kFanChoices>(internal::make_fan);

static_assert(kStencils[stencil_number(
                  NodeSign::kPlus, NodeSign::kPlus, NodeSign::kPlus, NodeSign::kPlus)][0]
                  .tet_count == 1);
static_assert(kStencils[stencil_number(
                  NodeSign::kPlus, NodeSign::kPlus, NodeSign::kMinus, NodeSign::kMinus)][0]
                  .tet_count == 3);

}  // namespace tet
