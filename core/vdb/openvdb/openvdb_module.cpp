// libtetstream-openvdb.so: what openvdb_part() loads.
#include "core/vdb/openvdb/openvdb_functions.h"

extern "C" const tet::OpenVdbPart* tetstream_openvdb_part() {
  return &tet::openvdb_functions();
}
