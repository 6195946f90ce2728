#include "core/lattice/node_numbers.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "core/base/check.h"
#include "core/base/parallel.h"

namespace tet {
namespace {

constexpr std::size_t kBricksPerRange = 16;

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
    for_each_bit(nodes.used[at], [&](int x, int y, int z) {
      if (((x | y | z) & 1) == 0) mask.set(ox * 4 + x / 2, oy * 4 + y / 2, oz * 4 + z / 2);
    });
  }
  return mask;
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

BrickMask leaf_corners(const HaloSet& leaf) noexcept {
  HaloSet corners;
  for (int o = 0; o < 8; ++o) {
    corners |= seen_from(leaf, -offset_index(o >> 2, o >> 1 & 1, o & 1));
  }
  return brick_part(corners);
}

void insert_corner_bricks(OctreeLevel& level) {
  std::vector<BrickCoord> owners;
  for (std::size_t i = 0; i < level.bricks.size(); ++i) {
    HaloSet cells;
    add_brick(cells, level.leaf[i], 0, 0, 0);
    const BrickCoord b = level.bricks[i];
    for (int o = 1; o < 8; ++o) {
      const int ox = o >> 2, oy = o >> 1 & 1, oz = o & 1;
      // Seen from that brick, the leaves lie at -8..-1 along the axes it is away on.
      const BrickCoord owner{b.x + ox, b.y + oy, b.z + oz};
      if (leaf_corners(seen_from(cells, offset_index(8 * ox, 8 * oy, 8 * oz))).any()) {
        owners.push_back(owner);
      }
    }
  }
  std::sort(owners.begin(), owners.end());
  owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
  level.insert_bricks(owners);
}

LevelNodes background_nodes(const OctreeLevel& level,
                            const OctreeLevel& finer_level,
                            const LevelNodes& finer) {
  LevelNodes nodes;
  nodes.used.resize(level.bricks.size());
  nodes.corner.resize(level.bricks.size());
  nodes.centre = level.leaf;
  for_each_range(level.bricks.size(), kBricksPerRange, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const BrickCoord brick = level.bricks[i];
      nodes.used[i] = leaf_corners(gather_halo(level, level.leaf, brick));
      if (!nodes.used[i].any()) continue;
      nodes.corner[i] = nodes.used[i] & ~corners_used_below(finer_level, finer, brick);
    }
  });
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
  return at != kNoBrick && (*nodes_)[l].used[at].test(x, y, z);
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
  TET_CHECK(at != kNoBrick && (*nodes_)[l].corner[at].test(x, y, z));
  return (*nodes_)[l].first_vertex[at] + rank_of((*nodes_)[l].corner[at], x, y, z);
}

std::uint64_t NodeNumbers::finer_corner(
    int level, BrickCoord brick, int x, int y, int z) noexcept {
  int fx = x, fy = y, fz = z;
  const BrickCoord finer = settle({2 * brick.x, 2 * brick.y, 2 * brick.z}, fx, fy, fz);
  if (used(level - 1, finer, fx, fy, fz)) return corner(level - 1, finer, fx, fy, fz);
  TET_CHECK(((x | y | z) & 1) == 0);
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
