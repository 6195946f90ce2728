// HDF5's side of hdf5_part.h.
#pragma once

#include "core/files/hdf5_part.h"

namespace tet {

const Hdf5Part& hdf5_functions();

}  // namespace tet
