// A segmentation as one block of bytes, for a process that does not trust who wrote it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/volume/flat_block.h"
#include "core/volume/label_volume.h"

namespace tet {

/// Bytes that `write_flat_labels` writes, or more.
std::uint64_t flat_label_bytes(const LabelVolume& volume);

/// Errors: those of the sink.
absl::Status write_flat_labels(const LabelVolume& volume, const ByteSink& sink);

/// The segmentation of a block that anyone may have written: every size is checked before it is
/// used, and all that make_label_volume promises holds of what is returned. Voxels are counted
/// anew.
///
/// `block` is aligned to 64 bytes and does not change meanwhile. Errors: kInvalidArgument (not
/// such a block; says what is wrong with it), kFailedPrecondition (a transform that cannot be
/// meshed), kResourceExhausted (it would take more than `max_bytes`), kCancelled.
absl::StatusOr<LabelVolume> read_flat_labels(std::span<const std::byte> block,
                                             std::uint64_t max_bytes,
                                             const Cancellation& cancellation = Cancellation());

}  // namespace tet
