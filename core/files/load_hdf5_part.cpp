// hdf5_part() where it is a module, which is looked for beside the decoder.
#include "core/files/hdf5_part.h"
#include "core/vdb/parts/load_module.h"

namespace tet {

absl::StatusOr<const Hdf5Part*> hdf5_part() {
  static LoadedModule<const Hdf5Part> part{
      {"libtetstream-hdf5.so", "tetstream_hdf5_part", "HDF5"}};
  return part.get();
}

}  // namespace tet
