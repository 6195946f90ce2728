// Meshes of ten-node tets to files.
#pragma once

#include <array>
#include <cstdint>

#include <absl/status/status.h>

#include "core/files/block_writer.h"
#include "core/files/mesh_file.h"
#include "core/mesh/tet_mesh.h"
#include "core/second_order/middle_nodes.h"

namespace tet {

/// A mesh and its middle nodes, which somebody else holds. In a file the middle nodes follow
/// the vertices.
struct SecondOrderMesh {
  const TetMesh& mesh;
  const MiddleNodes& middles;

  std::uint64_t node_count() const noexcept { return mesh.header.vertex_count + middles.count; }
  /// World coordinates.
  WorldPoint node(std::uint64_t i) const noexcept;
  /// The ten nodes of a tet: its corners, then the middles of its edges in the order of
  /// kTetEdges.
  std::array<std::uint64_t, 10> nodes_of(std::uint64_t tet) const noexcept;
};

/// OK, or kInvalidArgument where the format has no place for them.
absl::Status check_second_order_format(const MeshOutput& output);

/// Writes .vtu (VTK_QUADRATIC_TETRA) or .msh (type 11, and type 9 of surfaces), whole or not at
/// all. Errors: those of check_second_order_format and write_mesh_file.
absl::Status write_second_order_file(const MeshOutput& output,
                                     const SecondOrderMesh& mesh,
                                     const WriteControl& control = {});

/// The two formats; the file is left for the caller to commit.
absl::Status write_second_order_vtu(AtomicFile& file,
                                    const SecondOrderMesh& mesh,
                                    const WriteControl& control);
absl::Status write_second_order_msh(AtomicFile& file,
                                    const SecondOrderMesh& mesh,
                                    const WriteControl& control);

}  // namespace tet
