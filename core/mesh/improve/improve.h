// Better dihedral angles: a few vertices move, the tets stay as they are.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/cancel.h"
#include "core/field/phi_field.h"
#include "core/mesh/improve/improvement.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Angles that need no improvement. The whole time goes into those outside, so a wider goal is
/// quicker; with this one meshes of resolved solids end above 20 degrees.
inline constexpr double kGoodMinDihedralDeg = 22, kGoodMaxDihedralDeg = 140;

/// What is known of each vertex of a mesh; nothing where it is empty.
struct KnownOfVertices {
  std::span<const std::uint8_t> levels =
      {};                                   ///< octree level of the leaves around; else finest
  std::span<const std::uint8_t> stay = {};  ///< not 0: it does not move; else any may
};

/// Moves vertices of tets with angles that are not good until those angles are or nothing
/// helps. The tets stay the same and positive.
///
/// The smallest angle of the mesh never falls and the largest never grows; no star gets an
/// angle that is both worse than all it had and not good. A vertex goes half a leaf at most.
/// One on the surface of `field` (the boundary, or between regions) stays there, within 1e-4
/// spacings. Those on the box around two regions do not move, nor does a boundary that is off
/// the surface. Parallel; one result for any number of threads. Stops early when cancelled, at
/// any valid mesh.
Improvement improve_mesh(TetMesh& mesh,
                         const PhiField& field,
                         const LatticeToWorld& to_world,
                         const KnownOfVertices& known,
                         const Cancellation& cancellation);

}  // namespace tet
