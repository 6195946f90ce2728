#include "core/graded/split_tet.h"

#include <optional>

#include "core/stuffing/surface_diagonal.h"

namespace tet {

WorldPoint SplitTet::cut(std::size_t a, std::size_t b) const noexcept {
  const std::size_t edge = edge_between(a, b);
  const auto [low, high] = kTetEdge[edge];
  const auto t = static_cast<double>(fraction[edge]);
  const WorldPoint &from = place[low], &to = place[high];
  return {from.x + t * (to.x - from.x), from.y + t * (to.y - from.y),
          from.z + t * (to.z - from.z)};
}

/// Chooses the diagonal of the surface quad of `++--`.
bool SplitTet::takes_second_diagonal(const ColumnRule& columns) const noexcept {
  const auto& [plus, zero, minus, plus_count, zero_count, minus_count] = columns.nodes();
  if (const auto forced = columns.forced_split(plus, minus)) {
    return *forced == QuadSplit::kSecondDiagonal;
  }
  const auto [p, q, r, s] = plus;
  const auto [m, n, o, t] = minus;
  const std::array<WorldPoint, 1> apex{place[columns.second_longer(p, q, m) ? q : p]};
  return second_diagonal_is_better(apex, cut(p, m), cut(q, m), cut(q, n), cut(p, n));
}

StencilTets SplitTet::tets() const noexcept {
  const std::size_t number = stencil_number(sign[0], sign[1], sign[2], sign[3]);
  const ColumnRule columns(number, fraction);
  const internal::SortedNodes& nodes = columns.nodes();
  if (nodes.plus_count < 2 || nodes.minus_count == 0) return kStencils[number][0].tets();
  std::size_t choice = columns.choice();
  if (columns.has_quad() && takes_second_diagonal(columns)) choice |= 4;
  return kStencils[number][choice].tets();
}

}  // namespace tet
