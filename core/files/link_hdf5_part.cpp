// hdf5_part() where it is linked: a sanitizer belongs to a whole program.
#include "core/files/hdf5_functions.h"

namespace tet {

absl::StatusOr<const Hdf5Part*> hdf5_part() { return &hdf5_functions(); }

}  // namespace tet
