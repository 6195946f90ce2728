#include "core/volume/replace_leaves.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <tuple>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/brick_sets.h"
#include "core/volume/volume_builder.h"

namespace tet {
namespace {

constexpr std::int32_t kRegionBricks = Region::kEdgeBricks;
/// A megabyte of values.
constexpr std::size_t kBricksBetweenLooks = 512;
constexpr std::size_t kRegionsBetweenLooks = 64;

absl::Status check_leaves(const std::vector<LeafValues>& leaves) {
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const BrickCoord b = leaves[i].brick;
    const std::size_t values = leaves[i].values.size();
    if (values != 1 && values != kBrickCells) {
      return absl::InvalidArgumentError(
          absl::StrFormat("the leaf at brick (%d, %d, %d) has %d values; a leaf has %d, or 1",
                          b.x, b.y, b.z, values, kBrickCells));
    }
    if (i > 0 && leaves[i - 1].brick == b) {
      return absl::InvalidArgumentError(
          absl::StrFormat("the leaf at brick (%d, %d, %d) is given twice", b.x, b.y, b.z));
    }
  }
  return absl::OkStatus();
}

/// Returns the first brick of a cube of bricks whose lowest voxel is `min`.
BrickCoord first_brick(VoxelCoord min) noexcept {
  return {min.x / kBrickEdge, min.y / kBrickEdge, min.z / kBrickEdge};
}

/// The first bricks of the aligned cubes of `edge` voxels that leaves lie in; sorted.
std::vector<BrickCoord> cubes_around(const std::vector<LeafValues>& leaves, std::int32_t edge) {
  const std::int32_t mask = ~(edge / kBrickEdge - 1);
  std::vector<BrickCoord> cubes;
  cubes.reserve(leaves.size());
  for (const LeafValues& leaf : leaves) {
    cubes.push_back({leaf.brick.x & mask, leaf.brick.y & mask, leaf.brick.z & mask});
  }
  sort_unique(cubes);
  return cubes;
}

/// A volume's parts, less what leaves (sorted) replace. If cancelled, they are not whole.
class Remainder {
 public:
  Remainder(const Volume& volume,
            const std::vector<LeafValues>& leaves,
            const Cancellation& cancellation)
      : volume_(volume),
        leaves_(leaves),
        cancellation_(cancellation),
        small_cubes_(cubes_around(leaves, kRegionVoxels)),
        large_cubes_(cubes_around(leaves, kLargestCube)) {}

  /// The leaves and the bricks that stay, in their order.
  void merge_bricks(Volume& merged) const {
    const auto is_whole = [](const LeafValues& leaf) { return leaf.values.size() > 1; };
    const std::size_t most = volume_.bricks.size() +
                             static_cast<std::size_t>(std::ranges::count_if(leaves_, is_whole));
    merged.bricks.reserve(most);
    merged.values.reserve(most * kBrickCells);
    auto leaf = leaves_.begin();
    const auto add_leaves_before = [&](const BrickCoord* end) {
      for (; leaf != leaves_.end() && (end == nullptr || leaf->brick < *end); ++leaf) {
        if (leaf->values.size() > 1) append(merged, leaf->brick, leaf->values);
      }
    };
    for (std::size_t i = 0; i < volume_.bricks.size(); ++i) {
      if (i % kBricksBetweenLooks == 0 && cancellation_.requested()) return;
      add_leaves_before(&volume_.bricks[i]);
      if (leaf != leaves_.end() && leaf->brick == volume_.bricks[i]) continue;
      append(merged, volume_.bricks[i],
             std::span(volume_.values).subspan(i * kBrickCells, kBrickCells));
    }
    add_leaves_before(nullptr);
  }

  std::vector<ConstantBrick> constants() {
    for (const LeafValues& leaf : leaves_) {
      if (leaf.values.size() == 1) constants_.push_back({leaf.brick, leaf.values.front()});
    }
    for (std::size_t i = 0; i < volume_.regions.size(); ++i) {
      if (i % kRegionsBetweenLooks == 0 && cancellation_.requested()) break;
      add_constants(volume_.regions[i]);
    }
    return std::move(constants_);
  }

  /// The constant cubes that have no replaced leaf in them; the others become smaller cubes, or
  /// constant bricks.
  std::vector<ConstantCube> cubes() {
    for (const ConstantCube& cube : volume_.cubes) add_cube(cube);
    return std::move(cubes_);
  }

 private:
  static void append(Volume& to, BrickCoord brick, std::span<const float> values) {
    to.bricks.push_back(brick);
    to.values.insert(to.values.end(), values.begin(), values.end());
  }

