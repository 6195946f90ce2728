// What is looked at for a mesh: its field, its space, and the bricks of its surface.
#pragma once

#include <memory>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/field/find_bricks.h"
#include "core/field/phi_field.h"
#include "core/plan/mesh_request.h"
#include "core/plan/meshed_space.h"
#include "core/plan/shape.h"

namespace tet {

/// Refers to the shape, which must outlive it.
struct PreparedMesh {
  CanonicalRequest asked;
  /// What stands for a grid whose voxels are no cubes; the field refers to it. Null for others.
  std::shared_ptr<const Scene> stand_in;
  PhiField field;
  MeshedSpace space;
  FoundBricks bricks;
};

/// The field that a request means, and what it refers to beside the shape.
struct MeshedField {
  /// The scene that stands for a grid whose voxels are no cubes; null for all else.
  std::shared_ptr<const Scene> stand_in;
  PhiField phi;
};

/// Keeps of a request what says where phi is zero, for whoever looks at phi once the mesh is
/// made: the rest may need grids that are not loaded any more.
MeshRequest request_for_phi(MeshRequest request);

/// It refers to the shape, which must outlive it. Errors: those of canonical.
absl::StatusOr<MeshedField> meshed_field(const Shape& shape, const MeshRequest& request);

/// Errors: kInvalidArgument (the spacing is more than 256 voxels of a grid).
absl::Status check_spacing(const PhiField& field);

/// Errors: kInvalidArgument (a field of the request), kFailedPrecondition (the shape has no
/// surface at this iso value, or its inside has no end), kResourceExhausted (over `limits`),
/// kCancelled, kDeadlineExceeded.
absl::StatusOr<PreparedMesh> prepare_mesh(const Shape& shape,
                                          const MeshRequest& request,
                                          const MeshLimits& limits,
                                          const Cancellation& cancellation);

}  // namespace tet
