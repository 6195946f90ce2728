// A volume as one block of bytes, for a process that does not trust who wrote it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/volume/flat_block.h"
#include "core/volume/volume.h"

namespace tet {

/// Bytes that `write_flat_volume` writes, or more.
std::uint64_t flat_volume_bytes(const Volume& volume);

/// Writes what a volume's derived columns follow from: header, name, bricks, values, the
/// constant bricks that differ from the background, and cubes. Errors: those of the sink.
absl::Status write_flat_volume(const Volume& volume, const ByteSink& sink);

/// The volume of a block that anyone may have written: every size is checked before it is used,
/// and all that `load_volume` promises of a volume holds of what is returned. Ranges and
/// regions are made anew.
///
/// `block` is aligned to 64 bytes and does not change meanwhile. Errors: kInvalidArgument (not
/// such a block; says what is wrong with it), kFailedPrecondition (values or coordinates that
/// cannot be meshed), kResourceExhausted (the volume would take more than `max_bytes`),
/// kCancelled.
absl::StatusOr<Volume> read_flat_volume(std::span<const std::byte> block,
                                        std::uint64_t max_bytes,
                                        const Cancellation& cancellation = Cancellation());

}  // namespace tet
