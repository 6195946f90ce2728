#include "core/stuffing/scene_zeros.h"

#include "core/base/vector_clones.h"
#include "core/scene/scene_evaluator.h"
#include "core/stuffing/zero_brackets.h"

namespace tet {
namespace {

/// Doubled lattice coordinates of lower nodes, of the whole lattice: what a point on an edge is
/// computed from must not depend on the brick.
struct EdgeStarts {
  std::array<double, kSceneEdges> x, y, z;

  /// Becomes those of `all` that `which` lists.
  void take(const EdgeStarts& all, const std::uint16_t* which, std::size_t count) noexcept {
    for (std::size_t i = 0; i < count; ++i) {
      x[i] = all.x[which[i]];
      y[i] = all.y[which[i]];
      z[i] = all.z[which[i]];
    }
  }
};

TET_VECTOR_CLONES
void find_starts(const SceneEdges& edges, EdgeStarts& out) noexcept {
  const double x = 16.0 * edges.brick.x, y = 16.0 * edges.brick.y, z = 16.0 * edges.brick.z;
  const std::uint16_t* low = edges.low.data();
  for (std::size_t i = 0; i < edges.low.size(); ++i) {
    const LatticeCoord node = node_coord(edges.kind, low[i]);
    out.x[i] = x + node.x;
    out.y[i] = y + node.y;
    out.z[i] = z + node.z;
  }
}

/// Points at `t` of edges that lie side by side.
TET_VECTOR_CLONES
void put_points(const double* start,
                const double* t,
                std::size_t count,
                double along,
                double half,
                double* out) noexcept {
  for (std::size_t i = 0; i < count; ++i) out[i] = half * (start[i] + t[i] * along);
}

}  // namespace

void find_scene_zeros(PhiSampler& sampler, const SceneEdges& edges, float* fraction) noexcept {
  const LatticeCoord along = kDirection[static_cast<std::size_t>(edges.direction)];
  const double half = 0.5 * sampler.field().spacing_voxels;
  EdgeStarts all, open;
  find_starts(edges, all);
  static_assert(kSceneEdges <= ZeroBrackets::kCapacity);
  ZeroBrackets brackets;
  brackets.begin(edges.low_phi, edges.high_phi, edges.low.size());
  const EdgeStarts* start = &all;
  scene::Points points;
  for (int step = 0; step < ZeroBracket::kMaxSteps && brackets.open() > 0; ++step) {
    const std::size_t count = brackets.open();
    put_points(start->x.data(), brackets.next(), count, along.x, half, points.x.data());
    put_points(start->y.data(), brackets.next(), count, along.y, half, points.y.data());
    put_points(start->z.data(), brackets.next(), count, along.z, half, points.z.data());
    brackets.narrow(sampler.scene().evaluate(points, count), fraction);
    if (brackets.open() == count) continue;
    open.take(all, brackets.which(), brackets.open());
    start = &open;
  }
  brackets.end(fraction);
}

}  // namespace tet
