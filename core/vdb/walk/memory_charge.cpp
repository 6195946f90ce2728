#include "core/vdb/walk/memory_charge.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include <absl/strings/str_format.h>

#include "core/volume/label_volume.h"
#include "core/volume/node_mask.h"
#include "core/volume/volume.h"
#include "core/volume/volume_builder.h"

namespace tet {
namespace {

/// What a node has beside its table and masks, and the allocator beside the node.
constexpr std::uint64_t kNodeBytes = 64;
/// An entry of the root's map.
constexpr std::uint64_t kRootEntryBytes = 112;
/// Vectors double as they grow, and for a moment there are both.
constexpr std::uint64_t kGrowth = 3;

/// Bytes of an inner node. Its table holds values or pointers.
template <class Mask>
std::uint64_t node_bytes(const TreeType& type) {
  const std::uint64_t entry =
      (type.value_bytes + sizeof(void*) - 1) / sizeof(void*) * sizeof(void*);
  return kNodeBytes + 2 * Mask::kBytes + Mask::kBits * entry;
}

std::uint64_t topology_bytes(const TreeOutline& tree, const TreeType& type) {
  return tree.root_entries * kRootEntryBytes + tree.uppers * node_bytes<UpperMask>(type) +
         tree.lowers * node_bytes<LowerMask>(type) +
         tree.leaves * (kNodeBytes + LeafMask::kBytes);
}

std::uint64_t value_bytes(const TreeOutline& tree, const TreeType& type) {
  if (type.leaves == LeafLayout::kMask) return 0;
  const std::uint64_t bytes =
      type.leaves == LeafLayout::kBits ? LeafMask::kBytes : LeafMask::kBits * type.value_bytes;
  return tree.leaves * bytes;
}

std::uint64_t volume_bytes(const TreeOutline& tree) {
  constexpr std::uint64_t kBrickBytes =
      kBrickCells * sizeof(float) + sizeof(BrickCoord) + sizeof(ValueRange) + sizeof(void*);
  const std::uint64_t cubes = tree.root_tiles.stored + tree.upper_tiles.stored;
  return tree.leaves * kBrickBytes + tree.lowers * sizeof(Region) +
         kGrowth *
             (cubes * sizeof(ConstantCube) + tree.lower_tiles.stored * sizeof(ConstantBrick));
}

/// What a volume has beside its columns. A string has room for thirty letters once it grows at
/// all.
template <class AnyVolume>
std::uint64_t empty_volume_bytes(const GridOutline& grid) {
  constexpr std::uint64_t kLeastRoom = 30;
  return sizeof(AnyVolume) + std::max<std::uint64_t>(kLeastRoom, grid.name.size());
}

/// Bricks of a segmentation's box, and those of them that it has only a part of.
struct LabelBricks {
  std::uint64_t all = 1, whole = 1;

