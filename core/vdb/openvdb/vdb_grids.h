// OpenVDB, with the grids that we make and read already compiled. Include this in place of
// <openvdb/openvdb.h>.
//
// A grid's table of virtual functions names nearly all that its tree can do, reading and
// writing included, and every source that makes a grid would compile all of it: half a minute
// and more. libopenvdb has compiled the same; what it lacks is in vdb_grids.cpp.
#pragma once

#include <openvdb/openvdb.h>

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {

extern template class Grid<BoolTree>;
extern template class Grid<DoubleTree>;
extern template class Grid<FloatTree>;
extern template class Grid<Int32Tree>;
extern template class Grid<MaskTree>;
extern template class Grid<Vec3DTree>;
extern template class Grid<Vec3STree>;

namespace tree {
extern template class Tree<BoolTree::RootNodeType>;
extern template class Tree<DoubleTree::RootNodeType>;
extern template class Tree<FloatTree::RootNodeType>;
extern template class Tree<Int32Tree::RootNodeType>;
extern template class Tree<MaskTree::RootNodeType>;
extern template class Tree<Vec3DTree::RootNodeType>;
extern template class Tree<Vec3STree::RootNodeType>;
}  // namespace tree

}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
