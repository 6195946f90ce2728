// What a server says of points.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include <absl/status/statusor.h>

#include "client/library/connection.h"
#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/plan/sample_points.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// Told how many points were answered, of all.
using PointProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// Asks a server of all points, a few thousands at a time. A call that breaks is taken up again
/// at the first point that was not answered: what is said of a point depends on it alone.
/// Errors: those of check_points, and of the service; kDataLoss (an answer that is none).
absl::StatusOr<PointSamples> sample_there(Connection& connection,
                                          const v1::MeshRequest& request,
                                          std::span<const WorldPoint> points,
                                          const PointProgress& progress,
                                          const Cancellation& cancellation);

}  // namespace tet
