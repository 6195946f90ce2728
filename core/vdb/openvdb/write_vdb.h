// One grid to a .vdb file: whole and on disk, or not there at all.
#pragma once

#include <string>

#include <absl/status/status.h>

#include "core/vdb/openvdb/vdb_grids.h"

namespace tet {

/// Writes beside `path`, syncs, and renames; what was at `path` before stays until then.
/// Errors: kUnavailable (with the system's reason); nothing is left behind.
absl::Status write_vdb(const openvdb::GridBase::ConstPtr& grid, const std::string& path);

}  // namespace tet
