// The faces of a mesh in OpenFOAM's order: those between two cells, by the lower of them and
// then the higher; then the boundary's, patch by patch.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/files/face_groups.h"
#include "core/files/tet_neighbours.h"

namespace tet {

/// Faces of the boundary, one behind the other among those.
struct FoamPatch {
  std::string name;
  std::uint64_t first = 0, faces = 0;
};

/// Faces between two cells that have a name.
struct FoamZone {
  std::string name;
  struct Face {
    std::uint64_t number = 0;
    /// Faces look out of the lower of their cells, and names are about one of the two.
    bool flipped = false;
    auto operator<=>(const Face&) const = default;
  };
  std::vector<Face> faces;  ///< ascending, each once
};

class FoamFaces {
 public:
  /// Once `cancellation` is requested it ends soon, and tells of no faces.
  explicit FoamFaces(const TetMesh& mesh, const Cancellation& cancellation = {});

  std::uint64_t inner_count() const noexcept { return behind_.inner_faces(); }
  std::uint64_t count() const noexcept { return inner_count() + boundary_.size(); }
  /// The boundary's faces, in the order of the patches.
  std::span<const std::uint64_t> boundary() const noexcept { return boundary_; }
  const std::vector<FoamPatch>& patches() const noexcept { return patches_; }
  /// One for each name that faces between two tets have: the interface's, and regions' of it.
  const std::vector<FoamZone>& zones() const noexcept { return zones_; }
  const TetNeighbours& behind() const noexcept { return behind_; }

 private:
  void sort_boundary(const FaceGroups& groups);
  void find_zones(const FaceGroups& groups);

  TetNeighbours behind_;
  std::vector<std::uint64_t> boundary_;  ///< see TetFace::index
  std::vector<FoamPatch> patches_;
  std::vector<FoamZone> zones_;
};

/// Hands out the faces between two tets in their order.
class InnerFoamFaces {
 public:
  struct Face {
    std::uint32_t behind = 0;  ///< the higher tet
    std::uint64_t index = 0;   ///< see TetFace; of the lower
  };

  explicit InnerFoamFaces(const TetNeighbours& behind) : behind_(behind) {}

  /// Called as often as there are faces.
  Face next() noexcept {
    while (begin_ == end_) load(tet_++);
    return waiting_[begin_++];
  }

 private:
  void load(std::uint64_t tet) noexcept {
    begin_ = end_ = 0;
    for (std::uint64_t face = 4 * tet; face < 4 * tet + 4; ++face) {
      const std::uint32_t other = behind_[face];
      if (other == TetNeighbours::kNone || other <= tet) continue;
      std::size_t place = end_++;
      for (; place > 0 && waiting_[place - 1].behind > other; --place) {
        waiting_[place] = waiting_[place - 1];
      }
      waiting_[place] = {other, face};
    }
  }

  const TetNeighbours& behind_;
  std::uint64_t tet_ = 0;
  std::array<Face, 4> waiting_;
  std::size_t begin_ = 0, end_ = 0;
};

}  // namespace tet
