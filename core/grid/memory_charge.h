// What reading a grid takes, before it is read.
#pragma once

#include <cstdint>
#include <string>

#include <absl/status/status.h>

#include "core/grid/tree_type.h"
#include "core/grid/vdb_outline.h"

namespace tet {

/// Fills in the memory that a tree of this shape takes: as OpenVDB builds it, and as a
/// `Volume`.
void charge_memory(TreeOutline& tree, const TreeType& type);

/// The most memory that `load_volume` holds at once for `grid_name`, or without a name for the
/// largest grid that could be meant. 0 when there is no such grid.
std::uint64_t loading_bytes(const VdbOutline& outline, const std::string& grid_name);

/// The most memory that `list_grids` holds at once.
std::uint64_t listing_bytes(const VdbOutline& outline);

/// Errors: kResourceExhausted when reading a file takes more than the limit; with the numbers.
absl::Status check_memory(std::uint64_t bytes, std::uint64_t max_bytes);

}  // namespace tet
