// The functions that openvdb_part() finds, for whoever links OpenVDB.
#pragma once

#include "core/vdb/openvdb/openvdb_part.h"

namespace tet {

const OpenVdbPart& openvdb_functions() noexcept;

}  // namespace tet
