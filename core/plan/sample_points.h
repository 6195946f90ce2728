// phi, its slope, and the values of fields at points that lie anywhere.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/field/world_phi.h"
#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"

namespace tet {

struct PointSamples {
  std::vector<PhiSlope> phi;       ///< one a point
  std::vector<FieldArray> arrays;  ///< of the request's fields
  std::size_t width = 0;           ///< values that a point has of them
  std::vector<float> values;       ///< `width` a point, one field after the other
};

/// What a mesh of `request` and `shape` is made from, at each of `points`: phi as it is meshed,
/// trilinear between voxels or the scene's, and its slope there; values of fields as vertices
/// get them. What is said of a point depends on the point alone. Parallel; run it on a
/// TaskPool.
///
/// Errors: those of canonical, kInvalidArgument (several grids; a point that is not finite),
/// kCancelled, kDeadlineExceeded.
absl::StatusOr<PointSamples> sample_points(const Shape& shape,
                                           const MeshRequest& request,
                                           std::span<const WorldPoint> points,
                                           const Cancellation& cancellation = {});

}  // namespace tet
