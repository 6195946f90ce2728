// Requests for the meshes of several grids.
#pragma once

#include <string>

#include <absl/status/status.h>

#include "core/plan/shape.h"
#include "proto/convert/request.h"

namespace tet {

/// Takes the names of several grids, if there are any. Errors: kInvalidArgument, with the
/// field.
absl::Status parse_grid_names(const v1::MeshRequest& request, MeshOrder& order);

/// Fills in what was asked for explicitly; each grid has defaults of its own.
void set_canonical_grids(const MeshOrder& order,
                         const GridList& grids,
                         v1::MeshRequest& canonical);

/// Writes every byte of the names of several grids; the text is empty for one grid.
std::string exact_grids(const v1::MeshRequest& canonical);

}  // namespace tet
