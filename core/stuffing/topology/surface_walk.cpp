#include "core/stuffing/topology/surface_walk.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/lattice/background.h"
#include "core/stuffing/count_tets.h"
#include "core/stuffing/stencil.h"
#include "core/stuffing/stuffed_brick.h"

namespace tet {
namespace {

/// The brick of a halo index within [-1, 8]^3.
BricksAround brick_of(int index) noexcept {
  const Cell at(index);
  const auto step = [](int i) { return i < 0 ? 0 : 1 + (i >> 3); };
  return 1U << (9 * step(at.x) + 3 * step(at.y) + step(at.z));
}

/// The bricks of a tet's nodes.
BricksAround bricks_of(const TetShape& shape, int cell) noexcept {
  constexpr HaloSet kWithin = halo_cube(0, 6);
  if (kWithin.test(cell)) return kOwnBrick;
  BricksAround bricks = 0;
  for (const int offset : shape.offset) bricks |= brick_of(cell + offset);
  return bricks;
}

/// The piece of surface in a cut tet: its corners, and its triangles.
struct SurfacePiece {
  std::array<StencilVertex, 4> corner{};
  std::uint8_t corners = 0;
  std::uint8_t triangles() const noexcept {
    return static_cast<std::uint8_t>(corners < 3 ? 0 : corners - 2);
  }
};

constexpr std::array<SurfacePiece, kStencilCases> kSurfacePiece = [] {
  std::array<SurfacePiece, kStencilCases> pieces{};
  for (std::size_t number = 0; number < kStencilCases; ++number) {
    const internal::SortedNodes nodes(number);
    if (nodes.plus_count == 0 || nodes.minus_count == 0) continue;
    SurfacePiece& piece = pieces[number];
    for (std::size_t i = 0; i < nodes.zero_count; ++i) {
      piece.corner[piece.corners++] = nodes.zero[i];
    }
    for (std::size_t i = 0; i < nodes.plus_count; ++i) {
      for (std::size_t j = 0; j < nodes.minus_count; ++j) {
        piece.corner[piece.corners++] =
            cut_on_edge(edge_between(nodes.plus[i], nodes.minus[j]));
      }
    }
  }
  return pieces;
}();

/// A vertex of the surface, as SurfaceWorkspace knows it.
std::uint16_t vertex_at(const TetShape& shape, int cell, StencilVertex corner) noexcept {
  const std::size_t slot =
      corner < 4 ? shape.kind[corner]
                 : kNodeKinds + shape.edge_family[static_cast<std::size_t>(corner - 4)];
  const std::size_t node =
      corner < 4 ? corner : kTetEdge[static_cast<std::size_t>(corner - 4)][0];
  return static_cast<std::uint16_t>(slot * kHaloNodes +
                                    static_cast<std::size_t>(cell + shape.offset[node]));
}

/// Number of the stencil of a tet.
std::size_t number_at(const ShapeSigns& signs, int cell) noexcept {
  return stencil_number(sign_at(signs, 0, cell), sign_at(signs, 1, cell),
                        sign_at(signs, 2, cell), sign_at(signs, 3, cell));
}

/// Tets `+000`: whole, with one `+`.
HaloSet tets_on_three_zeros(const ShapeSigns& signs) noexcept {
  return HaloSet::from_words([&](std::size_t w) {
    std::uint64_t odd = 0, several = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      several |= odd & signs.plus[i]->word[w];
      odd ^= signs.plus[i]->word[w];
    }
    return signs.whole.word[w] & odd & ~several;
  });
}

/// Unites what the surface joins.
class SurfaceWalk {
 public:
  SurfaceWalk(const WarpedLattice& lattice, SurfaceWorkspace& workspace)
      : lattice_(lattice), workspace_(workspace) {}

  void walk() {
    FinestNodes nodes{.plus = lattice_.plus, .zero = lattice_.zero, .leaf = {}};
    nodes.leaf = halo_cube(kNodeMin, kNodeMax);
    for (int axis = 0; axis < 3; ++axis) {
      const FaceSigns faces = signs_around_faces(nodes, axis, kCellsAround);
      for (std::size_t turn = 0; turn < 4; ++turn) {
        walk_shape(static_cast<std::size_t>(axis) * 4 + turn, faces);
      }
    }
  }

 private:
  void walk_shape(std::size_t s, const FaceSigns& faces) {
    const TetShape& shape = kTetShape[s];
    const ShapeSigns signs = signs_of_shape(faces, shape);
    for_each_bit(signs.cut, [&](int cell) {
      const SurfacePiece& piece = kSurfacePiece[number_at(signs, cell)];
      add(shape, cell, std::span(piece.corner).first(piece.corners));
    });
    // A face of three zeros is on the boundary unless the tet behind it is inside too.
    for_each_bit(tets_on_three_zeros(signs), [&](int cell) {
      std::array<StencilVertex, 3> face{};
      std::size_t corners = 0, plus = 0;
      for (StencilVertex i = 0; i < 4; ++i) {
        if (signs.plus[i]->test(cell)) {
          plus = i;
        } else {
          face[corners++] = i;
        }
      }
      // Around a tet without a node of the brick not every sign is known, and others see to
      // it.
      const bool own = std::any_of(shape.offset.begin(), shape.offset.end(),
                                   [&](int offset) { return kOwnNodes.test(cell + offset); });
      if (!own) return;
      if (lattice_.plus[shape.kind[plus]].test(cell + kMirrored[s][plus])) return;
      add(shape, cell, face);
    });
  }

