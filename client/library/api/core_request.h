// A caller's request as the mesher takes it.
#pragma once

#include <absl/status/statusor.h>

#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"
#include "tetstream/labels.h"
#include "tetstream/request.h"
#include "tetstream/scene.h"

namespace tetstream {

/// For a server. Errors: kInvalidArgument (a sizing that is none; says where).
absl::StatusOr<tet::MeshRequest> core_request(const Request& request);
/// For this process: the fields' volumes are loaded. Errors: those of core_request;
/// kInvalidArgument (a field without values).
absl::StatusOr<tet::MeshRequest> local_request(const Request& request);

/// Errors: kFailedPrecondition (a volume that has no inside).
absl::StatusOr<tet::Shape> shape_of(const Volume& volume);
/// Errors: kFailedPrecondition (a scene of grids that a server stores).
absl::StatusOr<tet::Shape> shape_of(const Scene& scene);
absl::StatusOr<tet::Shape> shape_of(const Labels& labels);

}  // namespace tetstream