  /// Counts none where there are so many that they are refused before any is made.
  explicit LabelBricks(const VoxelBox& box) {
    if (box.empty()) {
      all = whole = 0;
      return;
    }
    for (const auto& [min, max] :
         {std::pair(box.min.x, box.max.x), std::pair(box.min.y, box.max.y),
          std::pair(box.min.z, box.max.z)}) {
      const std::int64_t end = std::int64_t{max} + 1, last = kBrickEdge - 1;
      all *= static_cast<std::uint64_t>(((end + last) >> kBrickShift) - (min >> kBrickShift));
      whole *= static_cast<std::uint64_t>(
          std::max<std::int64_t>(0, (end >> kBrickShift) - ((min + last) >> kBrickShift)));
      if (all > kMostLabelBricks) {
        all = whole = 0;
        return;
      }
    }
  }
};

/// Columns that grow with the bricks of a segmentation. Of bricks without a leaf, which have
/// one label, those have values that reach beyond the box.
std::uint64_t label_brick_bytes(const TreeOutline& tree) {
  const LabelBricks bricks(tree.active_box);
  const std::uint64_t mixed = std::min(bricks.all, tree.leaves + bricks.all - bricks.whole);
  return bricks.all * sizeof(std::uint32_t) + mixed * kBrickCells * sizeof(std::uint16_t);
}

/// Labels and how many voxels each has; while they are gathered, also by their values.
constexpr std::uint64_t kLabelListBytes =
    LabelVolume::kMostLabels * (sizeof(std::int64_t) + sizeof(std::uint64_t));
constexpr std::uint64_t kLabelGatheringBytes = kGrowth * 3 * kLabelListBytes;

MemoryCharge label_charge(const GridOutline& grid) {
  const std::uint64_t bricks = label_brick_bytes(grid.tree);
  const std::uint64_t other = empty_volume_bytes<LabelVolume>(grid);
  return {.volume = bricks + other + kLabelListBytes,
          .reading = kGrowth * bricks + other + kLabelGatheringBytes};
}

MemoryCharge volume_charge(const GridOutline& grid) {
  const std::uint64_t bytes = grid.tree.volume_bytes + empty_volume_bytes<Volume>(grid);
  return {.volume = bytes, .reading = bytes};
}

bool is_scalar(const GridOutline& grid) {
  constexpr std::array<std::string_view, 6> kScalars{"Tree_float_5_4_3", "Tree_double_5_4_3",
                                                     "Tree_int32_5_4_3", "Tree_int64_5_4_3",
                                                     "Tree_bool_5_4_3",  "Tree_mask_5_4_3"};
  return std::ranges::find(kScalars, grid.tree_type) != kScalars.end();
}

bool is_vector(const GridOutline& grid) {
  return grid.tree_type == "Tree_vec3s_5_4_3" || grid.tree_type == "Tree_vec3d_5_4_3";
}

bool has_whole_values(const GridOutline& grid) {
  return is_scalar(grid) && grid.tree_type != "Tree_float_5_4_3" &&
         grid.tree_type != "Tree_double_5_4_3";
}

bool will_do(const GridOutline& grid, GridUse use) {
  if (use == GridUse::kLabels) return has_whole_values(grid);
  return is_scalar(grid) || (use == GridUse::kField && is_vector(grid));
}

std::uint64_t tree_bytes(const TreeOutline& tree) {
  return tree.topology_bytes + tree.value_bytes;
}

}  // namespace

void charge_memory(TreeOutline& tree, const TreeType& type) {
  tree.topology_bytes = topology_bytes(tree, type);
  tree.value_bytes = value_bytes(tree, type);
  tree.volume_bytes = volume_bytes(tree);
}

MemoryCharge listing_charge(const VdbOutline& outline) {
  MemoryCharge charge;
  for (const GridOutline& grid : outline.grids) {
    if (grid.instance) continue;
    charge.reading += outline.has_offsets ? grid.tree.topology_bytes : tree_bytes(grid.tree);
  }
  return charge;
}

MemoryCharge loading_charge(const VdbOutline& outline,
                            const std::string& grid_name,
                            GridUse use) {
  const bool lists = !outline.has_offsets || (grid_name.empty() && outline.grids.size() > 1);
  MemoryCharge charge;
  for (const GridOutline& grid : outline.grids) {
    if (!will_do(grid, use) || (!grid_name.empty() && grid.name != grid_name)) continue;
    const MemoryCharge made =
        use == GridUse::kLabels ? label_charge(grid) : volume_charge(grid);
    charge.volume = std::max(charge.volume, made.volume);
    charge.reading = std::max(charge.reading, tree_bytes(grid.tree) + made.reading);
  }
  if (lists) charge.reading += listing_charge(outline).reading;
  return charge;
}

absl::Status check_memory(const MemoryCharge& charge,
                          std::uint64_t max_volume_bytes,
                          std::uint64_t max_reading_bytes) {
  const bool volume = charge.volume > max_volume_bytes;
  if (!volume && charge.reading <= max_reading_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "%s takes %d bytes of memory and the limit is %d: use larger voxels, a narrower band, or "
      "raise the limit",
      volume ? "it" : "reading it", volume ? charge.volume : charge.reading,
      volume ? max_volume_bytes : max_reading_bytes));
}

}  // namespace tet
