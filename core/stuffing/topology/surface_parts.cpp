#include "core/stuffing/topology/surface_parts.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/vector_clones.h"
#include "core/lattice/background.h"
#include "core/stuffing/topology/node_regions.h"

namespace tet {
namespace {

/// The vertices of a part: its zero nodes, and the nodes that own its cut points.
struct PartVertices {
  std::array<HaloSet, kVertexSlots> slot;
  BricksAround bricks = 0;  ///< of both ends of the edges that are crossed
};

/// Words of a set that hold the nodes of the box.
constexpr std::size_t kFirstPlaneWord = halo_index(NodePlanes::kMin, -2, -2) / 64;
constexpr std::size_t kEndPlaneWord = halo_index(NodePlanes::kMax + 1, -2, -2) / 64;

/// Cut points on the edges from `plus` nodes to `minus` nodes, at the nodes that own them.
TET_VECTOR_CLONES
void find_cuts_between(const NodeSets& plus,
                       const NodeSets& minus,
                       std::array<HaloSet, kVertexSlots>& slot) noexcept {
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const NodeKind kind = family_kind(family);
    const NodeKind end = end_kind(kind, family_direction(family));
    const int offset = end_offset(kind, family_direction(family));
    auto& cuts = slot[static_cast<std::size_t>(kNodeKinds + family)].word;
    for (std::size_t w = kFirstPlaneWord; w < kEndPlaneWord; ++w) {
      cuts[w] = (plus[kind].word[w] & word_seen_from(minus[end], w, offset)) |
                (minus[kind].word[w] & word_seen_from(plus[end], w, offset));
    }
  }
}

/// Says which brick an index within [-1, 8] lies in: 0, 1 or 2 along an axis.
constexpr unsigned brick_along(int i) noexcept { return i < 0 ? 0 : (i < 8 ? 1 : 2); }

/// The bricks that have one of these nodes.
BricksAround bricks_of(const NodePlanes& nodes) noexcept {
  BricksAround bricks = 0;
  for (int x = NodePlanes::kMin; x <= NodePlanes::kMax; ++x) {
    const NodePlane& corners = nodes.of(kCorner, x);
    const NodePlane& centres = nodes.of(kCentre, x);
    for (int y = NodePlanes::kMin; y <= NodePlanes::kMax; ++y) {
      const unsigned at = static_cast<unsigned>(y + 2);
      const std::uint64_t row =
          (corners.word[at / 4] | centres.word[at / 4]) >> (at % 4 * 16) & 0xffff;
      if (row == 0) continue;
      const unsigned along_z = static_cast<unsigned>((row >> 1 & 1) != 0) |
                               static_cast<unsigned>((row >> 2 & 0xff) != 0) << 1 |
                               static_cast<unsigned>((row >> 10 & 1) != 0) << 2;
      bricks |= along_z << (9 * brick_along(x) + 3 * brick_along(y));
    }
  }
  return bricks;
}

PartVertices vertices_between(const NodeRegion& inside,
                              const NodeRegion& other,
                              const SurfaceRegions& signs) noexcept {
  PartVertices part;
  // Only nodes at the surface matter, of either region.
  const NodePlanes plus = inside.nodes & signs.plus & other.beside;
  const NodePlanes rest = other.nodes & nodes_beside(plus);
  find_cuts_between(plus.sets(), (rest & signs.minus).sets(), part.slot);
  const NodeSets zeros = (rest & signs.zero).sets();
  std::copy(zeros.begin(), zeros.end(), part.slot.begin());
  part.bricks = bricks_of(plus | rest);
  return part;
}

/// How many vertices of a part are of some nodes.
TET_VECTOR_CLONES
std::size_t count_within(const PartVertices& part, const HaloSet& nodes) noexcept {
  std::size_t count = 0;
  for (const HaloSet& vertices : part.slot) {
    for (std::size_t w = kFirstPlaneWord; w < kEndPlaneWord; ++w) {
      count += static_cast<std::size_t>(std::popcount(vertices.word[w] & nodes.word[w]));
    }
  }
  return count;
}

TET_VECTOR_CLONES
bool any_within(const PartVertices& part, const HaloSet& nodes) noexcept {
  std::uint64_t any = 0;
  for (const HaloSet& vertices : part.slot) {
    for (std::size_t w = kFirstPlaneWord; w < kEndPlaneWord; ++w) {
      any |= vertices.word[w] & nodes.word[w];
    }
  }
  return any != 0;
}

/// Calls `visit(slot, index)` for the vertices of a part that are of some nodes.
template <class Visit>
void for_each_within(const PartVertices& part, const HaloSet& nodes, const Visit& visit) {
  for (std::size_t slot = 0; slot < kVertexSlots; ++slot) {
    for (std::size_t w = kFirstPlaneWord; w < kEndPlaneWord; ++w) {
      for (std::uint64_t bits = part.slot[slot].word[w] & nodes.word[w]; bits != 0;
           bits &= bits - 1) {
        visit(slot, static_cast<int>(w * 64) + std::countr_zero(bits));
      }
    }
  }
}

constexpr HaloSet kOtherNodes = halo_cube(NodePlanes::kMin, NodePlanes::kMax) - kOwnNodes;
/// The nodes that belong to later bricks.
constexpr HaloSet kLaterNodes = [] {
  HaloSet later;
  for (int index = 0; index < kHaloNodes; ++index) {
    const Cell at(index);
    const int beyond = brick_along(at.x) != 1 ? at.x : (brick_along(at.y) != 1 ? at.y : at.z);
    if (kOtherNodes.test(index) && beyond > 0) later.set(index);
  }
  return later;
}();

/// Lists what a part has in later bricks; in earlier ones too, where only they have something
/// of it to hold on to.
void add_links(const PartVertices& vertices, SurfaceParts& parts) {
  const HaloSet& linked = any_within(vertices, kOwnNodes) ? kLaterNodes : kOtherNodes;
  parts.links.reserve(parts.links.size() + count_within(vertices, linked));
  for_each_within(vertices, linked, [&](std::size_t slot, int index) {
    const VertexOwner owner(index);
    parts.links.push_back({owner.brick, owner.element(slot), parts.count});
  });
}

/// Lists what a part has here.
void add_own_vertices(const PartVertices& vertices, SurfaceParts& parts) {
  auto& part_of = parts.part_of;
  const auto before = static_cast<std::ptrdiff_t>(part_of.size());
  for (std::size_t slot = 0; slot < kVertexSlots; ++slot) {
    for_each_bit(brick_part(vertices.slot[slot]), [&](int x, int y, int z) {
      const auto element = slot * kBrickCells + static_cast<std::size_t>((x * 8 + y) * 8 + z);
      part_of.push_back({static_cast<std::uint16_t>(element), parts.count});
    });
  }
  std::inplace_merge(part_of.begin(), part_of.begin() + before, part_of.end());
}

/// Regions of either side that have a part of the surface between them.
struct RegionPair {
  const NodeRegion* inside;
  const NodeRegion* other;
};

std::vector<RegionPair> pairs_that_meet(const SurfaceRegions& regions) {
  std::vector<RegionPair> pairs;
  for (const NodeRegion& i : regions.inside) {
    for (const NodeRegion& o : regions.others) {
      if (meet(i.beside, o.nodes)) pairs.push_back({&i, &o});
    }
  }
  return pairs;
}

}  // namespace

