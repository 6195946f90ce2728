// Points and what is said of them as messages, and back.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/types.h"
#include "core/plan/sample_points.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

void to_proto(std::span<const WorldPoint> points, v1::PointBatch& message);

/// The message may be hostile. Points are numbered from `first` on. Errors: kInvalidArgument
/// with INVALID_FIELD (bytes that are no whole number of points, or those of check_points).
absl::StatusOr<std::vector<WorldPoint>> from_proto(const v1::PointBatch& message,
                                                   std::uint64_t first);

/// `first`: the number of the columns' first point within the call.
void to_proto(const SampleColumns& columns, std::uint64_t first, v1::PointSamples& message);

/// Copies what is said of message.point_count points to columns of as many. The message is not
/// trusted. Errors: kInvalidArgument (other sizes than these columns', a wrong checksum).
absl::Status copy_samples(const v1::PointSamples& message, const SampleColumns& columns);

}  // namespace tet
