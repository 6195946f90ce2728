// Where the surface of a scene crosses lattice edges.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/types.h"
#include "core/field/phi_field.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/zero_bracket.h"

namespace tet {

/// Edges of one family are worked on this many at a time.
inline constexpr std::size_t kSceneEdges = 64;

/// Up to kSceneEdges edges in one direction, by their lower nodes.
struct SceneEdges {
  BrickCoord brick;
  NodeKind kind = kCorner;
  int direction = 0;
  std::span<const std::uint16_t> low;  ///< halo indices
  const float* low_phi = nullptr;      ///< of each edge, at its lower node
  const float* high_phi = nullptr;     ///< at its upper node, of the other sign
};

/// Fractions of the edges, from the lower node: within kZeroTolerance of a zero, and the same
/// whichever brick asks, beside whichever other edges. `sampler` sampled the brick last.
void find_scene_zeros(PhiSampler& sampler, const SceneEdges& edges, float* fraction) noexcept;

}  // namespace tet
