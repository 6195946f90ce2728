// Which nodes of a background move onto the surface, and where to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/graded/background_mesh.h"
#include "core/graded/surface_edges.h"

namespace tet {

/// One end of an edge of a background.
struct EdgeEnd {
  BackgroundNode from = BackgroundNode::kCorner, to = BackgroundNode::kCorner;
  LatticeCoord along;  ///< to the other end, doubled finest spacings
  int level = 0;       ///< of the smallest leaf at this end
};

/// How near to a node a cut point violates it, as a part of their edge: by what the edge joins,
/// for either end. docs/algorithm.md says how these were found.
struct GradedLimits {
  // These are near a corner.
  double corner_to_corner = 0;       ///< along an edge of its smallest leaves
  double corner_to_far_corner = 0;   ///< along an edge of a leaf twice as long
  double corner_across_face = 0;     ///< between a face's centre and its corner
  double corner_to_centre = 0;       ///< of its smallest leaves
  double corner_to_far_centre = 0;   ///< of a leaf twice as long
  double face_centre_to_centre = 0;  ///< of the leaf whose face it is in the middle of
  double edge_middle_to_centre = 0;  ///< of a leaf whose edge it is in the middle of
  // These are near a leaf's centre.
  double centre_to_centre = 0;
  double centre_to_corner = 0;
  double centre_to_face_centre = 0;
  double centre_to_edge_middle = 0;
  // This one is in a face of the box, between the middle of a leaf's face and its corner.
  double across_cut_face = 0;

  double part(const EdgeEnd& end) const noexcept;
};

inline constexpr GradedLimits kGradedLimits{
    .corner_to_corner = 0.253,
    .corner_to_far_corner = 0.154,
    .corner_across_face = 0.198,
    .corner_to_centre = 0.289,
    .corner_to_far_centre = 0.167,
    .face_centre_to_centre = 0.267,
    .edge_middle_to_centre = 0.155,
    .centre_to_centre = 0.224,
    .centre_to_corner = 0.215,
    .centre_to_face_centre = 0.261,
    .centre_to_edge_middle = 0.257,
    .across_cut_face = 0.235,
};

/// What every dihedral angle of a mesh with a graded surface lies between. Proven of positions
/// as they are computed by tests/certificate/graded_certificate.cpp.
inline constexpr double kLeastGradedAngleDeg = 5, kGreatestGradedAngleDeg = 174;
/// And of one that a box cuts: within what graded_limits finds, not yet proven.
inline constexpr double kLeastCutAngleDeg = 4, kGreatestCutAngleDeg = 175;

/// Instead of an edge: the node counts as one on the surface where it is.
inline constexpr std::uint32_t kInPlace = SurfaceEdges::kNone - 1;

/// Finds for each node the edge whose cut point it moves onto, or SurfaceEdges::kNone: the
/// nearest of those that violate it, and the first one of equally near ones. A node in faces of
/// the mesh's box stays in all of them: it moves along edges that do, and is kInPlace where
/// only others violate it. Reads original samples only.
std::vector<std::uint32_t> warp_nodes(const BackgroundMesh& mesh,
                                      const SurfaceEdges& edges,
                                      const GradedLimits& limits);

}  // namespace tet
