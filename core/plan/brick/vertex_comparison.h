// Which vertices the bricks of a level keep.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/base/types.h"
#include "core/mesh/stable/splice.h"
#include "core/plan/brick/changed_reach.h"
#include "core/plan/brick/counted_mesh.h"
#include "core/plan/brick/found_geometry.h"
#include "core/plan/brick/kept_vertices.h"

namespace tet {

/// Vertices that bricks of one level had and have.
class VertexComparison {
 public:
  VertexComparison(const ComparedMesh& earlier,
                   const ComparedMesh& now,
                   int level,
                   PatchDetail detail)
      : level_(level),
        detail_(detail),
        earlier_(earlier),
        now_(now),
        geometry_before_(earlier),
        geometry_(now) {}

  /// Looks at a brick by its places before and now: kNewBrick where it is not there.
  void look_at(std::size_t before, std::size_t brick);

  /// The brick, which is not as it was; `cells` are divided otherwise.
  ChangedBrick changed(BrickCoord brick, const BrickMask& cells) const;

  /// Adds the vertices that it keeps, where it is there in both; `cells` are those that keep
  /// the middles of their surface quads.
  void add_runs(const BrickMask& cells, std::vector<KeptRun>& runs) const;

 private:
  OwnedVertices vertices_of(const CountedMesh& mesh, std::size_t brick) const;

  int level_;
  PatchDetail detail_;
  const ComparedMesh& earlier_;
  const ComparedMesh& now_;
  FoundGeometry geometry_before_, geometry_;
  OwnedVertices had_, has_;
  VertexMasks kept_;
};

}  // namespace tet