VertexOwner::VertexOwner(int index) noexcept {
  const Cell at(index);
  const auto brick_of = [](int i) { return static_cast<std::int8_t>(i < 0 ? -1 : i >> 3); };
  brick = {brick_of(at.x), brick_of(at.y), brick_of(at.z)};
  place = static_cast<std::uint16_t>(((at.x & 7) * 8 + (at.y & 7)) * 8 + (at.z & 7));
}

std::uint16_t VertexOwner::element(std::size_t slot) const noexcept {
  return static_cast<std::uint16_t>(slot * kBrickCells + place);
}

std::optional<std::uint16_t> SurfaceParts::part(std::uint16_t element,
                                                std::size_t& near) const noexcept {
  if (count == 0) return std::nullopt;
  if (count == 1) return 0;
  const auto is_before = [&](std::size_t i) { return part_of[i][0] < element; };
  // What is wanted lies from `begin` on: where the last search ended, or else anywhere.
  std::size_t begin = near <= part_of.size() && (near == 0 || is_before(near - 1)) ? near : 0;
  std::size_t step = 1;
  for (; begin + step <= part_of.size() && is_before(begin + step - 1); step *= 2)
    begin += step;
  const auto first = part_of.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto last =
      part_of.begin() + static_cast<std::ptrdiff_t>(std::min(begin + step, part_of.size()));
  const auto at = std::lower_bound(first, last, std::array<std::uint16_t, 2>{element, 0});
  near = static_cast<std::size_t>(at - part_of.begin());
  if (at == part_of.end() || (*at)[0] != element) return std::nullopt;
  return (*at)[1];
}

std::optional<SurfaceParts> parts_between_regions(const SurfaceRegions& regions) {
  if (regions.too_many) return std::nullopt;
  SurfaceParts parts;
  const std::vector<RegionPair> pairs = pairs_that_meet(regions);
  for (const auto& [inside, other] : pairs) {
    const PartVertices vertices = vertices_between(*inside, *other, regions);
    if ((vertices.bricks & kOwnBrick) == 0) continue;
    parts.beside.push_back(vertices.bricks & ~kOwnBrick);
    add_links(vertices, parts);
    if (pairs.size() > 1) add_own_vertices(vertices, parts);
    ++parts.count;
  }
  if (parts.count < 2) parts.part_of.clear();
  parts.part_of.shrink_to_fit();  // it is kept
  parts.links.shrink_to_fit();
  return parts;
}

}  // namespace tet
