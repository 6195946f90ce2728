// Grids as what they are: their types are known when a file has been read, and not before.
#pragma once

#include "core/vdb/openvdb/vdb_grids.h"

namespace tet {

/// Calls `visit` with a grid of whole numbers as what it is; `otherwise()` where it is none.
template <class Visit, class Otherwise>
auto visit_whole(const openvdb::GridBase& grid,
                 const Visit& visit,
                 const Otherwise& otherwise) {
  if (grid.isType<openvdb::Int32Grid>()) {
    return visit(static_cast<const openvdb::Int32Grid&>(grid));
  }
  if (grid.isType<openvdb::Int64Grid>()) {
    return visit(static_cast<const openvdb::Int64Grid&>(grid));
  }
  if (grid.isType<openvdb::BoolGrid>()) {
    return visit(static_cast<const openvdb::BoolGrid&>(grid));
  }
  if (grid.isType<openvdb::MaskGrid>()) {
    return visit(static_cast<const openvdb::MaskGrid&>(grid));
  }
  return otherwise();
}

/// Calls `visit` with a grid of any numbers as what it is; `otherwise()` where it is none.
template <class Visit, class Otherwise>
auto visit_scalar(const openvdb::GridBase& grid,
                  const Visit& visit,
                  const Otherwise& otherwise) {
  if (grid.isType<openvdb::FloatGrid>()) {
    return visit(static_cast<const openvdb::FloatGrid&>(grid));
  }
  if (grid.isType<openvdb::DoubleGrid>()) {
    return visit(static_cast<const openvdb::DoubleGrid&>(grid));
  }
  return visit_whole(grid, visit, otherwise);
}

}  // namespace tet
