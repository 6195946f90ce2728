// What reading a grid takes, before it is read.
#pragma once

#include <cstdint>
#include <string>

#include <absl/status/status.h>

#include "core/vdb/walk/tree_type.h"
#include "core/vdb/walk/vdb_outline.h"

namespace tet {

/// Fills in the memory that a tree of this shape takes: as OpenVDB builds it, and as a
/// `Volume`.
void charge_memory(TreeOutline& tree, const TreeType& type);

/// What reading a file takes at most, in bytes.
struct MemoryCharge {
  std::uint64_t volume = 0;    ///< held at once by the volume that is made
  std::uint64_t reading = 0;   ///< held at once by all there is while it is made
  std::uint64_t unpacked = 0;  ///< unpacked and dropped: it takes time, and no memory
};

/// What a grid is read for: which grids will do, and what is made of them.
enum class GridUse : std::uint8_t {
  kSurface,  ///< to be meshed
  kField,    ///< to be looked up, one component at a time
  kLabels,   ///< a segmentation
};

/// Bricks of 8 x 8 x 8 voxels in the box around a segmentation's active ones: 2048 voxels along
/// each axis.
inline constexpr std::uint64_t kMostLabelBricks = std::uint64_t{1} << 24;

/// What `load_volume`, `load_field` or `load_labels` takes for `grid_name`, or without a name
/// for any grid that could be meant. 0 when there is no such grid.
MemoryCharge loading_charge(const VdbOutline& outline,
                            const std::string& grid_name,
                            GridUse use = GridUse::kSurface);

/// What `list_grids` takes.
MemoryCharge listing_charge(const VdbOutline& outline);

/// Errors: kResourceExhausted when it is over a limit; with the numbers.
absl::Status check_memory(const MemoryCharge& charge,
                          std::uint64_t max_volume_bytes,
                          std::uint64_t max_reading_bytes);

}  // namespace tet
