// What makes a mesh one of second order: a node in the middle of each edge.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/byte_buffer.h"
#include "core/base/types.h"
#include "core/base/vec3.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// The corners that each edge of a tet joins, in the order of its middle nodes: VTK's and
/// Abaqus's. Gmsh has the last two the other way round.
inline constexpr std::array<std::array<std::size_t, 2>, 6> kTetEdges{
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// The middle of an edge, moved by `off`, as the mesh stores it: `a` and `b` are stored
/// positions.
inline WorldPoint stored_middle(const MeshHeader& header,
                                const WorldPoint& a,
                                const WorldPoint& b,
                                const Vector& off) noexcept {
  const WorldPoint middle{(a.x + b.x) / 2 + off.x, (a.y + b.y) / 2 + off.y,
                          (a.z + b.z) / 2 + off.z};
  if (header.coordinate_type == CoordinateType::kFloat64) return middle;
  const auto rounded = [](double v) { return static_cast<double>(static_cast<float>(v)); };
  return {rounded(middle.x), rounded(middle.y), rounded(middle.z)};
}

/// Middle nodes beside a mesh, in its own types: node i of them is the mesh's node
/// vertex_count + i. They are sorted by the lower vertex of their edge, then by the higher one.
struct MiddleNodes {
  std::uint64_t count = 0;
  ByteBuffer positions;  ///< count * 3 coordinates, relative to the mesh's origin
  ByteBuffer fields;     ///< count rows, as TetMesh::fields has them
  /// 6 * tet_count numbers below `count`, in the order of kTetEdges.
  std::vector<std::uint32_t> of_tets;
  std::uint64_t curved = 0;        ///< of the edges: their middles lie off the straight line
  std::uint64_t straightened = 0;  ///< of the surface's: straight, or less curved than it

  std::array<std::uint32_t, 6> of_tet(std::uint64_t tet) const noexcept {
    std::array<std::uint32_t, 6> middles;
    for (std::size_t e = 0; e < 6; ++e) middles[e] = of_tets[6 * tet + e];
    return middles;
  }
  /// The position as it is stored, relative to the mesh's origin.
  WorldPoint stored_position(const MeshHeader& header, std::uint64_t i) const noexcept {
    const MeshView view{header.coordinate_type, header.index_type, positions.bytes(), {}};
    return view.stored_position(i);
  }
};

}  // namespace tet
