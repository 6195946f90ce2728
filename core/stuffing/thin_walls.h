// Walls too thin for the lattice: where the surface is crossed twice within about a spacing.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/field/phi_field.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/cut_points.h"

namespace tet {

/// A wall crossed by a lattice line in a chord shorter than this many spacings is unresolved.
///
/// Found by experiment on shells and shell-shaped gaps of every direction: the longest of the
/// shortest chords of a mesh with a wrong topology was 1.16 spacings for walls of inside and
/// 0.97 for gaps, and no mesh without a shorter chord was wrong.
inline constexpr float kResolvedChord = 1.25F;

/// Thin spots of one brick. A spot is a lattice node that a lattice line meets between two cut
/// points, or a lattice edge that the surface crosses more than once.
struct ThinSpots {
  /// Chords are counted by whole 1/32 spacings.
  static constexpr int kBinsPerSpacing = 32;
  static constexpr int kBins = static_cast<int>(kResolvedChord * kBinsPerSpacing);

  std::uint32_t inside = 0;   ///< spots where the wall is of inside
  std::uint32_t outside = 0;  ///< spots where it is of outside: a gap
  /// Smallest box of the spots' nodes, relative to the brick's lowest corner; of edges, the
  /// lower node.
  LatticeCoord min{INT32_MAX, INT32_MAX, INT32_MAX}, max{INT32_MIN, INT32_MIN, INT32_MIN};
  std::array<std::uint32_t, kBins> chords{};  ///< shortest chord of each spot

  bool any() const noexcept { return inside + outside > 0; }
  /// `chord` in spacings, below kResolvedChord.
  void add(LatticeCoord node, bool is_inside, float chord) noexcept;
};

/// Adds the brick's own nodes that lie in a thin wall: both neighbours along a lattice line
/// have the opposite sign, the chord between the two cut points is short, and the surface faces
/// away from the node at both. Where it does not, the line only grazes something thick.
void find_thin_nodes(const BrickSamples& samples,
                     const CutPoints& cuts,
                     ThinSpots& spots) noexcept;

/// Adds the brick's own lattice edges that cross a wall between their ends; for lattices
/// coarser than the voxels. Only edges in cells whose voxels have both signs are looked at, at
/// up to 15 points each.
void find_thin_edges(const BrickSamples& samples,
                     PhiSampler& sampler,
                     BrickCoord brick,
                     ThinSpots& spots);

}  // namespace tet
