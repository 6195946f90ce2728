// libtetstream-hdf5.so: what hdf5_part() loads.
#include "core/files/hdf5_functions.h"

extern "C" const tet::Hdf5Part* tetstream_hdf5_part() { return &tet::hdf5_functions(); }
