#include "core/files/boundary_mesh.h"

namespace tet {

BoundaryMesh::BoundaryMesh(const TetMesh& mesh, const Cancellation& cancellation)
    : mesh_(mesh), faces_(mesh, cancellation), vertices_(mesh.header.vertex_count) {
  for (std::uint64_t i = 0; i < faces_.count(); ++i) {
    for (const std::uint64_t vertex : faces_.triangle(i)) vertices_.set(vertex);
  }
  vertices_.count_ranks();
}

}  // namespace tet
