#include "core/stuffing/surface_topology.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/lattice/background.h"
#include "core/stuffing/node_link.h"
#include "core/stuffing/stencil.h"
#include "core/stuffing/stuffed_brick.h"

namespace tet {
namespace {

constexpr HaloSet kOwnNodes = halo_cube(0, 7);

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

/// For each node of a shape, how far from the cell the node opposite it lies, across the face
/// of the other three: the mirror image in the middle of the tet's other long edge.
constexpr std::array<std::array<int, 4>, kTetShapes> kMirrored = [] {
  std::array<std::array<int, 4>, kTetShapes> mirrored{};
  for (std::size_t s = 0; s < kTetShapes; ++s) {
    const TetShape& shape = kTetShape[s];
    for (std::size_t a = 0; a < 4; ++a) {
      LatticeCoord at{};
      for (std::size_t b = 0; b < 4; ++b) {
        const LatticeCoord node =
            node_coord(shape.kind[b], halo_index(0, 0, 0) + shape.offset[b]);
        if (b == a) at = at - node;
        if (shape.kind[b] != shape.kind[a]) at = at + node;
      }
      mirrored[s][a] = node_index(at) - halo_index(0, 0, 0);
    }
  }
  return mirrored;
}();

/// Unites what the surface joins, and counts the triangles of own cells.
class SurfaceWalk {
 public:
  SurfaceWalk(const WarpedLattice& lattice, SurfaceWorkspace& workspace)
      : lattice_(lattice), workspace_(workspace) {}

  std::uint64_t triangles() const noexcept { return triangles_; }

  void walk() noexcept {
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
  void walk_shape(std::size_t s, const FaceSigns& faces) noexcept {
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
      // Around a face without a node of the brick not every sign is known, and others see to
      // it.
      const bool own = std::any_of(face.begin(), face.end(), [&](StencilVertex i) {
        return kOwnNodes.test(cell + shape.offset[i]);
      });
      if (!own && !kOwnNodes.test(cell)) return;
      if (lattice_.plus[shape.kind[plus]].test(cell + kMirrored[s][plus])) return;
      add(shape, cell, face);
    });
  }

  void add(const TetShape& shape, int cell, std::span<const StencilVertex> corners) noexcept {
    const std::uint16_t first = vertex_at(shape, cell, corners[0]);
    for (const StencilVertex corner : corners.subspan(1)) {
      workspace_.unite(first, vertex_at(shape, cell, corner));
    }
    if (kOwnNodes.test(cell)) triangles_ += corners.size() - 2;
  }

