#include "core/graded/graded_warp.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace tet {

double GradedLimits::part(const EdgeEnd& end) const noexcept {
  const std::int32_t x = std::abs(end.along.x), y = std::abs(end.along.y),
                     z = std::abs(end.along.z);
  const int axes = (x != 0) + (y != 0) + (z != 0);
  // Along an axis, a leaf's edge is twice as long as it is from its centre to a face.
  const bool far = std::max({x, y, z}) >> end.level > (axes == 1 ? 2 : 1);
  using enum BackgroundNode;
  if (axes == 2 && (end.from == kCutMiddle || end.to == kCutMiddle)) return across_cut_face;
  if (end.from == kCentre) {
    if (end.to == kCentre) return centre_to_centre;
    return axes == 1   ? centre_to_face_centre
           : axes == 2 ? centre_to_edge_middle
                       : centre_to_corner;
  }
  if (end.to != kCentre) {
    return axes == 2 ? corner_across_face : far ? corner_to_far_corner : corner_to_corner;
  }
  if (axes == 1) return face_centre_to_centre;
  if (axes == 2) return edge_middle_to_centre;
  return far ? corner_to_far_centre : corner_to_centre;
}

std::vector<std::uint32_t> warp_nodes(const BackgroundMesh& mesh,
                                      const SurfaceEdges& edges,
                                      const GradedLimits& limits) {
  std::vector<std::uint32_t> onto(mesh.node.size(), SurfaceEdges::kNone);
  std::vector<double> distance(mesh.node.size(), std::numeric_limits<double>::infinity());
  const auto end_of = [&](NodeId from, NodeId to) {
    return EdgeEnd{mesh.kind[from], mesh.kind[to], mesh.node[to] - mesh.node[from],
                   mesh.level[from]};
  };
  const auto consider = [&](std::uint32_t edge, NodeId from, NodeId to, double part) {
    const EdgeEnd end = end_of(from, to);
    if (part >= limits.part(end)) return;
    if ((mesh.faces_at(from) & ~mesh.faces_at(to)) != 0) {
      if (onto[from] == SurfaceEdges::kNone) onto[from] = kInPlace;
      return;
    }
    const double length = part * std::hypot(end.along.x, end.along.y, end.along.z);
    if (length >= distance[from]) return;
    distance[from] = length;
    onto[from] = edge;
  };
  for (NodeId low = 0; low < mesh.node.size(); ++low) {
    for (std::uint32_t e = edges.first[low]; e < edges.first[low + 1]; ++e) {
      const auto fraction = static_cast<double>(edges.fraction[e]);
      consider(e, low, edges.high[e], fraction);
      consider(e, edges.high[e], low, 1 - fraction);
    }
  }
  return onto;
}

}  // namespace tet
