// What the values of a grid tell as one block of bytes, for a process that does not trust who
// wrote it.
#pragma once

#include <cstddef>
#include <span>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/volume/flat_block.h"
#include "core/volume/grid_contents.h"

namespace tet {

/// Writes values and labels; that a grid cannot be meshed is a failure of whoever reads it.
/// Errors: those of the sink.
absl::Status write_flat_contents(const GridContents& contents, const ByteSink& sink);

/// The contents of a block that anyone may have written: values are finite, and labels ascend
/// and have voxels in a box.
///
/// `block` is aligned to 64 bytes and does not change meanwhile. Errors: kInvalidArgument (says
/// what is wrong with it).
absl::StatusOr<GridContents> read_flat_contents(std::span<const std::byte> block);

}  // namespace tet
