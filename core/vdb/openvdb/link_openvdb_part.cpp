// openvdb_part() where it is linked: a sanitizer belongs to a whole program.
#include "core/vdb/openvdb/openvdb_functions.h"

namespace tet {

absl::StatusOr<const OpenVdbPart*> openvdb_part() { return &openvdb_functions(); }

bool has_openvdb_part() noexcept { return true; }

}  // namespace tet
