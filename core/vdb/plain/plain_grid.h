// Grids that are read without OpenVDB: what the walker has been over needs no more than its
// places in the file, blosc and zlib.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/vdb/walk/charge_file.h"
#include "core/volume/grid_info.h"
#include "core/volume/volume.h"

namespace tet {

/// Reads the grid that find_plain_grid found in a file that has just been walked over: the
/// volume that load_volume or load_field makes of it, bit by bit. Errors: theirs.
absl::StatusOr<Volume> read_plain_grid(const OpenGridFile& file,
                                       const VdbOutline& outline,
                                       std::size_t grid,
                                       GridUse use);

/// The list that list_grids makes of a file of such grids alone. Errors: its.
absl::StatusOr<std::vector<GridInfo>> list_plain_grids(const OpenGridFile& file,
                                                       const VdbOutline& outline);

}  // namespace tet
