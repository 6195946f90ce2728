// Where the surface of a scene crosses lattice edges.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/types.h"
#include "core/field/phi_field.h"
#include "core/lattice/bcc.h"

namespace tet {

/// Edges of one family are worked on this many at a time.
inline constexpr std::size_t kSceneEdges = 64;

/// How far a cut point may be from a zero of the scene, in edges.
inline constexpr double kZeroTolerance = 1e-6;

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
///
/// Begins with the zero of the line between the ends, and goes on with Chandrupatla's steps
/// (Adv. Eng. Software 28, 1997): inverse quadratic where that is safe, else halves.
void find_scene_zeros(PhiSampler& sampler, const SceneEdges& edges, float* fraction) noexcept;

}  // namespace tet
