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
  bool is_centre = false;  ///< of a leaf, else a corner
  bool leads_to_centre = false;
  LatticeCoord along;  ///< to the other end, doubled finest spacings
  int level = 0;       ///< of the smallest leaf at this end
};

/// How near to a node a cut point violates it, as a part of their edge: by what the edge joins,
/// for either end. docs/algorithm.md says how these were found.
struct GradedLimits {
  // Of a corner.
  double corner_to_corner = 0;       ///< along an edge of its smallest leaves
  double corner_to_far_corner = 0;   ///< along an edge of a leaf twice as long
  double corner_across_face = 0;     ///< between a face's centre and its corner
  double corner_to_centre = 0;       ///< of its smallest leaves
  double corner_to_far_centre = 0;   ///< of a leaf twice as long
  double face_centre_to_centre = 0;  ///< of the leaf whose face it is in the middle of
  double edge_middle_to_centre = 0;  ///< of a leaf whose edge it is in the middle of
  // Of a leaf's centre.
  double centre_to_centre = 0;
  double centre_to_corner = 0;
  double centre_to_face_centre = 0;
  double centre_to_edge_middle = 0;

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
};

/// What every dihedral angle of a mesh with a graded surface lies between. Proven of positions
/// as they are computed by tests/certificate/graded_certificate.cpp.
inline constexpr double kLeastGradedAngleDeg = 5, kGreatestGradedAngleDeg = 174;

/// Of each node the edge whose cut point it moves onto, or SurfaceEdges::kNone: the nearest of
/// those that violate it, the first one of equally near ones. Reads original samples only.
std::vector<std::uint32_t> warp_nodes(const BackgroundMesh& mesh,
                                      const SurfaceEdges& edges,
                                      const GradedLimits& limits);

}  // namespace tet
