// What is surveyed for a mesh: its field, its space, and the bricks to look at.
#pragma once

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/field/find_bricks.h"
#include "core/field/phi_field.h"
#include "core/plan/brick/survey.h"
#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"

namespace tet {

/// Refers to the shape, which must outlive it.
struct PreparedMesh {
  CanonicalRequest asked;
  PhiField field;
  MeshedSpace space;
  FoundBricks bricks;
};

/// Errors: kInvalidArgument (a field of the request), kFailedPrecondition (the shape has no
/// surface at this iso value, or its inside has no end), kResourceExhausted (over `limits`),
/// kCancelled, kDeadlineExceeded.
absl::StatusOr<PreparedMesh> prepare_mesh(const Shape& shape,
                                          const MeshRequest& request,
                                          const MeshLimits& limits,
                                          const Cancellation& cancellation);

}  // namespace tet
