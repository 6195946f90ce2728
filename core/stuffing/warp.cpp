#include "core/stuffing/warp.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <emmintrin.h>
#include <numbers>
#include <utility>

#include "core/base/vector_clones.h"

namespace tet {
namespace {

constexpr HaloSet kNodes = halo_cube(kNodeMin, kNodeMax);
/// Words of a set that hold those nodes.
constexpr std::size_t kFirstWord = halo_index(kNodeMin, -2, -2) / 64;
constexpr std::size_t kEndWord = halo_index(kNodeMax + 1, -2, -2) / 64;

/// Lengths of long and short edges in units of the spacing.
constexpr float kLongLength = 1;
constexpr float kShortLength = static_cast<float>(std::numbers::sqrt3 / 2);

/// A violating cut point as a number that sorts like (distance, direction): the bits of a float
/// that is not negative sort like the float.
using Violation = std::uint64_t;
constexpr Violation kNoViolation = ~Violation{0};
Violation violation(float distance, int direction) noexcept {
  return Violation{std::bit_cast<std::uint32_t>(distance)} << 8 |
         static_cast<Violation>(direction);
}
/// All ones where there is none.
std::uint8_t direction_of(Violation violation) noexcept {
  return static_cast<std::uint8_t>(violation);
}

/// By kind and halo index, as one column.
constexpr std::size_t kAllNodes = std::size_t{kNodeKinds} * kHaloNodes;
using NearestViolations = std::array<Violation, kAllNodes>;
constexpr int node_slot(NodeKind kind, int index) noexcept { return kind * kHaloNodes + index; }

/// What a batch of one family's edges does to their ends: each violates one node or none.
struct ViolatedNodes {
  alignas(64) std::array<std::int32_t, kEdgeLanes> node;
  alignas(64) std::array<Violation, kEdgeLanes> by;
};

/// An edge family's ends, and what violates them.
struct FamilyLimits {
  int direction;
  std::int32_t to_low, to_high;  ///< from a lower node's halo index to the ends' slots
  float alpha, length;

