// One vertex's search for a place where the tets around it have better angles.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/field/phi_field.h"
#include "core/mesh/improve/star.h"
#include "core/mesh/improve/surface_projector.h"
#include "core/mesh/improve/vertex_stars.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Looks for better places. Reads the mesh and does not change it. Not thread-safe: one per
/// task; scratch memory is reused from vertex to vertex.
class VertexMover {
 public:
  VertexMover(const TetMesh& mesh,
              const PhiField& field,
              const LatticeToWorld& to_world,
              const AngleGoal& goal,
              const AngleRange& mesh_angles);

  struct Outcome {
    std::optional<WorldPoint> place;  ///< as it would be stored; nothing when it stays
    bool good = false;                ///< the star now meets the goal
  };

  /// A better place, `kReach` leaves from `home` at most, where the leaves around the vertex
  /// are `leaf` spacings long: every tet of the star stays positive, the costliest gets
  /// cheaper, and no angle passes all of the star's own, unless it is good and does not pass
  /// all of the mesh's either.
  Outcome move(std::uint64_t vertex,
               std::span<const TetCorner> star,
               const WorldPoint& home,
               double leaf);

  static constexpr double kReach = 0.5;

 private:
  /// Where a vertex may go.
  enum class Freedom : std::uint8_t {
    kAnywhere,  // within a region
    kSurface,   // on the boundary or between regions, which is on the surface there
    kNowhere,   // there, but not on the surface; or on the box around both sides
  };

  Freedom freedom_of(std::span<const TetCorner> star, const WorldPoint& place) noexcept;

  const TetMesh& mesh_;
  AngleGoal goal_;
  AngleRange limit_;  // no star need be better than this
  SurfaceProjector projector_;
  Star star_;

  Vector slope_{};  // of phi where a vertex on the surface was before the move
};

}  // namespace tet
