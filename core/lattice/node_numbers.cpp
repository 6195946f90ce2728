#include "core/lattice/node_numbers.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "core/base/parallel.h"

namespace tet {
namespace {

constexpr std::size_t kBricksPerRange = 16;

/// The cells (or corners) of a slice at even places, 4 x 4 of them, as the first of a slice.
std::uint64_t even_places(std::uint64_t slice) noexcept {
  std::uint64_t bits = slice & 0x0055005500550055;
  bits = (bits | bits >> 1) & 0x0033003300330033;
  bits = (bits | bits >> 2) & 0x000f000f000f000f;
  bits = (bits | bits >> 8) & 0x00000f0f00000f0f;
  return (bits | bits >> 16) & 0x0f0f0f0f;
}

/// Corners (x, y, z) of the level below at even places are this level's; those of `brick`.
BrickMask corners_used_below(const OctreeLevel& below,
                             const LevelNodes& nodes,
                             BrickCoord brick) {
  BrickMask mask;
  for (int o = 0; o < 8; ++o) {
    const int ox = o >> 2, oy = o >> 1 & 1, oz = o & 1;
    const std::uint32_t at =
        below.index.find({2 * brick.x + ox, 2 * brick.y + oy, 2 * brick.z + oz});
    if (at == kNoBrick) continue;
    for (std::size_t x = 0; x < 4; ++x) {
      mask.slice[static_cast<std::size_t>(4 * ox) + x] |=
          even_places(nodes.used_corners(at).slice[2 * x]) << (32 * oy + 4 * oz);
    }
  }
  return mask;
}

/// The highest cells along every axis that `o` (4*x + 2*y + z) is away on: their leaves have
/// corners in that brick.
BrickMask cells_towards(unsigned o) noexcept {
  constexpr std::uint64_t kLastOfRows = 0x8080808080808080, kLastRow = 0xff00000000000000;
  const std::uint64_t slice = ((o & 1) != 0 ? kLastOfRows : ~std::uint64_t{0}) &
                              ((o & 2) != 0 ? kLastRow : ~std::uint64_t{0});
  BrickMask cells;
  for (std::size_t x = (o & 4) != 0 ? 7 : 0; x < 8; ++x) cells.slice[x] = slice;
  return cells;
}

/// Splits a coordinate that may have left its brick, at 0 .. 16, into brick and rest.
BrickCoord settle(BrickCoord brick, int& x, int& y, int& z) noexcept {
  const BrickCoord settled{brick.x + (x >> 3), brick.y + (y >> 3), brick.z + (z >> 3)};
  x &= 7;
  y &= 7;
  z &= 7;
  return settled;
}

}  // namespace

LowerLeaves lower_leaves(const MaskColumn& leaf, const PlacesAround& around) noexcept {
  static constexpr BrickMask kNone;
  LowerLeaves leaves;
  for (std::size_t o = 0; o < leaves.size(); ++o) {
    const std::uint32_t at = around[kItself - 9 * (o >> 2) - 3 * (o >> 1 & 1) - (o & 1)];
    leaves[o] = at != kNoBrick ? &leaf[at] : &kNone;
  }
  return leaves;
}

BrickMask leaf_corners(const LowerLeaves& leaves) noexcept {
  // A corner is that of the cell at its place, and of those one step down along each axis.
  const auto both = [](int axis, const BrickMask& mask, const BrickMask& below) {
    return mask | previous_along(axis, mask, below);
  };
  std::array<BrickMask, 8> corners;
  for (std::size_t o = 0; o < 8; o += 2) corners[o] = both(2, *leaves[o], *leaves[o + 1]);
  for (std::size_t o = 0; o < 8; o += 4) corners[o] = both(1, corners[o], corners[o + 2]);
  return both(0, corners[0], corners[4]);
}

bool has_corner_in(const BrickMask& leaf, unsigned o) noexcept {
  return (leaf & cells_towards(o)).any();
}

void insert_corner_bricks(OctreeLevel& level) {
  std::vector<BrickCoord> owners;
  BrickNeighbours neighbours(level.bricks, RowsAround::kUpper);
  for (std::size_t i = 0; i < level.bricks.size(); ++i) {
    if (!level.leaf[i].any()) continue;
    const BrickCoord b = level.bricks[i];
    const PlacesAround& around = neighbours.around(b);
    for (unsigned o = 1; o < 8; ++o) {
      const unsigned x = o >> 2, y = o >> 1 & 1, z = o & 1;
      if (around[kItself + 9 * x + 3 * y + z] != kNoBrick) continue;
      if (!has_corner_in(level.leaf[i], o)) continue;
      owners.push_back({b.x + static_cast<std::int32_t>(x), b.y + static_cast<std::int32_t>(y),
                        b.z + static_cast<std::int32_t>(z)});
    }
  }
  std::sort(owners.begin(), owners.end());
  owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
  if (!owners.empty()) level.insert_bricks(owners);
}

std::vector<std::size_t> unknown_bricks(const KnownNodes& known,
                                        std::size_t begin,
                                        std::size_t end) {
  std::vector<std::size_t> bricks;
  for (std::size_t i = begin; i < end; ++i) {
    if (known.nodes == nullptr || known.places[i] == kNoBrick) bricks.push_back(i);
  }
  return bricks;
}

LevelNodes background_nodes(const OctreeLevel& level,
                            const OctreeLevel& finer_level,
                            const LevelNodes& finer,
                            const KnownNodes& known) {
  const std::vector<std::size_t> wanted = unknown_bricks(known, 0, level.bricks.size());
  std::vector<BrickMask> used(wanted.size()), corner(wanted.size());
  for_each_range(wanted.size(), kBricksPerRange, [&](std::size_t begin, std::size_t end) {
    BrickNeighbours neighbours(level.bricks, RowsAround::kLower);
    for (std::size_t i = begin; i < end; ++i) {
      const BrickCoord brick = level.bricks[wanted[i]];
      used[i] = leaf_corners(lower_leaves(level.leaf, neighbours.around(brick)));
      if (!used[i].any()) continue;
      corner[i] = used[i] & ~corners_used_below(finer_level, finer, brick);
    }
  });
  if (known.nodes == nullptr) return {MaskColumn(used), MaskColumn(corner), level.leaf, {}};
  LevelNodes nodes{{}, {}, level.leaf, {}};
  nodes.used.append(known.nodes->used, known.places, used);
  nodes.corner.append(known.nodes->corner, known.places, corner);
  return nodes;
}

std::uint32_t NearbyBricks::find(BrickCoord brick) noexcept {
  Found& found =
      found_[static_cast<std::size_t>((brick.x & 3) * 16 + (brick.y & 3) * 4 + (brick.z & 3))];
  if (!found.known || found.brick != brick) found = {brick, true, index_->find(brick)};
  return found.at;
}

NodeNumbers::NodeNumbers(const Octree& tree, const std::vector<LevelNodes>& nodes)
    : nodes_(&nodes) {
  bricks_.reserve(tree.levels.size());
  for (const OctreeLevel& level : tree.levels) bricks_.emplace_back(level.index);
}

bool NodeNumbers::used(int level, BrickCoord brick, int x, int y, int z) noexcept {
  const auto l = static_cast<std::size_t>(level);
  const std::uint32_t at = bricks_[l].find(brick);
  return at != kNoBrick && (*nodes_)[l].used_corners(at).test(x, y, z);
}

std::uint64_t NodeNumbers::corner(int level, BrickCoord brick, int x, int y, int z) noexcept {
  brick = settle(brick, x, y, z);
  // Around a corner leaves differ by at most two levels, and by one from each to the next.
  for (; level > 0; --level) {
    int fx = 2 * x, fy = 2 * y, fz = 2 * z;
    const BrickCoord finer = settle({2 * brick.x, 2 * brick.y, 2 * brick.z}, fx, fy, fz);
    if (!used(level - 1, finer, fx, fy, fz)) break;
    brick = finer;
    x = fx;
    y = fy;
    z = fz;
  }
  const auto l = static_cast<std::size_t>(level);
  const std::uint32_t at = bricks_[l].find(brick);
  if (at == kNoBrick || !(*nodes_)[l].corner[at].test(x, y, z)) return kNoVertex;
  return (*nodes_)[l].first_vertex[at] + rank_of((*nodes_)[l].corner[at], x, y, z);
}

std::uint64_t NodeNumbers::finer_corner(
    int level, BrickCoord brick, int x, int y, int z) noexcept {
  if (level == 0) return corner(level, brick, x / 2, y / 2, z / 2);  // nothing is finer
  int fx = x, fy = y, fz = z;
  const BrickCoord finer = settle({2 * brick.x, 2 * brick.y, 2 * brick.z}, fx, fy, fz);
  if (used(level - 1, finer, fx, fy, fz)) return corner(level - 1, finer, fx, fy, fz);
  if (((x | y | z) & 1) != 0) return kNoVertex;
  return corner(level, brick, x / 2, y / 2, z / 2);
}

NodeNumbers::Centres NodeNumbers::centres(int level, BrickCoord brick) noexcept {
  static constexpr BrickMask kNone;
  const auto l = static_cast<std::size_t>(level);
  const std::uint32_t at = bricks_[l].find(brick);
  if (at == kNoBrick) return {&kNone, 0};
  const LevelNodes& nodes = (*nodes_)[l];
  return {&nodes.centre[at], nodes.first_vertex[at] + nodes.corner[at].count()};
}

std::uint32_t rank_of(const BrickMask& mask, int x, int y, int z) noexcept {
  std::uint32_t rank = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(x); ++i) {
    rank += static_cast<std::uint32_t>(std::popcount(mask.slice[i]));
  }
  const std::uint64_t before = (std::uint64_t{1} << (y * 8 + z)) - 1;
  return rank + static_cast<std::uint32_t>(
                    std::popcount(mask.slice[static_cast<std::size_t>(x)] & before));
}

}  // namespace tet
