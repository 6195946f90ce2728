#include "core/labels/warp_labels.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace tet {
namespace {

/// What lies at the other end of one of a node's edges.
struct EdgeSeen {
  NodeKind end;
  int to_end;  ///< from the node's halo index
  std::size_t family;
  int to_low;     ///< from the node's halo index
  bool from_low;  ///< the node is the lower end
  bool is_long;
};

constexpr auto kEdgesSeen = [] {
  std::array<std::array<EdgeSeen, kDirections>, kNodeKinds> edges{};
  for (const NodeKind kind : {kCorner, kCentre}) {
    for (int direction = 0; direction < kDirections; ++direction) {
      const NodeKind end = end_kind(kind, direction);
      const int to_end = end_offset(kind, direction);
      const bool owned = direction < kOwnedDirections;
      edges[kind][static_cast<std::size_t>(direction)] = {
          end,
          to_end,
          static_cast<std::size_t>(owned ? edge_family(kind, direction)
                                         : edge_family(end, opposite(direction))),
          owned ? 0 : to_end,
          owned,
          is_long(direction)};
    }
  }
  return edges;
}();

/// The labels around one node, and which of them violate it.
class Around {
 public:
  void add(Label label, bool violates) noexcept {
    std::size_t i = 0;
    while (i < count_ && label_[i] != label) ++i;
    if (i == count_) {
      label_[count_] = label;
      violating_[count_++] = false;
    }
    violating_[i] = violating_[i] || violates;
  }
  /// Every one of them violates it.
  bool all_violate() const noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      if (!violating_[i]) return false;
    }
    return count_ > 0;
  }

 private:
  std::array<Label, kDirections> label_;
  std::array<bool, kDirections> violating_;
  std::size_t count_ = 0;
};

constexpr std::uint8_t kStays = 0xff;

/// The direction in which a node moves, or kStays.
std::uint8_t moves_along(const LabelSamples& samples,
                         NodeKind kind,
                         int node,
                         const WarpLimits& limits) noexcept {
  const Label own = samples.label[kind][static_cast<std::size_t>(node)];
  Around around;
  float nearest = std::numeric_limits<float>::infinity();
  std::uint8_t along = kStays;
  for (std::size_t direction = 0; direction < kDirections; ++direction) {
    const EdgeSeen& edge = kEdgesSeen[kind][direction];
    const Label other = samples.label[edge.end][static_cast<std::size_t>(node + edge.to_end)];
    if (other == own) continue;
    const float t = samples.fraction[edge.family][static_cast<std::size_t>(node + edge.to_low)];
    const float rest = 1 - t;
    const bool nearer_to_low = t < rest;  // it violates the nearer end only
    const float share = nearer_to_low ? t : rest;
    const float alpha = edge.is_long ? limits.alpha_long : limits.alpha_short;
    const bool violates = nearer_to_low == edge.from_low && share < alpha;
    around.add(other, violates);
    const float distance = share * (edge.is_long ? kLongLength : kShortLength);
    if (violates && distance < nearest) {
      nearest = distance;
      along = static_cast<std::uint8_t>(direction);
    }
  }
  return around.all_violate() ? along : kStays;
}

/// Nodes with an edge to another label.
std::array<HaloSet, kNodeKinds> beside_changes(const EdgeSets& changes) noexcept {
  std::array<HaloSet, kNodeKinds> beside;
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const NodeKind kind = family_kind(family);
    const NodeKind end = end_kind(kind, family_direction(family));
    const HaloSet& edges = changes[static_cast<std::size_t>(family)];
    beside[kind] |= edges;
    beside[end] |= seen_from(edges, -end_offset(kind, family_direction(family)));
  }
  for (HaloSet& nodes : beside) nodes &= kKnownNodes;
  return beside;
}

/// Finds the cut points that remain, and takes those that are too near to a node away from it.
void settle_cuts(const WarpLimits& limits,
                 LabelSamples& samples,
                 WarpedLabels& warped) noexcept {
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const auto f = static_cast<std::size_t>(family);
    const NodeKind kind = family_kind(family);
    const NodeKind end = end_kind(kind, family_direction(family));
    const int offset = end_offset(kind, family_direction(family));
    warped.differs[f] &= kKnownNodes & seen_from(kKnownNodes, offset);
    warped.cut[f] =
        warped.differs[f] - warped.joker[kind] - seen_from(warped.joker[end], offset);
    const float alpha =
        is_long(family_direction(family)) ? limits.alpha_long : limits.alpha_short;
    for_each_bit(warped.cut[f], [&](int low) {
      float& fraction = samples.fraction[f][static_cast<std::size_t>(low)];
      fraction = std::clamp(fraction, alpha, 1 - alpha);
    });
  }
}

}  // namespace

void warp_labels(const EdgeSets& changes,
                 const WarpLimits& limits,
                 LabelSamples& samples,
                 WarpedLabels& warped) noexcept {
  warped.label = samples.label;
  const std::array<HaloSet, kNodeKinds> beside = beside_changes(changes);
  for (const NodeKind kind : {kCorner, kCentre}) {
    warped.joker[kind] = {};
    for_each_bit(beside[kind], [&](int node) {
      const std::uint8_t along = moves_along(samples, kind, node, limits);
      if (along == kStays) return;
      const auto n = static_cast<std::size_t>(node);
      warped.joker[kind].set(node);
      warped.direction[kind][n] = along;
      warped.label[kind][n] = kJoker;
    });
  }
  find_label_changes(warped.label, warped.differs);
  settle_cuts(limits, samples, warped);
}

}  // namespace tet
