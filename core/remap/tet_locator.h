// Which tet of a mesh a point lies in, or next to.
#pragma once

#include <cstdint>

#include "core/mesh/box_tree.h"
#include "core/remap/data_mesh.h"
#include "core/remap/tet_coordinates.h"

namespace tet {

/// Finds tets by their place. Immutable: any thread may ask. The mesh must outlive it.
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

  /// `hint`, a tet that may be the one, is asked first: what it finds depends on it where tets
  /// share the point.
  Place find(const WorldPoint& p, std::uint32_t hint = 0) const;

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
  Place nearest(const WorldPoint& p, std::uint32_t hint) const;

  const DataMesh& mesh_;
  BoxTree tree_;
};

/// The box around a tet.
WorldBox box_around(const std::array<WorldPoint, 4>& places) noexcept;

}  // namespace tet