  bool is_replaced(BrickCoord brick) const {
    return std::ranges::binary_search(leaves_, brick, {}, &LeafValues::brick);
  }

  bool has_leaf_in(const ConstantCube& cube) const {
    const auto& cubes = cube.edge == kRegionVoxels ? small_cubes_ : large_cubes_;
    return std::ranges::binary_search(cubes, first_brick(cube.min));
  }

  void add_constant(BrickCoord brick, float value) {
    if (value != volume_.background && !is_replaced(brick))
      constants_.push_back({brick, value});
  }

  void add_constants(const Region& region) {
    for (std::int32_t i = 0; i < kRegionBricks * kRegionBricks * kRegionBricks; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (region.brick_index[at] != Region::kConstant) continue;
      add_constant(
          {region.min.x + i / (kRegionBricks * kRegionBricks),
           region.min.y + i / kRegionBricks % kRegionBricks, region.min.z + i % kRegionBricks},
          region.constant[at]);
    }
  }

  void add_cube(const ConstantCube& cube) {
    if (!has_leaf_in(cube)) return cubes_.push_back(cube);
    const std::int32_t step = cube.edge == kRegionVoxels ? kBrickEdge : kRegionVoxels;
    for (std::int32_t x = 0; x < cube.edge; x += step) {
      for (std::int32_t y = 0; y < cube.edge; y += step) {
        for (std::int32_t z = 0; z < cube.edge; z += step) {
          const VoxelCoord min{cube.min.x + x, cube.min.y + y, cube.min.z + z};
          if (step != kBrickEdge) {
            add_cube({min, step, cube.value});
          } else {
            add_constant(first_brick(min), cube.value);
          }
        }
      }
    }
  }

  const Volume& volume_;
  const std::vector<LeafValues>& leaves_;
  const Cancellation& cancellation_;
  const std::vector<BrickCoord> small_cubes_, large_cubes_;  ///< with a leaf in them
  std::vector<ConstantBrick> constants_;
  std::vector<ConstantCube> cubes_;
};

}  // namespace

// Whoever scatters leaves pays for a region with each.
std::uint64_t most_bytes_with(const Volume& volume, std::span<const LeafValues> leaves) {
  const std::vector<LeafValues> all(leaves.begin(), leaves.end());
  const std::uint64_t regions = cubes_around(all, kRegionVoxels).size();
  const auto large = static_cast<std::uint64_t>(
      std::ranges::count(volume.cubes, kLargestCube, &ConstantCube::edge));
  const std::uint64_t broken =
      std::min<std::uint64_t>(large, cubes_around(all, kLargestCube).size());
  constexpr std::uint64_t kPartsOfCube =
      std::uint64_t{1} << 3 * (std::bit_width(unsigned{kLargestCube / kRegionVoxels}) - 1);
  constexpr std::uint64_t kBricksOfRegion = std::tuple_size_v<decltype(Region::constant)>;
  std::uint64_t bytes =
      volume.size_bytes() + regions * sizeof(Region) +
      2 * (volume.cubes.size() + broken * kPartsOfCube) * sizeof(ConstantCube);
  for (const LeafValues& leaf : leaves) {
    bytes += sizeof(LeafValues) + sizeof(ConstantBrick) + sizeof(BrickCoord) +
             sizeof(ValueRange) + leaf.values.size_bytes();
  }
  // The constants of regions are listed on the way, in a list that grows: those of the volume,
  // and those that cubes with a leaf in them become.
  const std::uint64_t listed =
      volume.regions.size() +
      std::min(regions, volume.cubes.size() - large + broken * kPartsOfCube);
  return bytes + 2 * listed * kBricksOfRegion * sizeof(ConstantBrick);
}

absl::StatusOr<Volume> replace_leaves(const Volume& volume,
                                      std::vector<LeafValues> leaves,
                                      const Cancellation& cancellation) {
  std::ranges::sort(leaves, {}, &LeafValues::brick);
  if (auto status = check_leaves(leaves); !status.ok()) return status;
  Volume merged;
  merged.name = volume.name;
  merged.kind = volume.kind;
  merged.kind_source = volume.kind_source;
  merged.transform = volume.transform;
  merged.background = volume.background;
  Remainder rest(volume, leaves, cancellation);
  rest.merge_bricks(merged);
  merged.cubes = rest.cubes();  // what becomes bricks is among the constants
  std::vector<ConstantBrick> constants = rest.constants();
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return index_volume(std::move(merged), std::move(constants), cancellation);
}

}  // namespace tet
