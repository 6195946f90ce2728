// What is told of a mesh beside itself, as messages, and back: quality, boundary, thin walls
// and improvement.
#pragma once

#include <absl/status/statusor.h>

#include "core/base/quality_stats.h"
#include "core/mesh/boundary_topology.h"
#include "core/mesh/improve/improvement.h"
#include "core/plan/thin_walls.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

void to_proto(const QualityStats& stats, v1::QualityStats& message);
void to_proto(const BoundaryTopology& boundary, v1::BoundaryTopology& message);
void to_proto(const ThinWalls& walls, v1::ThinWalls& message);
void to_proto(const Improvement& improvement, v1::Improvement& message);

// The messages are not trusted: counts are such that sums of them do not overflow, and
// numbers are finite. Errors: kInvalidArgument, which begins with the field.

absl::StatusOr<QualityStats> from_proto(const v1::QualityStats& message);
absl::StatusOr<BoundaryTopology> from_proto(const v1::BoundaryTopology& message);
absl::StatusOr<ThinWalls> from_proto(const v1::ThinWalls& message);
absl::StatusOr<Improvement> from_proto(const v1::Improvement& message);

}  // namespace tet
