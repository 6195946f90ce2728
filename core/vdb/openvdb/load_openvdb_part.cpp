// openvdb_part() where it is a module, which is looked for beside the decoder.
#include "core/vdb/openvdb/openvdb_part.h"
#include "core/vdb/parts/load_module.h"

namespace tet {
namespace {

LoadedModule<const OpenVdbPart>& module() {
  static LoadedModule<const OpenVdbPart> part{
      {"libtetstream-openvdb.so", "tetstream_openvdb_part", "OpenVDB"}};
  return part;
}

}  // namespace

absl::StatusOr<const OpenVdbPart*> openvdb_part() { return module().get(); }

bool has_openvdb_part() noexcept { return module().is_loaded(); }

}  // namespace tet
