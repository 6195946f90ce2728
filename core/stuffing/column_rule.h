// The longer-column rule: how the faces of a cut tet are divided, from cut fractions alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/stuffing/stencil.h"

namespace tet {

/// How the surface quad a, b, c, d of `++--` is divided, where p and q are the `+` nodes, m and
/// n the `-` nodes, and a, b, c, d the cut points on pm, qm, qn and pn.
enum class QuadSplit : std::uint8_t { kFirstDiagonal /* a-c */, kSecondDiagonal, kFan };

/// Where the cut points on a tet's edges lie, from the lower nodes; anything where there is
/// none.
using EdgeFractions = std::array<float, kTetEdge.size()>;

/// The columns of one tet of any shape, whose nodes are in ascending order.
class ColumnRule {
 public:
  using Nodes = std::array<std::uint8_t, 4>;

  /// `number` is its stencil's. The fractions must outlive it.
  ColumnRule(std::size_t number, const EdgeFractions& fraction) noexcept
      : nodes_(internal::kSortedNodes[number]), fraction_(fraction) {}

  const internal::SortedNodes& nodes() const noexcept { return nodes_; }

  /// Two nodes on either side: the surface crosses it in a quad.
  bool has_quad() const noexcept { return nodes_.plus_count == 2 && nodes_.minus_count == 2; }

  /// True when q's column is the longer one; p is the lower node and wins a tie.
  bool second_longer(std::size_t p, std::size_t q, std::size_t minus) const noexcept {
    return column(q, minus) > column(p, minus);
  }

  /// The bits of a stencil's choice that column lengths decide.
  std::size_t choice() const noexcept {
    if (nodes_.plus_count == 1) return 0;
    const auto [p, q, r, s] = nodes_.plus;
    const auto [m, n, o, t] = nodes_.minus;
    std::size_t choice = second_longer(p, q, m) ? 1 : 0;
    if (nodes_.plus_count == 3) {
      choice |= (second_longer(p, r, m) ? 2 : 0) | (second_longer(q, r, m) ? 4 : 0);
    } else if (nodes_.minus_count == 2) {
      choice |= second_longer(p, q, n) ? 2 : 0;
    }
    return choice;
  }

  /// Where the faces of a prism disagree (p stands on the longer column at m, q at n, or the
  /// reverse) one diagonal of its quad would close a cycle; the other is forced.
  std::optional<QuadSplit> forced_split(const Nodes& plus, const Nodes& minus) const noexcept {
    const bool first = second_longer(plus[0], plus[1], minus[0]);
    const bool second = second_longer(plus[0], plus[1], minus[1]);
    if (first == second) return std::nullopt;
    return second ? QuadSplit::kSecondDiagonal : QuadSplit::kFirstDiagonal;
  }

 private:
  /// Length of the column on the edge from a `+` node to a `-` node, in edges.
  float column(std::size_t plus, std::size_t minus) const noexcept {
    const float fraction = fraction_[edge_between(plus, minus)];
    return plus < minus ? fraction : 1 - fraction;
  }

  const internal::SortedNodes& nodes_;
  const EdgeFractions& fraction_;
};

}  // namespace tet
