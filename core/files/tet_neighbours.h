// Which tet lies behind each face of each tet.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/mesh/tet_mesh.h"

namespace tet {

/// Four numbers of tets for each tet, found range of vertices by range, so that little is held
/// beside them. For meshes of fewer than 2^32 tets and vertices.
class TetNeighbours {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  explicit TetNeighbours(const TetMesh& mesh);

  /// Behind the face with that TetFace::index; kNone at the boundary.
  std::uint32_t operator[](std::uint64_t face) const noexcept { return behind_[face]; }
  std::uint64_t size() const noexcept { return behind_.size(); }
  /// Faces between two tets.
  std::uint64_t inner_faces() const noexcept { return inner_faces_; }

 private:
  std::vector<std::uint32_t> behind_;
  std::uint64_t inner_faces_ = 0;
};

}  // namespace tet
