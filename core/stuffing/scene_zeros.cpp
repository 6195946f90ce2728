#include "core/stuffing/scene_zeros.h"

#include <algorithm>
#include <cmath>

#include "core/scene/scene_evaluator.h"

namespace tet {
namespace {

/// Steps end this near to each end of a bracket at most, in edges.
constexpr double kShortest = kZeroTolerance / 2;
/// Halving twice for each bit of the tolerance is the worst case.
constexpr int kMaxSteps = 64;

/// A bracket around one zero: `x` was tried last, phi has the other sign at `other`, and `old`
/// was given up.
struct Bracket {
  double x = 0, f = 0, other = 1, f_other = 0, old = 0, f_old = 0;
  double next = 0;  ///< to be tried
  bool done = false;

  void begin(double at_0, double at_1) noexcept {
    f = at_0;
    f_other = at_1;
    next = std::clamp(at_0 / (at_0 - at_1), kShortest, 1 - kShortest);
  }

  /// phi is `value` at `next`.
  void narrow(double value) noexcept {
    const bool same_side = (value < 0) == (f < 0);
    old = same_side ? x : other;
    f_old = same_side ? f : f_other;
    other = same_side ? other : x;
    f_other = same_side ? f_other : f;
    x = next;
    f = value;
    const double width = other - x;
    // Never nearer to an end than the tolerance: the last step lands beyond the zero.
    const double nearest = kShortest / std::abs(width);
    done = f == 0 || nearest > 0.5;
    next = x + std::clamp(step(), std::min(nearest, 0.5), std::max(1 - nearest, 0.5)) * width;
  }

  double zero() const noexcept { return std::abs(f) < std::abs(f_other) ? x : other; }

 private:
  /// The next point, as a part of the way from x to the other end.
  double step() const noexcept {
    const double xi = (x - other) / (old - other), phi = (f - f_other) / (f_old - f_other);
    if (!(phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi)) return 0.5;
    return f / (f_other - f) * f_old / (f_other - f_old) +
           (old - x) / (other - x) * f / (f_old - f) * f_other / (f_old - f_other);
  }
};

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
  std::array<Bracket, kSceneEdges> bracket;
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
  for (int step = 0; step < kMaxSteps && left > 0; ++step) {
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
