// Requests for the meshes of several grids.
#pragma once

#include <string>

#include <absl/status/status.h>

#include "core/plan/shape.h"
#include "proto/convert/request.h"

namespace tet {

// Each is OK or kInvalidArgument, with the field.

/// The names, and whether anything beside them is for one grid alone.
absl::Status parse_grid_names(const v1::MeshRequest& request, MeshOrder& order);

/// What only one grid's mesh can be sent as.
absl::Status check_stream_of_grids(const v1::StreamMeshRequest& request);

/// A session is of one grid.
absl::Status check_session_of_grids(const v1::MeshRequest& request);

/// What is asked for explicitly: defaults are each grid's own.
void set_canonical_grids(const MeshOrder& order,
                         const GridList& grids,
                         v1::MeshRequest& canonical);

/// Every byte of a canonical request's grids; nothing for one grid.
std::string exact_grids(const v1::MeshRequest& canonical);

}  // namespace tet