  FamilyLimits(int family, const WarpLimits& limits) noexcept
      : direction(family_direction(family)),
        to_low(node_slot(family_kind(family), 0)),
        to_high(node_slot(end_kind(family_kind(family), direction),
                          end_offset(family_kind(family), direction))),
        alpha(is_long(direction) ? limits.alpha_long : limits.alpha_short),
        length(is_long(direction) ? kLongLength : kShortLength) {}
};

inline void find_violations(const FamilyLimits& family,
                            const std::uint16_t* low,
                            const float* fraction,
                            ViolatedNodes& out) noexcept {
  const int to_upper = family.direction, to_lower = opposite(family.direction);
  for (std::size_t i = 0; i < kEdgeLanes; ++i) {
    const float t = fraction[i], rest = 1 - t;
    const bool at_low = t < family.alpha, at_high = rest < family.alpha;
    const float distance = (at_low ? t : rest) * family.length;
    out.node[i] = low[i] + (at_low ? family.to_low : family.to_high);
    const Violation by = violation(distance, at_low ? to_upper : to_lower);
    out.by[i] = at_low | at_high ? by : kNoViolation;
  }
}

/// Finds each node's nearest violating cut point.
TET_VECTOR_CLONES
void find_nearest(const CutEdges& edges,
                  const WarpLimits& limits,
                  NearestViolations& nearest,
                  std::uint8_t* direction) noexcept {
  for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
    const FamilyLimits family(static_cast<int>(f), limits);
    const auto [begin, count] = edges.run[f];
    for (std::size_t first = 0; first < count; first += kEdgeLanes) {
      ViolatedNodes violated;
      find_violations(family, &edges.low[begin + first], &edges.fraction[begin + first],
                      violated);
      const std::size_t lanes = std::min(kEdgeLanes, count - first);
      for (std::size_t i = 0; i < lanes; ++i) {
        const auto node = static_cast<std::size_t>(violated.node[i]);
        nearest[node] = std::min(nearest[node], violated.by[i]);
        direction[node] = direction_of(nearest[node]);
      }
    }
  }
}

/// Forgets the violations of the nodes and of their neighbours, which share edges with them.
void clear_violations(NearestViolations& nearest) noexcept {
  for (const NodeKind kind : {kCorner, kCentre}) {
    for (int x = kNodeMin - 1; x <= kNodeMax + 1; ++x) {
      const auto row = [&](int y) {
        return nearest.begin() + node_slot(kind, halo_index(x, y, -2));
      };
      std::fill(row(kNodeMin - 1), row(kNodeMax + 2), kNoViolation);
    }
  }
}

/// The nodes of one kind that have a direction.
HaloSet nodes_with_direction(const std::array<std::uint8_t, kHaloNodes>& direction) noexcept {
  HaloSet nodes;
  for (std::size_t w = kFirstWord; w < kEndWord; ++w) {
    std::uint64_t none = 0;
    for (std::size_t row = 0; row < 4; ++row) {
      const __m128i bytes =
          _mm_loadu_si128(reinterpret_cast<const __m128i*>(&direction[(w * 4 + row) * 16]));
      const auto bits = static_cast<unsigned>(_mm_movemask_epi8(bytes));
      none |= std::uint64_t{bits} << (row * 16);
    }
    nodes.word[w] = kNodes.word[w] & ~none;
  }
  return nodes;
}

/// Cut points of a family whose ends both keep their signs.
template <int kFamily>
void keep_cut_points(const EdgeSets& cut,
                     const std::array<HaloSet, kNodeKinds>& unmoved,
                     EdgeSets& kept) noexcept {
  constexpr NodeKind kKind = family_kind(kFamily);
  constexpr NodeKind kEnd = end_kind(kKind, family_direction(kFamily));
  constexpr int kOffset = end_offset(kKind, family_direction(kFamily));
  HaloSet& out = kept[kFamily];
  std::fill_n(out.word.begin(), kFirstWord, 0);
  for (std::size_t w = kFirstWord; w < kEndWord; ++w) {
    out.word[w] = cut[kFamily].word[w] & unmoved[kKind].word[w] &
                  word_seen_from(unmoved[kEnd], w, kOffset);
  }
  std::fill(out.word.begin() + kEndWord, out.word.end(), 0);
}

/// Signs after the warp, and the cut points that it leaves.
TET_VECTOR_CLONES
void settle_signs(const CutPoints& cuts, WarpedLattice& lattice) noexcept {
  std::array<HaloSet, kNodeKinds> unmoved;  // nodes that keep their sign, and so their cuts
  for (const NodeKind kind : {kCorner, kCentre}) {
    unmoved[kind] =
        ((cuts.signs.inside[kind] | cuts.signs.outside[kind]) & kNodes) - lattice.warped[kind];
    lattice.zero[kind] = kNodes - unmoved[kind];
    lattice.plus[kind] = cuts.signs.inside[kind] & unmoved[kind];
  }
  [&]<std::size_t... kFamily>(std::index_sequence<kFamily...>) {
    (keep_cut_points<static_cast<int>(kFamily)>(cuts.cut, unmoved, lattice.cut), ...);
  }
  (std::make_index_sequence<kEdgeFamilies>{});
}

}  // namespace

void warp_lattice(const CutPoints& cuts,
                  const WarpLimits& limits,
                  WarpedLattice& lattice) noexcept {
  alignas(64) NearestViolations nearest;
  clear_violations(nearest);
  for (auto& direction : lattice.direction) direction.fill(direction_of(kNoViolation));
  find_nearest(cuts.edges, limits, nearest, lattice.direction[0].data());
  for (const NodeKind kind : {kCorner, kCentre}) {
    lattice.warped[kind] = nodes_with_direction(lattice.direction[kind]);
  }
  settle_signs(cuts, lattice);
}

bool has_both_sides(const WarpedLattice& lattice) noexcept {
  const HaloSet& corner = lattice.plus[kCorner];
  const HaloSet& centre = lattice.plus[kCentre];
  return (corner.any() || centre.any()) && ((kNodes - corner).any() || (kNodes - centre).any());
}

HaloSet used_zeros(const WarpedLattice& lattice, NodeKind kind) noexcept {
  HaloSet beside_plus;
  for (int direction = 0; direction < kDirections; ++direction) {
    beside_plus |=
        seen_from(lattice.plus[end_kind(kind, direction)], end_offset(kind, direction));
  }
  return lattice.zero[kind] & beside_plus;
}

}  // namespace tet
