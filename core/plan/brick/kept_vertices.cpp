#include "core/plan/brick/kept_vertices.h"

#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/stuffing/brick_geometry.h"

namespace tet {
namespace {

BrickMask differing(const BrickMask& a, const BrickMask& b) noexcept {
  return (a | b) & ~(a & b);
}

/// Calls `visit(x, bit, rank_a, rank_b)` for each bit that both have, with how many bits of
/// either come before it.
template <class Visit>
void for_each_of_both(const BrickMask& a, const BrickMask& b, const Visit& visit) {
  std::size_t before_a = 0, before_b = 0;
  for (std::size_t x = 0; x < a.slice.size(); ++x) {
    const std::uint64_t in_a = a.slice[x], in_b = b.slice[x];
    for (std::uint64_t bits = in_a & in_b; bits != 0; bits &= bits - 1) {
      const std::uint64_t bit = bits & (~bits + 1);
      visit(x, bit, before_a + static_cast<std::size_t>(std::popcount(in_a & (bit - 1))),
            before_b + static_cast<std::size_t>(std::popcount(in_b & (bit - 1))));
    }
    before_a += static_cast<std::size_t>(std::popcount(in_a));
    before_b += static_cast<std::size_t>(std::popcount(in_b));
  }
}

bool same_fraction(const PackedGeometry& a,
                   std::size_t at_a,
                   const PackedGeometry& b,
                   std::size_t at_b) noexcept {
  return std::bit_cast<std::uint32_t>(a.fraction(at_a)) ==
         std::bit_cast<std::uint32_t>(b.fraction(at_b));
}

bool lies_alike(const PackedGeometry& a,
                std::size_t at_a,
                const PackedGeometry& b,
                std::size_t at_b) noexcept {
  if (a.direction(at_a) != b.direction(at_b)) return false;
  return a.direction(at_a) == kUnmoved || same_fraction(a, at_a, b, at_b);
}

/// Takes moved nodes that lie elsewhere, and finds cut points that lie where they lay.
void compare_geometry(const OwnedVertices& before,
                      const OwnedVertices& now,
                      VertexMasks& kept) noexcept {
  const StuffedBrick &a = *before.stuffed, &b = *now.stuffed;
  const PackedGeometry places_a(before.geometry, a), places_b(now.geometry, b);
  std::size_t first_a = 0, first_b = 0;
  for (const NodeKind kind : {kCorner, kCentre}) {
    BrickMask& nodes = kept.node[kind];
    for_each_of_both(
        a.zero[kind], b.zero[kind],
        [&](std::size_t x, std::uint64_t bit, std::size_t rank_a, std::size_t rank_b) {
          if (lies_alike(places_a, first_a + rank_a, places_b, first_b + rank_b)) return;
          nodes.slice[x] &= ~bit;
        });
    first_a += a.zero[kind].count();
    first_b += b.zero[kind].count();
  }
  for (std::size_t family = 0; family < kEdgeFamilies; ++family) {
    BrickMask& cuts = kept.cut[family];
    for_each_of_both(
        a.cut[family], b.cut[family],
        [&](std::size_t x, std::uint64_t bit, std::size_t rank_a, std::size_t rank_b) {
          if (same_fraction(places_a, first_a + rank_a, places_b, first_b + rank_b)) {
            cuts.slice[x] |= bit;
          }
        });
    first_a += a.cut[family].count();
    first_b += b.cut[family].count();
  }
}

/// Nodes that are on another side than they were; moved ones are on neither.
BrickMask elsewhere(const OwnedVertices& before, const OwnedVertices& now, NodeKind kind) {
  static const StuffedBrick none{};
  const StuffedBrick& a = before.stuffed != nullptr ? *before.stuffed : none;
  const StuffedBrick& b = now.stuffed != nullptr ? *now.stuffed : none;
  return differing(a.plus[kind], b.plus[kind]) | differing(a.zero[kind], b.zero[kind]);
}

}  // namespace

VertexMasks kept_vertices(const OwnedVertices& before, const OwnedVertices& now) noexcept {
  VertexMasks kept;
  for (const NodeKind kind : {kCorner, kCentre}) {
    kept.node[kind] = *before.node[kind] & *now.node[kind] & ~elsewhere(before, now, kind);
  }
  // Only bricks at the surface have moved nodes and cut points.
  if (before.at_surface && now.at_surface) compare_geometry(before, now, kept);
  return kept;
}

VertexMasks changed_vertices(const OwnedVertices& before,
                             const OwnedVertices& now,
                             const VertexMasks& kept) noexcept {
  VertexMasks changed;
  for (const OwnedVertices* owned : {&before, &now}) {
    if (owned->node[kCorner] == nullptr) continue;
    for (const NodeKind kind : {kCorner, kCentre}) changed.node[kind] |= *owned->node[kind];
    if (!owned->at_surface) continue;
    for (std::size_t family = 0; family < kEdgeFamilies; ++family) {
      changed.cut[family] |= owned->stuffed->cut[family];
    }
  }
  for (const NodeKind kind : {kCorner, kCentre}) changed.node[kind] &= ~kept.node[kind];
  for (std::size_t family = 0; family < kEdgeFamilies; ++family) {
    changed.cut[family] &= ~kept.cut[family];
  }
  return changed;
}

}  // namespace tet
