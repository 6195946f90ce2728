// Tables of one mesh on another one, so that integrals stay.
#pragma once

#include "core/base/cancel.h"
#include "core/remap/columns.h"
#include "core/remap/data_mesh.h"
#include "core/remap/mass_matrix.h"
#include "core/remap/tet_locator.h"

namespace tet {

/// What is transferred at once: either may have no columns.
struct MeshTables {
  Table points, cells;
};

struct ConservativeResult {
  MeshTables tables;
  double common_volume = 0;  ///< of both meshes
};

/// The values at points that are nearest to the old ones in the sense of least squares, and of
/// each cell the mean of what it covers; where the new mesh goes beyond the old one, the values
/// of the nearest tet are carried on. Whatever that, and rounding, did to an integral is taken
/// back in proportion to the values' size. `clamp` keeps values between the least and the
/// largest of the old column. Parallel.
ConservativeResult transfer_integrals(const TetLocator& from,
                                      const MeshTables& old_tables,
                                      const DataMesh& to,
                                      bool clamp,
                                      const Cancellation& cancellation);

/// Integrals of columns at points and of cells.
std::vector<double> integrals_of_points(const MassMatrix& mass, const Table& table);
std::vector<double> integrals_of_cells(const MassMatrix& mass, const Table& table);

}  // namespace tet
