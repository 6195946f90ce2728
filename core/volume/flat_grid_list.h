// The list of a file's grids as one block of bytes, for a process that does not trust who wrote
// it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/volume/flat_block.h"
#include "core/volume/grid_info.h"

namespace tet {

/// Errors: those of the sink.
absl::Status write_flat_grid_list(std::span<const GridInfo> grids, const ByteSink& sink);

/// The list of a block that anyone may have written. A name may hold any bytes; every other
/// text is printable, and the background is what the file says, a number or not.
///
/// `block` is aligned to 64 bytes and does not change meanwhile. Errors: kInvalidArgument (says
/// what is wrong with it).
absl::StatusOr<std::vector<GridInfo>> read_flat_grid_list(std::span<const std::byte> block);

}  // namespace tet
