#include "core/stuffing/cut_tet.h"

#include "core/lattice/background.h"
#include "core/stuffing/surface_diagonal.h"

namespace tet {

/// The quad's nodes as seen from inside, whichever region is written: both must decide alike.
/// Seen from outside p, q and m, n change places, b and d too, and the diagonals stay what they
/// are.
CutTet::Quad CutTet::quad() const noexcept {
  if (region_ == MeshRegion::kInside) return {columns_.nodes().plus, columns_.nodes().minus};
  return {columns_.nodes().minus, columns_.nodes().plus};
}

bool CutTet::has_fan() const noexcept {
  if (!rules_.both_sides || !has_quad()) return false;
  const auto [plus, minus] = quad();
  const auto inside = columns_.forced_split(plus, minus);
  const auto outside = columns_.forced_split(minus, plus);
  return inside && outside && *inside != *outside;
}

QuadSplit CutTet::quad_split() const noexcept {
  if (has_fan()) return QuadSplit::kFan;
  const auto [plus, minus] = quad();
  if (const auto inside = columns_.forced_split(plus, minus)) return *inside;
  if (rules_.both_sides) {
    if (const auto outside = columns_.forced_split(minus, plus)) return *outside;
  }
  const auto [p, q, r, s] = plus;
  const auto [m, n, o, t] = minus;
  // Each region's apex is the node of its longer columns.
  const std::array<WorldPoint, 2> apex{place_of_node(columns_.second_longer(p, q, m) ? q : p),
                                       place_of_node(columns_.second_longer(m, n, p) ? n : m)};
  const bool second = second_diagonal_is_better(
      std::span(apex).first(rules_.both_sides ? 2 : 1), place_of_cut(p, m), place_of_cut(q, m),
      place_of_cut(q, n), place_of_cut(p, n));
  return second ? QuadSplit::kSecondDiagonal : QuadSplit::kFirstDiagonal;
}

/// Returns the place in spacings from the cell's lowest corner; a node of a quad's tet has not
/// moved.
WorldPoint CutTet::place_of_node(std::size_t node) const noexcept {
  return lattice_place(shape_.kind[node], halo_index(0, 0, 0) + shape_.offset[node]);
}

WorldPoint CutTet::place_of_cut(std::size_t a, std::size_t b) const noexcept {
  const std::size_t edge = edge_between(a, b), low = kTetEdge[edge][0];
  return place_on_edge(node_coord(shape_.kind[low], halo_index(0, 0, 0) + shape_.offset[low]),
                       family_direction(shape_.edge_family[edge]), fraction_[edge]);
}

std::size_t stencil_number(const ShapeSigns& signs, int cell) noexcept {
  return stencil_number(sign_at(signs, 0, cell), sign_at(signs, 1, cell),
                        sign_at(signs, 2, cell), sign_at(signs, 3, cell));
}

EdgeFractions edge_fractions(const StuffedLattice& lattice,
                             const TetShape& shape,
                             int cell) noexcept {
  EdgeFractions fraction{};
  for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
    const int low = cell + shape.offset[kTetEdge[e][0]];
    if (!lattice.warped.cut[shape.edge_family[e]].test(low)) continue;
    fraction[e] = lattice.cuts.fraction[shape.edge_family[e]][static_cast<std::size_t>(low)];
  }
  return fraction;
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
        const EdgeFractions fraction = edge_fractions(lattice, kTetShape[shape], cell);
        if (CutTet(kTetShape[shape], stencil_number(signs, cell), fraction, signs.region, rules)
                .has_fan()) {
          fans[shape].set(at.x, at.y, at.z);
        }
      });
    }
  }
  return fans;
}

}  // namespace tet
