#include "core/stuffing/warp.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>

#include "core/base/sse.h"
#include "core/base/vector_clones.h"

namespace tet {
namespace {

/// Words of a set that hold the known nodes.
constexpr std::size_t kFirstWord = halo_index(kNodeMin, -2, -2) / 64;
constexpr std::size_t kEndWord = halo_index(kNodeMax + 1, -2, -2) / 64;

/// A violating cut point as a number that sorts like (distance, direction): the bits of a float
/// that is not negative sort like the float. The bits above say in which brick.
using Violation = std::uint64_t;
constexpr int kViolationBits = 40;
constexpr std::uint8_t kNoDirection = 0xff;
constexpr float kNever = std::numeric_limits<float>::infinity();
constexpr Violation violation(float distance, std::uint32_t direction) noexcept {
  return Violation{std::bit_cast<std::uint32_t>(distance)} << 8 | direction;
}
static_assert(violation(kNever, kNoDirection) >> kViolationBits == 0);

/// The directions of all nodes, one kind after the other.
using Directions = decltype(WarpedLattice::direction);
/// Where a node is in such columns, one kind after the other.
constexpr int node_slot(NodeKind kind, int index) noexcept { return kind * kHaloNodes + index; }

/// Which of its ends each edge of a batch violates, if any.
struct Violations {
  template <class Value>
  using Lanes = std::array<Value, kEdgeLanes>;
  alignas(64) Lanes<std::int32_t> node;
  alignas(64) Lanes<float> distance;
  alignas(64) Lanes<std::uint32_t> direction;
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
                            Violations& out) noexcept {
  const auto to_upper = static_cast<std::uint32_t>(family.direction);
  const auto to_lower = static_cast<std::uint32_t>(opposite(family.direction));
  for (std::size_t i = 0; i < kEdgeLanes; ++i) {
    const float t = fraction[i], rest = 1 - t;
    const bool from_low = t < rest;  // only the nearer end: no limit is above a half
    const float share = from_low ? t : rest;
    const std::uint32_t direction = from_low ? to_upper : to_lower;
    out.node[i] = low[i] + (from_low ? family.to_low : family.to_high);
    out.distance[i] = share < family.alpha ? share * family.length : kNever;
    out.direction[i] = share < family.alpha ? direction : std::uint32_t{kNoDirection};
  }
}

/// Finds each node's nearest violating cut point.
TET_VECTOR_CLONES
void find_nearest(const CutEdges& edges,
                  const WarpLimits& limits,
                  NearestCuts& nearest_cuts,
                  Directions& directions) noexcept {
  const Violation brick = nearest_cuts.begin_brick();
  Violation* const nearest = nearest_cuts.data();
  std::uint8_t* const direction = directions.front().data();
  for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
    const FamilyLimits family(static_cast<int>(f), limits);
    const auto [begin, count] = edges.run[f];
    for (std::size_t first = 0; first < count; first += kEdgeLanes) {
      Violations violations;
      find_violations(family, &edges.low[begin + first], &edges.fraction[begin + first],
                      violations);
      const std::size_t lanes = std::min(kEdgeLanes, count - first);
      for (std::size_t i = 0; i < lanes; ++i) {
        const auto node = static_cast<std::size_t>(violations.node[i]);
        const Violation found =
            brick | violation(violations.distance[i], violations.direction[i]);
        nearest[node] = std::min(nearest[node], found);
        direction[node] = static_cast<std::uint8_t>(nearest[node]);
      }
    }
  }
}

/// The nodes of one kind that have a direction.
void find_warped(const std::uint8_t* direction, HaloSet& warped) noexcept {
  for (std::size_t w = kFirstWord; w < kEndWord; ++w) {
    std::uint64_t none = 0;
    for (std::size_t row = 0; row < 4; ++row) {
      const __m128i bytes =
          _mm_load_si128(reinterpret_cast<const __m128i*>(direction + (w * 4 + row) * 16));
      const auto bits = static_cast<unsigned>(_mm_movemask_epi8(bytes));
      none |= std::uint64_t{bits} << (row * 16);
    }
    warped.word[w] = kKnownNodes.word[w] & ~none;
  }
}

/// Signs after the warp, and the cut points that it leaves: those whose ends both keep their
/// sign.
TET_VECTOR_CLONES
void settle_signs(const CutPoints& cuts, WarpedLattice& lattice) noexcept {
  std::array<HaloSet, kNodeKinds> unmoved;
  for (const NodeKind kind : {kCorner, kCentre}) {
    const auto& inside = cuts.signs.inside[kind].word;
    const auto& outside = cuts.signs.outside[kind].word;
    for (std::size_t w = kFirstWord; w < kEndWord; ++w) {
      const std::uint64_t still =
          (inside[w] | outside[w]) & kKnownNodes.word[w] & ~lattice.warped[kind].word[w];
      unmoved[kind].word[w] = still;
      lattice.zero[kind].word[w] = kKnownNodes.word[w] & ~still;
      lattice.plus[kind].word[w] = inside[w] & still;
    }
  }
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const auto f = static_cast<std::size_t>(family);
    const HaloSet& low = unmoved[family_kind(family)];
    const HaloSet& end = unmoved[end_kind(family_kind(family), family_direction(family))];
    const int offset = end_offset(family_kind(family), family_direction(family));
    for (std::size_t w = kFirstWord; w < kEndWord; ++w) {
      lattice.cut[f].word[w] =
          cuts.cut[f].word[w] & low.word[w] & word_seen_from(end, w, offset);
    }
  }
}

}  // namespace

std::uint64_t NearestCuts::begin_brick() noexcept {
  if (bricks_left_ == 0) {
    for (auto& numbers : number_) numbers.fill(~std::uint64_t{0});
    bricks_left_ = (std::uint32_t{1} << (64 - kViolationBits)) - 1;
  }
  return std::uint64_t{--bricks_left_} << kViolationBits;
}

void warp_lattice(const CutPoints& cuts,
                  const WarpLimits& limits,
                  WarpedLattice& lattice) noexcept {
  for (auto& direction : lattice.direction) {
    std::fill(direction.begin() + kFirstWord * 64, direction.begin() + kEndWord * 64,
              kNoDirection);
  }
  find_nearest(cuts.edges, limits, lattice.nearest, lattice.direction);
  for (const NodeKind kind : {kCorner, kCentre}) {
    find_warped(lattice.direction[kind].data(), lattice.warped[kind]);
  }
  settle_signs(cuts, lattice);
}

bool has_both_sides(const WarpedLattice& lattice) noexcept {
  const HaloSet& corner = lattice.plus[kCorner];
  const HaloSet& centre = lattice.plus[kCentre];
  return (corner.any() || centre.any()) &&
         ((kKnownNodes - corner).any() || (kKnownNodes - centre).any());
}

}  // namespace tet
