// The boundary faces of a mesh by their names: physical surfaces, side sets, patches.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/rank_mask.h"
#include "core/files/file_mesh.h"
#include "core/mesh/find_faces.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Faces of one name, one behind the other among all of FaceGroups.
struct FaceGroup {
  std::int32_t tag = 1;  ///< its label's place in the mesh's list of them, from 1 on
  std::string name;
  FaceKind kind = FaceKind::kSurface;
  std::uint64_t first = 0, faces = 0;
};

/// A mesh's own faces, or where it has none those that are found. Eight bytes a face.
class FaceGroups {
 public:
  /// The mesh outlives the groups. Once `cancellation` is requested it ends soon, and there are
  /// none.
  explicit FaceGroups(const TetMesh& mesh, const Cancellation& cancellation = {});

  /// Those that have a face, in the order of their tags.
  const std::vector<FaceGroup>& groups() const noexcept { return groups_; }
  std::uint64_t count() const noexcept { return faces_.size(); }

  TetFace operator[](std::uint64_t i) const noexcept { return {faces_[i]}; }
  /// Vertices, counter-clockwise seen from outside the tet.
  Triangle triangle(std::uint64_t i) const noexcept {
    return face_of(mesh_.tet(faces_[i] / 4), faces_[i] % 4);
  }

  /// Replaces what is in `nodes`, a mask as long as those of the file, by the group's nodes.
  /// `mesh` is the one of the groups.
  void collect_nodes(const FileMesh& mesh, const FaceGroup& group, RankMask& nodes) const;

 private:
  const TetMesh& mesh_;
  std::vector<FaceGroup> groups_;
  std::vector<std::uint64_t> faces_;  ///< see TetFace::index
};

}  // namespace tet
