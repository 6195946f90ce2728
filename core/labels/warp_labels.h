// Moving nodes onto interfaces that lie too close to them, all at once.
#pragma once

#include <array>
#include <cstdint>

#include "core/labels/label.h"
#include "core/labels/label_samples.h"
#include "core/stuffing/cut_edges.h"
#include "core/stuffing/stuffing_rules.h"

namespace tet {

/// The lattice after the warp; valid for nodes in [kNodeMin, kNodeMax]^3 and edges between
/// them.
struct WarpedLabels {
  std::array<HaloSet, kNodeKinds> joker;  ///< nodes that moved
  /// Tells of jokers the direction, 0..13, of the edge whose cut point the node moved onto.
  alignas(64) std::array<std::array<std::uint8_t, kHaloNodes>, kNodeKinds> direction;
  /// The samples' labels, and kJoker where a node moved.
  alignas(64) std::array<std::array<Label, kHaloNodes>, kNodeKinds> label;
  EdgeSets differs;  ///< ends are not alike: different labels, or one end is a joker
  EdgeSets cut;      ///< ends have different labels: the edge has a cut point
};

/// Decides every warp from the original labels and fractions, so that no order exists. A node
/// moves if for each label next to it, but its own, some edge to a node of that label has a cut
/// point that violates it: it goes onto the nearest violating one (ties: lowest direction).
/// With two labels around a node that is every violated node. Cut points between nodes that
/// stay are then put at the nearest fraction in [alpha, 1 - alpha].
void warp_labels(const EdgeSets& changes,
                 const WarpLimits& limits,
                 LabelSamples& samples,
                 WarpedLabels& warped) noexcept;

}  // namespace tet
