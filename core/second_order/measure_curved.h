// What a mesh of second order is like.
#pragma once

#include <cstdint>

#include "core/mesh/tet_mesh.h"
#include "core/second_order/curved_tet.h"
#include "core/second_order/middle_nodes.h"

namespace tet {

struct CurvedStats {
  double volume = 0;  ///< of the tets inside, exactly: world units cubed
  /// The least share, of all tets, that the Jacobian's determinant has somewhere of that of the
  /// straight tet; it may be this low, and is not lower.
  double least_jacobian_share = 1;
};

/// The nodes of a tet, relative to the mesh's origin.
TenNodes nodes_of(const TetMesh& mesh, const MiddleNodes& middles, std::uint64_t tet) noexcept;

/// Measures every tet in parallel; one value for any number of threads.
CurvedStats measure_curved(const TetMesh& mesh, const MiddleNodes& middles);

}  // namespace tet
