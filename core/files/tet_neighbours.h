// Which tet lies behind each face of each tet.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/cancel.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Four numbers of tets for each tet, found range of vertices by range, so that little is held
/// beside them. For meshes of fewer than 2^32 tets and vertices.
class TetNeighbours {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// Once `cancellation` is requested it ends soon, and tells of no faces.
  explicit TetNeighbours(const TetMesh& mesh, const Cancellation& cancellation = {});

  /// Behind the face with that TetFace::index; kNone at the boundary.
  std::uint32_t operator[](std::uint64_t face) const noexcept { return behind_[face]; }
  std::uint64_t size() const noexcept { return behind_.size(); }
  /// Faces between two tets.
  std::uint64_t inner_faces() const noexcept { return inner_faces_; }

 private:
  /// False if it was cancelled before all were found.
  bool find(const TetMesh& mesh, const Cancellation& cancellation);

  std::vector<std::uint32_t> behind_;
  std::uint64_t inner_faces_ = 0;
};

}  // namespace tet
