#include "core/vdb/memory_charge.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include <absl/strings/str_format.h>

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

/// A volume without any column. A string has room for thirty letters once it grows at all.
std::uint64_t empty_volume_bytes(const GridOutline& grid) {
  constexpr std::uint64_t kLeastRoom = 30;
  return sizeof(Volume) + std::max<std::uint64_t>(kLeastRoom, grid.name.size());
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
    const std::uint64_t volume = grid.tree.volume_bytes + empty_volume_bytes(grid);
    charge.volume = std::max(charge.volume, volume);
    charge.reading = std::max(charge.reading, tree_bytes(grid.tree) + volume);
  }
  if (use == GridUse::kLabels && charge.reading > 0) {
    charge.volume += kLabelTableBytes;
    charge.reading += kGrowth * kLabelTableBytes;
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
