#include "core/mesh/improve/vertex_mover.h"

#include <algorithm>

#include "core/mesh/improve/faces_around.h"
#include "core/mesh/improve/place_search.h"

namespace tet {
namespace {

/// Leads a vertex through space, or along the surface.
struct SurfaceGuide {
  SurfaceProjector& projector;
  bool on_surface;
  Vector slope;  ///< of phi where the vertex was before the move

  Vector along(const Vector& way) const noexcept {
    if (!on_surface) return way;
    const double upwards = dot(way, slope) / dot(slope, slope);
    return {way.x - upwards * slope.x, way.y - upwards * slope.y, way.z - upwards * slope.z};
  }
  std::optional<WorldPoint> settle(const WorldPoint& ahead) noexcept {
    return on_surface ? projector.project(ahead, slope) : projector.rounded(ahead);
  }
};

}  // namespace

VertexMover::VertexMover(const TetMesh& mesh,
                         const PhiField& field,
                         const LatticeToWorld& to_world,
                         const AngleGoal& goal,
                         const AngleRange& mesh_angles)
    : mesh_(mesh),
      goal_(goal),
      limit_{std::min(goal.good.largest_cosine, mesh_angles.largest_cosine),
             std::max(goal.good.smallest_cosine, mesh_angles.smallest_cosine)},
      projector_(field, to_world, mesh.header),
      star_(goal) {}

VertexMover::Freedom VertexMover::freedom_of(std::span<const TetCorner> star,
                                             const WorldPoint& place) noexcept {
  const FacesAroundVertex faces = faces_around(mesh_, star);
  // Where both sides are meshed the surface runs between them, and the boundary is a box.
  const bool on_box = mesh_.header.has_regions && faces.on_boundary();
  if (on_box) return Freedom::kNowhere;
  if (!faces.on_boundary() && !faces.between_regions()) return Freedom::kAnywhere;
  const PhiSlope here = projector_.at(place);
  slope_ = here.gradient;
  return projector_.is_on_surface(here) ? Freedom::kSurface : Freedom::kNowhere;
}

VertexMover::Outcome VertexMover::move(std::uint64_t vertex,
                                       std::span<const TetCorner> star,
                                       const WorldPoint& home,
                                       double leaf) {
  const WorldPoint start = mesh_.stored_position(vertex);
  star_.gather(mesh_, star);
  const AngleRange before = star_.angles(start);
  if (goal_.met_by(before)) return {{}, true};
  const Freedom freedom = freedom_of(star, start);
  if (freedom == Freedom::kNowhere) return {};

  SurfaceGuide guide{projector_, freedom == Freedom::kSurface, slope_};
  const double edge = leaf * mesh_.header.spacing;
  PlaceSearch search(star_, goal_, guide);
  if (!search.run({start, home, edge, kReach * edge, before, limit_})) return {};
  return {search.place(), search.good()};
}

}  // namespace tet