  const WarpedLattice& lattice_;
  SurfaceWorkspace& workspace_;
  std::uint64_t triangles_ = 0;
};

/// Signs around one node.
NodeLink link_of(const std::array<HaloSet, kNodeKinds>& plus,
                 const std::array<HaloSet, kNodeKinds>& zero,
                 NodeKind kind,
                 int node) noexcept {
  NodeLink link;
  for (int d = 0; d < kDirections; ++d) {
    const NodeKind end = end_kind(kind, d);
    const int at = node + end_offset(kind, d);
    const unsigned bit = 1U << d;
    if (plus[end].test(at)) link.plus = static_cast<DirectionSet>(link.plus | bit);
    if (zero[end].test(at)) link.zero = static_cast<DirectionSet>(link.zero | bit);
  }
  return link;
}

void count_nodes(const WarpedLattice& lattice, SurfaceCounts& counts) noexcept {
  for (const NodeKind kind : {kCorner, kCentre}) {
    for_each_bit(used_zeros(lattice, kind) & kOwnNodes, [&](int node) {
      const SurfaceAtNode surface = surface_at(link_of(lattice.plus, lattice.zero, kind, node));
      counts.non_manifold_edges += static_cast<std::uint64_t>(surface.non_manifold_edges);
      counts.extra_pairs += static_cast<std::uint64_t>(surface.extra_pairs);
      counts.non_manifold_vertices += surface.manifold ? 0 : 1;
    });
  }
}

/// A halo index as its brick, each coordinate -1, 0 or 1, and the place within it.
struct Owner {
  std::array<std::int8_t, 3> brick;
  std::uint16_t place;
  explicit Owner(int index) noexcept {
    const Cell at(index);
    const auto brick_of = [](int i) { return static_cast<std::int8_t>(i < 0 ? -1 : i >> 3); };
    brick = {brick_of(at.x), brick_of(at.y), brick_of(at.z)};
    place = static_cast<std::uint16_t>(((at.x & 7) * 8 + (at.y & 7)) * 8 + (at.z & 7));
  }
};

std::uint16_t element_of(std::size_t slot, const Owner& owner) noexcept {
  return static_cast<std::uint16_t>(slot * kBrickCells + owner.place);
}

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

/// Finds the parts and numbers them in the order of their first vertices; returns how many
/// vertices the brick has.
std::uint64_t find_parts(SurfaceWorkspace& workspace, SurfaceParts& parts) {
  std::vector<std::uint16_t> roots;
  const auto part_of = [&](std::uint16_t root) {
    return static_cast<std::uint16_t>(std::find(roots.begin(), roots.end(), root) -
                                      roots.begin());
  };
  std::uint64_t vertices = 0;
  for_each_vertex(workspace, [&](std::size_t, int index, std::uint16_t root) {
    if (!kOwnNodes.test(index)) return;
    ++vertices;
    if (part_of(root) == roots.size()) roots.push_back(root);
  });
  parts.count = static_cast<std::uint16_t>(roots.size());
  constexpr std::array<std::int8_t, 3> kHere{0, 0, 0};
  std::vector<SurfaceLink>& links = workspace.links();
  links.clear();
  for_each_vertex(workspace, [&](std::size_t slot, int index, std::uint16_t root) {
    const Owner owner(index);
    if (owner.brick < kHere) return;
    const std::uint16_t part = part_of(root);
    if (part == parts.count) return;
    const std::uint16_t element = element_of(slot, owner);
    if (owner.brick != kHere) {
      links.push_back({owner.brick, element, part});
    } else if (parts.count > 1) {
      parts.part_of.push_back({element, part});
    }
  });
  parts.links.assign(links.begin(), links.end());  // no larger than it need be: it is kept
  return vertices;
}

}  // namespace

void SurfaceCounts::add(const SurfaceCounts& more) noexcept {
  triangles += more.triangles;
  vertices += more.vertices;
  non_manifold_edges += more.non_manifold_edges;
  extra_pairs += more.extra_pairs;
  non_manifold_vertices += more.non_manifold_vertices;
}

void SurfaceCounts::add_fans(std::uint64_t fans) noexcept {
  vertices += fans;
  triangles += 2 * fans;
}

std::int64_t SurfaceCounts::euler_characteristic() const noexcept {
  const auto edges = static_cast<std::int64_t>(3 * triangles / 2 - extra_pairs);
  return static_cast<std::int64_t>(vertices) - edges + static_cast<std::int64_t>(triangles);
}

std::uint16_t SurfaceParts::part(std::uint16_t element) const noexcept {
  if (count < 2) return 0;
  const auto at = std::lower_bound(part_of.begin(), part_of.end(),
                                   std::array<std::uint16_t, 2>{element, 0});
  return (*at)[1];
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

SurveyedSurface survey_surface(const WarpedLattice& lattice, SurfaceWorkspace& workspace) {
  workspace.clear();
  SurfaceWalk surface(lattice, workspace);
  surface.walk();
  SurveyedSurface found;
  found.counts.triangles = surface.triangles();
  found.counts.vertices = find_parts(workspace, found.parts);
  count_nodes(lattice, found.counts);
  return found;
}

std::array<BrickMask, kNodeKinds> non_manifold_nodes(
    const std::array<HaloSet, kNodeKinds>& plus,
    const std::array<HaloSet, kNodeKinds>& zero) noexcept {
  std::array<HaloSet, kNodeKinds> bad;
  for (const NodeKind kind : {kCorner, kCentre}) {
    for_each_bit(zero[kind] & kOwnNodes, [&](int node) {
      const NodeLink link = link_of(plus, zero, kind, node);
      if (link.plus != 0 && !surface_at(link).manifold) bad[kind].set(node);
    });
  }
  return {brick_part(bad[kCorner]), brick_part(bad[kCentre])};
}

}  // namespace tet
