// The scene of a request for a mesh.
#pragma once

#include <memory>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "proto/convert/request.h"

namespace tet {

/// Takes a scene as far as it is known before its grids are loaded. Errors: kInvalidArgument,
/// with the field.
absl::Status parse_scene(const v1::MeshRequest& request, MeshOrder& order);

/// Makes an order's scene, whose grids are loaded, and checks it with the order's box and
/// spacing. Errors:
/// kInvalidArgument, with the field.
absl::StatusOr<std::shared_ptr<const Scene>> scene_of_order(const MeshOrder& order);

/// Fills in what the scene's grids have by default; they are loaded.
void set_canonical_scene(const MeshOrder& order, v1::MeshRequest& canonical);

}  // namespace tet
