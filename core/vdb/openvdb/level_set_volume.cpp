#include "core/vdb/openvdb/level_set_volume.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <vector>

#include "core/base/parallel.h"

namespace tet {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

/// The part of a tet where a linear function with these values at the corners is negative.
double negative_part(std::array<double, 4> v) {
  std::sort(v.begin(), v.end());
  const auto [a, b, c, d] = v;
  const auto cut = [](double from, double to) { return from / (from - to); };
  if (a >= 0) return 0;
  if (b >= 0) return cut(a, b) * cut(a, c) * cut(a, d);
  if (c >= 0) {
    // A wedge with one triangle at `a` and one at `b`, as three tets.
    const double ac = cut(a, c), ad = cut(a, d), bc = cut(b, c), bd = cut(b, d);
    return ac * ad + bc * ad * (1 - ac) + bc * bd * (1 - ad);
  }
  if (d >= 0) return 1 - cut(d, a) * cut(d, b) * cut(d, c);
  return 1;
}

/// Cubes around the diagonal from corner 0 to corner 7; bits of a corner are its x, y and z.
constexpr std::array<std::array<std::size_t, 4>, 6> kTets{
    {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};

double negative_part_of_cube(const std::array<float, 8>& corner) {
  const auto negative =
      std::count_if(corner.begin(), corner.end(), [](float value) { return value < 0; });
  if (negative == 0) return 0;
  if (negative == 8) return 1;
  double sum = 0;
  for (const auto& tet : kTets) {
    std::array<double, 4> values;
    for (std::size_t i = 0; i < 4; ++i) values[i] = static_cast<double>(corner[tet[i]]);
    sum += negative_part(values);
  }
  return sum / 6;
}

constexpr std::size_t kEdge = 9;

/// A leaf's values, and those of the next voxels behind it on each axis.
std::array<float, kEdge * kEdge * kEdge> values_with_next(const openvdb::FloatTree& tree,
                                                          const Leaf& leaf) {
  std::array<float, kEdge * kEdge * kEdge> values;
  openvdb::FloatGrid::ConstUnsafeAccessor accessor(tree);
  std::size_t at = 0;
  for (int x = 0; x < 9; ++x) {
    for (int y = 0; y < 9; ++y) {
      for (int z = 0; z < 9; ++z, ++at) {
        const bool within = x < 8 && y < 8 && z < 8;
        values[at] = within ? leaf.buffer().data()[(x * 8 + y) * 8 + z]
                            : accessor.getValue(leaf.origin().offsetBy(x, y, z));
      }
    }
  }
  return values;
}

double volume_of_leaf(const openvdb::FloatTree& tree, const Leaf& leaf) {
  const auto values = values_with_next(tree, leaf);
  double volume = 0;
  for (std::size_t voxel = 0; voxel < Leaf::SIZE; ++voxel) {
    const std::size_t low = (voxel / 64 * kEdge + voxel / 8 % 8) * kEdge + voxel % 8;
    std::array<float, 8> corner;
    for (std::size_t i = 0; i < 8; ++i) {
      corner[i] = values[low + (i & 1U) * kEdge * kEdge + (i >> 1 & 1U) * kEdge + (i >> 2)];
    }
    volume += negative_part_of_cube(corner);
  }
  return volume;
}

}  // namespace

double level_set_volume(const openvdb::FloatGrid& grid) {
  const openvdb::FloatTree& tree = grid.tree();
  std::vector<const Leaf*> leaves;
  tree.getNodes(leaves);
  std::vector<double> of_leaf(leaves.size());
  for_each_index(leaves.size(),
                 [&](std::size_t i) { of_leaf[i] = volume_of_leaf(tree, *leaves[i]); });
  double volume = std::accumulate(of_leaf.begin(), of_leaf.end(), 0.0);
  // No tile is next to the surface.
  auto tile = tree.cbeginValueAll();
  tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    if (*tile < 0) volume += static_cast<double>(tile.getVoxelCount());
  }
  return volume;
}

}  // namespace tet
