#include "core/stuffing/scene_zeros.h"

#include "core/scene/scene_evaluator.h"
#include "core/stuffing/zero_bracket.h"

namespace tet {
namespace {

/// Doubled lattice coordinates of a lower node, of the whole lattice: what a point on its edge
/// is computed from must not depend on the brick.
struct EdgeStart {
  double x = 0, y = 0, z = 0;
};

EdgeStart start_of(const SceneEdges& edges, std::uint16_t low) noexcept {
  const LatticeCoord node = node_coord(edges.kind, low);
  return {16.0 * edges.brick.x + node.x, 16.0 * edges.brick.y + node.y,
          16.0 * edges.brick.z + node.z};
}

}  // namespace

void find_scene_zeros(PhiSampler& sampler, const SceneEdges& edges, float* fraction) noexcept {
  const LatticeCoord along = kDirection[static_cast<std::size_t>(edges.direction)];
  const double half = 0.5 * sampler.field().spacing_voxels;
  const std::size_t count = edges.low.size();
  std::array<ZeroBracket, kSceneEdges> bracket;
  std::array<EdgeStart, kSceneEdges> start;
  std::array<std::uint16_t, kSceneEdges> open;  // edges whose zero is still looked for
  for (std::size_t i = 0; i < count; ++i) {
    start[i] = start_of(edges, edges.low[i]);
    bracket[i].begin(static_cast<double>(edges.low_phi[i]),
                     static_cast<double>(edges.high_phi[i]));
    open[i] = static_cast<std::uint16_t>(i);
  }
  scene::Points points;
  std::size_t left = count;
  for (int step = 0; step < ZeroBracket::kMaxSteps && left > 0; ++step) {
    for (std::size_t i = 0; i < left; ++i) {
      const EdgeStart& from = start[open[i]];
      const double t = bracket[open[i]].next;
      points.x[i] = half * (from.x + t * along.x);
      points.y[i] = half * (from.y + t * along.y);
      points.z[i] = half * (from.z + t * along.z);
    }
    const double* phi = sampler.scene().evaluate(points, left);
    std::size_t still = 0;
    for (std::size_t i = 0; i < left; ++i) {
      bracket[open[i]].narrow(phi[i]);
      if (!bracket[open[i]].done) open[still++] = open[i];
    }
    left = still;
  }
  for (std::size_t i = 0; i < count; ++i) fraction[i] = static_cast<float>(bracket[i].zero());
}

}  // namespace tet
