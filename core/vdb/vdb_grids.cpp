#include "core/vdb/vdb_grids.h"

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {

// libopenvdb makes no grid of these types with the background zero, so it has not compiled
// this.
template BoolGrid::Ptr BoolGrid::create();
template DoubleGrid::Ptr DoubleGrid::create();
template FloatGrid::Ptr FloatGrid::create();
template Int32Grid::Ptr Int32Grid::create();
template MaskGrid::Ptr MaskGrid::create();
template Vec3DGrid::Ptr Vec3DGrid::create();
template Vec3SGrid::Ptr Vec3SGrid::create();

}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
