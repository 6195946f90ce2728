// Where the surface crosses the lattice edges of one brick.
#pragma once

#include <array>
#include <memory>

#include "core/base/brick_mask.h"
#include "core/grid/phi_field.h"
#include "core/lattice/bcc.h"

namespace tet {

/// Signs of the samples of a brick and its halo, by node kind. A node in neither set is exactly
/// zero (or outside the samples).
struct NodeSigns {
  std::array<HaloSet, kNodeKinds> inside;   ///< phi < 0: the `+` of the stencils
  std::array<HaloSet, kNodeKinds> outside;  ///< phi > 0: the `-`

  /// True when every sample is inside, or none is.
  bool one_sided() const noexcept;
};

void find_signs(const BrickSamples& samples, NodeSigns& signs) noexcept;

/// Nodes whose signs and warps a brick needs to know: its own, one more on each side.
inline constexpr int kNodeMin = -1, kNodeMax = 8;

/// Cut points of every edge with an end among the nodes in [kNodeMin, kNodeMax]^3.
///
/// `fraction[family]` is valid where `cut[family]` has a bit: it runs from the lower node
/// (whose halo index this is) along the edge, in [0, 1]. Error: two bracketed secant steps on
/// the trilinear field behind the linear guess; the first guess alone is off by O(h^2). Source:
/// Labelle & Shewchuk 2007, section 3.
struct CutPoints {
  NodeSigns signs;
  std::array<HaloSet, kEdgeFamilies> cut;
  std::array<std::array<float, kHaloNodes>, kEdgeFamilies> fraction;
};

/// Finds the cut points between nodes whose signs are known; `sampler` answers for the true
/// field between lattice nodes.
void find_cut_points(const BrickSamples& samples,
                     PhiSampler& sampler,
                     BrickCoord brick,
                     CutPoints& cuts) noexcept;

}  // namespace tet
