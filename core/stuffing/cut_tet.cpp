#include "core/stuffing/cut_tet.h"

#include <algorithm>

#include "core/lattice/background.h"
#include "core/stuffing/surface_diagonal.h"

namespace tet {

/// Where the faces of a prism disagree (p stands on the longer column at m, q at n, or the
/// reverse) one diagonal of its quad would close a cycle; the other is forced.
std::optional<QuadSplit> CutTet::forced_split(const Nodes& plus,
                                              const Nodes& minus) const noexcept {
  const bool first = second_longer(plus.at[0], plus.at[1], minus.at[0]);
  const bool second = second_longer(plus.at[0], plus.at[1], minus.at[1]);
  if (first == second) return std::nullopt;
  return second ? QuadSplit::kSecondDiagonal : QuadSplit::kFirstDiagonal;
}

/// The quad's nodes as seen from inside, whichever region is written: both must decide alike.
/// Seen from outside p, q and m, n change places, b and d too, and the diagonals stay what they
/// are.
CutTet::Quad CutTet::quad() const noexcept {
  if (region_ == MeshRegion::kInside) return {plus_, minus_};
  return {minus_, plus_};
}

bool CutTet::has_fan() const noexcept {
  if (!rules_.both_sides || !has_quad()) return false;
  const auto [plus, minus] = quad();
  const auto inside = forced_split(plus, minus);
  const auto outside = forced_split(minus, plus);
  return inside && outside && *inside != *outside;
}

QuadSplit CutTet::quad_split() const noexcept {
  if (has_fan()) return QuadSplit::kFan;
  const auto [plus, minus] = quad();
  if (const auto inside = forced_split(plus, minus)) return *inside;
  if (rules_.both_sides) {
    if (const auto outside = forced_split(minus, plus)) return *outside;
  }
  const auto [p, q, r, s] = plus.at;
  const auto [m, n, o, t] = minus.at;
  // Each region's apex is the node of its longer columns.
  const std::array<WorldPoint, 2> apex{
      place(static_cast<StencilVertex>(second_longer(p, q, m) ? q : p)),
      place(static_cast<StencilVertex>(second_longer(m, n, p) ? n : m))};
  const bool second = second_diagonal_is_better(
      std::span(apex).first(rules_.both_sides ? 2 : 1), place_of_cut(p, m), place_of_cut(q, m),
      place_of_cut(q, n), place_of_cut(p, n));
  return second ? QuadSplit::kSecondDiagonal : QuadSplit::kFirstDiagonal;
}

WorldPoint CutTet::place_of_cut(std::size_t a, std::size_t b) const noexcept {
  return place(cut_on_edge(edge_between(a, b)));
}

WorldPoint middle_of_quad(const TetShape& shape,
                          int cell,
                          const StuffedLattice& lattice) noexcept {
  WorldPoint sum;
  for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
    const int low = cell + shape.offset[kTetEdge[e][0]];
    if (!lattice.warped.cut[shape.edge_family[e]].test(low)) continue;
    const WorldPoint cut = lattice.place_of_cut(shape.edge_family[e], low);
    sum = {sum.x + cut.x, sum.y + cut.y, sum.z + cut.z};
  }
  return {0.25 * sum.x, 0.25 * sum.y, 0.25 * sum.z};
}

FanMasks find_fans(const StuffedLattice& lattice,
                   const FinestNodes& nodes,
                   const StuffingRules& rules) noexcept {
  FanMasks fans;
  for (int axis = 0; axis < 3; ++axis) {
    const FaceSigns faces = signs_around_faces(nodes, axis);
    for (std::size_t turn = 0; turn < 4; ++turn) {
      const std::size_t shape = static_cast<std::size_t>(axis) * 4 + turn;
      const ShapeSigns signs = signs_of_shape(faces, kTetShape[shape]);
      for_each_bit(signs.cut, [&](int cell) {
        const Cell at(cell);
        if (CutTet(kTetShape[shape], signs, cell, lattice, rules).has_fan()) {
          fans[shape].set(at.x, at.y, at.z);
        }
      });
    }
  }
  return fans;
}

}  // namespace tet
