// On which side of the surface the lattice nodes of a brick lie, before any of them moves.
#pragma once

#include <array>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"

namespace tet {

struct BrickSamples;

/// Nodes whose signs and warps a brick needs to know: its own, one more on each side.
inline constexpr int kNodeMin = -1, kNodeMax = 8;
inline constexpr HaloSet kKnownNodes = halo_cube(kNodeMin, kNodeMax);

/// Signs of the samples of a brick and its halo, by node kind. A node in neither set is exactly
/// zero (or outside the samples).
struct NodeSigns {
  std::array<HaloSet, kNodeKinds> inside;   ///< phi < 0: the `+` of the stencils
  std::array<HaloSet, kNodeKinds> outside;  ///< phi > 0: the `-`

  /// True when every sample is inside, or none is.
  bool one_sided() const noexcept;
};

void find_signs(const BrickSamples& samples, NodeSigns& signs) noexcept;

}  // namespace tet
