#include "core/plan/brick/vertex_comparison.h"

#include <cstdint>

#include "core/plan/brick/kept_runs.h"

namespace tet {

void VertexComparison::look_at(std::size_t before, std::size_t brick) {
  had_ = before == kNewBrick ? OwnedVertices{} : vertices_of(earlier_.mesh, before);
  has_ = brick == kNewBrick ? OwnedVertices{} : vertices_of(now_.mesh, brick);
  kept_ = {};
  if (before == kNewBrick || brick == kNewBrick || detail_ == PatchDetail::kWhole) return;
  if (had_.at_surface && has_.at_surface) {
    had_.geometry = geometry_before_.of_brick(before).data();
    has_.geometry = geometry_.of_brick(brick).data();
  }
  kept_ = kept_vertices(had_, has_);
}

ChangedBrick VertexComparison::changed(BrickCoord brick, const BrickMask& cells) const {
  const VertexMasks vertices = changed_vertices(had_, has_, kept_);
  ChangedBrick changed{brick, cells, vertices.node[kCorner],
                       vertices.node[kCorner] | vertices.node[kCentre]};
  for (const BrickMask& cut : vertices.cut) changed.nodes |= cut;
  return changed;
}

void VertexComparison::add_runs(const BrickMask& cells, std::vector<KeptRun>& runs) const {
  RunWalk walk(had_.first, has_.first, runs);
  for (const NodeKind kind : {kCorner, kCentre}) {
    walk.pass(*had_.node[kind], *has_.node[kind], kept_.node[kind]);
  }
  static const StuffedBrick none{};
  const StuffedBrick& a = had_.at_surface ? *had_.stuffed : none;
  const StuffedBrick& b = has_.at_surface ? *has_.stuffed : none;
  for (std::size_t family = 0; family < kEdgeFamilies; ++family) {
    walk.pass(a.cut[family], b.cut[family], kept_.cut[family]);
  }
  if (had_.fans == nullptr || has_.fans == nullptr) return;
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    walk.pass((*had_.fans)[shape], (*has_.fans)[shape], cells);
  }
}

OwnedVertices VertexComparison::vertices_of(const CountedMesh& mesh, std::size_t brick) const {
  if (level_ == 0) return mesh.vertices_of_finest(brick);
  const LevelNodes& nodes = mesh.nodes(level_);
  OwnedVertices owned{.node = {&nodes.corner[brick], &nodes.centre[brick]}};
  // While bricks are compared to be counted there are no ids yet.
  if (!nodes.first_vertex.empty()) owned.first = nodes.first_vertex[brick];
  return owned;
}

}  // namespace tet
