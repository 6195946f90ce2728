#include "core/vdb/openvdb/vdb_grids.h"

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {

// libopenvdb makes no grid of these types with the background zero, so it has not compiled
// this.
#ifndef __clang__
template BoolGrid::Ptr BoolGrid::create();
template DoubleGrid::Ptr DoubleGrid::create();
template FloatGrid::Ptr FloatGrid::create();
template Int32Grid::Ptr Int32Grid::create();
template MaskGrid::Ptr MaskGrid::create();
template Vec3DGrid::Ptr Vec3DGrid::create();
template Vec3SGrid::Ptr Vec3SGrid::create();
#else
// Clang takes inline members from elsewhere, too, which Debian's libopenvdb keeps to itself.
template class Grid<BoolTree>;
template class Grid<DoubleTree>;
template class Grid<FloatTree>;
template class Grid<Int32Tree>;
template class Grid<MaskTree>;
template class Grid<Vec3DTree>;
template class Grid<Vec3STree>;

namespace tree {
template class Tree<BoolTree::RootNodeType>;
template class Tree<DoubleTree::RootNodeType>;
template class Tree<FloatTree::RootNodeType>;
template class Tree<Int32Tree::RootNodeType>;
template class Tree<MaskTree::RootNodeType>;
template class Tree<Vec3DTree::RootNodeType>;
template class Tree<Vec3STree::RootNodeType>;
}  // namespace tree
#endif

}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
