// The boundary of a mesh as a surface of its own: what .stl, .ply and .obj files hold.
#pragma once

#include <cstdint>

#include "core/base/rank_mask.h"
#include "core/files/face_groups.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// All faces of FaceGroups, and their vertices numbered among themselves, in the mesh's order.
class BoundaryMesh {
 public:
  /// Once `cancellation` is requested it ends soon, and has no faces.
  explicit BoundaryMesh(const TetMesh& mesh, const Cancellation& cancellation = {});

  const TetMesh& mesh() const noexcept { return mesh_; }
  const FaceGroups& faces() const noexcept { return faces_; }
  std::uint64_t vertex_count() const noexcept { return vertices_.count(); }
  /// A triangle of the new numbers.
  Triangle triangle(std::uint64_t i) const noexcept {
    const auto [a, b, c] = faces_.triangle(i);
    return {vertices_.rank(a), vertices_.rank(b), vertices_.rank(c)};
  }
  /// The mesh's first vertex from `first` on that is one of the boundary; there is one.
  std::uint64_t vertex_from(std::uint64_t first) const noexcept {
    return vertices_.next(first);
  }

 private:
  const TetMesh& mesh_;
  FaceGroups faces_;
  RankMask vertices_;
};

}  // namespace tet