  void add(const TetShape& shape, int cell, std::span<const StencilVertex> corners) {
    const std::uint16_t first = vertex_at(shape, cell, corners[0]);
    for (const StencilVertex corner : corners.subspan(1)) {
      workspace_.unite(first, vertex_at(shape, cell, corner));
    }
    const BricksAround bricks = bricks_of(shape, cell);
    if (bricks != kOwnBrick) workspace_.beside().push_back({first, bricks});
  }

  const WarpedLattice& lattice_;
  SurfaceWorkspace& workspace_;
};

/// Calls `visit(slot, index, root)` for every vertex of the surface that was met.
template <class Visit>
void for_each_vertex(SurfaceWorkspace& workspace, const Visit& visit) {
  for (std::size_t slot = 0; slot < SurfaceWorkspace::kSlots; ++slot) {
    for_each_bit(workspace.touched(slot), [&](int index) {
      visit(slot, index,
            workspace.find(static_cast<std::uint16_t>(slot * kHaloNodes +
                                                      static_cast<std::size_t>(index))));
    });
  }
}

/// Edges from the brick's zeros to `+` nodes are crossed at the zero, if only the lattice says
/// so.
void note_plus_beside_zeros(const WarpedLattice& lattice, SurfaceWorkspace& workspace) {
  constexpr HaloSet kOutermost = kOwnNodes - halo_cube(1, 6);
  for (const NodeKind kind : {kCorner, kCentre}) {
    // Deeper nodes have edges to the brick's own nodes alone.
    for_each_bit(workspace.touched(kind) & kOutermost, [&](int node) {
      BricksAround bricks = 0;
      for (int d = 0; d < kDirections; ++d) {
        const int end = node + end_offset(kind, d);
        if (lattice.plus[end_kind(kind, d)].test(end)) bricks |= brick_of(end);
      }
      const auto vertex = static_cast<std::uint16_t>(kind * kHaloNodes + node);
      workspace.beside().push_back({vertex, bricks});
    });
  }
}

/// The roots of the parts that cross an edge of the brick's own nodes: first those with a
/// vertex of its own, whose number is returned.
std::size_t find_parts(SurfaceWorkspace& workspace, std::vector<std::uint16_t>& roots) {
  const auto add = [&](std::uint16_t root) {
    if (std::find(roots.begin(), roots.end(), root) == roots.end()) roots.push_back(root);
  };
  for_each_vertex(workspace, [&](std::size_t, int index, std::uint16_t root) {
    if (kOwnNodes.test(index)) add(root);
  });
  const std::size_t with_vertices = roots.size();
  for (const auto& [vertex, bricks] : workspace.beside()) {
    if ((bricks & kOwnBrick) != 0) add(workspace.find(vertex));
  }
  return with_vertices;
}

/// Numbers the parts, and says what each is beside.
SurfaceParts number_parts(SurfaceWorkspace& workspace) {
  SurfaceParts parts;
  std::vector<std::uint16_t> roots;
  const std::size_t with_vertices = find_parts(workspace, roots);
  const auto part_of = [&](std::uint16_t root) {
    return static_cast<std::uint16_t>(std::find(roots.begin(), roots.end(), root) -
                                      roots.begin());
  };
  parts.count = static_cast<std::uint16_t>(roots.size());
  parts.beside.resize(parts.count);
  for (const auto& [vertex, bricks] : workspace.beside()) {
    const std::uint16_t part = part_of(workspace.find(vertex));
    if (part != parts.count) parts.beside[part] |= bricks & ~kOwnBrick;
  }
  std::vector<SurfaceLink>& links = workspace.links();
  links.clear();
  for_each_vertex(workspace, [&](std::size_t slot, int index, std::uint16_t root) {
    const VertexOwner owner(index);
    const std::uint16_t part = part_of(root);
    if (part == parts.count) return;
    if (part < with_vertices && owner.brick < VertexOwner::kHere) return;
    const std::uint16_t element = owner.element(slot);
    if (owner.brick != VertexOwner::kHere) {
      links.push_back({owner.brick, element, part});
    } else if (parts.count > 1) {
      parts.part_of.push_back({element, part});
    }
  });
  parts.links.assign(links.begin(), links.end());  // no larger than it need be: it is kept
  parts.part_of.shrink_to_fit();
  return parts;
}

}  // namespace

void SurfaceWorkspace::clear() noexcept {
  touched_ = {};
  beside_.clear();
}

void SurfaceWorkspace::touch(std::uint16_t vertex) noexcept {
  HaloSet& touched = touched_[vertex / kHaloNodes];
  const int index = vertex % kHaloNodes;
  if (touched.test(index)) return;
  touched.set(index);
  parent_[vertex] = vertex;
}

std::uint16_t SurfaceWorkspace::find(std::uint16_t vertex) noexcept {
  while (parent_[vertex] != vertex) {
    vertex = parent_[vertex] = parent_[parent_[vertex]];
  }
  return vertex;
}

void SurfaceWorkspace::unite(std::uint16_t a, std::uint16_t b) noexcept {
  touch(a);
  touch(b);
  parent_[find(b)] = find(a);
}

SurfaceParts walk_surface(const WarpedLattice& lattice, SurfaceWorkspace& workspace) {
  workspace.clear();
  SurfaceWalk(lattice, workspace).walk();
  note_plus_beside_zeros(lattice, workspace);
  return number_parts(workspace);
}

}  // namespace tet
