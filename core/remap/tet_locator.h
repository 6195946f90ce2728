// Which tet of a mesh a point lies in, or next to.
#pragma once

#include <cstdint>
#include <optional>

#include "core/mesh/box_tree.h"
#include "core/remap/data_mesh.h"
#include "core/remap/tet_coordinates.h"
#include "core/remap/tet_neighbors.h"

namespace tet {

/// Finds tets by their place. Immutable: any thread may ask. The mesh must outlive it.
///
/// A point next to the one before is found by a walk from tet to neighbouring tet; any other in
/// a tree of the tets' boxes. What lies outside is nearest to a face of the border, and these
/// are in a tree of their own.
class TetLocator {
 public:
  /// The mesh has a tet. Parallel.
  explicit TetLocator(const DataMesh& mesh);

  struct Place {
    std::uint32_t tet = 0;
    CornerShares shares{};  ///< negative ones where the point is outside
    bool outside = false;   ///< of every tet: this is the nearest one
    double distance = 0;    ///< from it, where outside
  };

  /// `near`, a tet that may be close to the point, is where the walk begins: what is found
  /// depends on it where tets share the point, or are as near.
  Place find(const WorldPoint& p, std::optional<std::uint32_t> near = {}) const;

  /// Calls `visit(tet)` for every tet whose box touches `box`.
  template <class Visit>
  void visit_touching(const WorldBox& box, const Visit& visit) const {
    tree_.visit_touching(box, [&](std::uint32_t tet) {
      visit(tet);
      return true;
    });
  }

  const DataMesh& mesh() const noexcept { return mesh_; }

 private:
  /// How a walk ended: in the tet around the point, or at a face of the border, or nowhere.
  struct Walk {
    std::optional<Place> found;
    std::optional<BorderFace> border;
  };
  Walk walk(const WorldPoint& p, std::uint32_t from) const noexcept;
  std::optional<Place> look_up(const WorldPoint& p) const;
  Place nearest(const WorldPoint& p, const std::optional<BorderFace>& seen) const;

  const DataMesh& mesh_;
  TetNeighbors neighbors_;
  BoxTree tree_;    // of all tets
  BoxTree border_;  // of the border's faces
};

/// The box around a tet.
WorldBox box_around(const std::array<WorldPoint, 4>& places) noexcept;

}  // namespace tet
