// What sessions in this process have in common.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include <absl/status/statusor.h>

#include "client/library/api/core_request.h"
#include "client/library/api/to_public.h"
#include "core/plan/mesh_plan.h"
#include "core/plan/mesh_request.h"
#include "core/plan/request_rules.h"
#include "tetstream/request.h"
#include "tetstream/status.h"

namespace tetstream {

/// A session's request. Errors: those of core_request, kInvalidArgument (what does not go with
/// a session).
inline absl::StatusOr<tet::MeshRequest> session_request(const Request& request) {
  absl::StatusOr<tet::MeshRequest> core = local_request(request);
  if (!core.ok()) return core;
  const absl::Status fits = check_features(
      features_of(*core) | tet::Features{tet::Feature::kSession}, tet::field_names(*core));
  if (!fits.ok()) return fits;
  return core;
}

/// All frames lie on the lattice of the first, about its origin, as on a server.
inline void keep_lattice(const tet::MeshHeader& header, tet::MeshRequest& request) {
  request.spacing = header.spacing;
  request.coordinates = header.coordinate_type;
  request.origin = header.origin;
}

}  // namespace tetstream
