// A volume with some of its leaves replaced.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/volume/volume.h"

namespace tet {

/// New values of one brick: 512, at (x*8 + y)*8 + z, or one that it holds throughout.
struct LeafValues {
  BrickCoord brick;
  std::span<const float> values;
};

/// Returns how many bytes replace_leaves takes at most, its result included.
std::uint64_t most_bytes_with(const Volume& volume, std::span<const LeafValues> leaves);

/// The volume with these leaves in the place of what it had there, stored or not. Takes time in
/// proportion to the whole volume: all that stays is copied. Errors: kInvalidArgument (a leaf
/// twice, or with another number of values), those of index_volume and check_cancelled.
absl::StatusOr<Volume> replace_leaves(const Volume& volume,
                                      std::vector<LeafValues> leaves,
                                      const Cancellation& cancellation = Cancellation());

}  // namespace tet
