// Interfaces nearer to where indicators have them, and better dihedral angles, in a mesh of
// labels: vertices move, the tets stay as they are.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/cancel.h"
#include "core/labels/label.h"
#include "core/labels/label_samples.h"
#include "core/mesh/improve/improvement.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// What is known of a mesh of labels.
struct LabelledSpace {
  const LabelSource& source;
  const LatticeToWorld& to_world;
  WorldBox domain;  ///< corners of the lattice: where the mesh ends, whatever the labels
  KeptLabels kept;  ///< the label that was left out lies beyond all other faces
};

/// What the angles of a star may become where that brings a vertex nearer to where its labels
/// meet, unless they are worse. With 9.4 and 157.4 curves are nearer by a seventh, and meshes
/// end at these angles; with 14 and 147 curves are farther off by as much.
inline constexpr double kNearMinDihedralDeg = 12, kNearMaxDihedralDeg = 150;

/// Moves vertices where two, three or four labels meet onto the interface, the curve or the
/// point that the source has there, as near as angles allow, and vertices around poor tets to
/// better places on these or within a label. Tets stay the same and positive. No star gets an
/// angle that is both worse than all it had and below kNearMinDihedralDeg, or above
/// kNearMaxDihedralDeg.
///
/// `at_interface` has a byte for each vertex, not 0 where it may lie between labels. Vertices
/// of the boundary within a spacing of the domain's faces stay, and so do those where five
/// labels meet. A vertex goes half a spacing at most. Parallel; one result for any number of
/// threads. Stops early when cancelled, at any valid mesh.
Improvement improve_labels(TetMesh& mesh,
                           const LabelledSpace& space,
                           std::span<const std::uint8_t> at_interface,
                           const Cancellation& cancellation);

}  // namespace tet
