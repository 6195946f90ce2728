// One vertex of a mesh of labels: what meets there, and where it may go.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/mesh/improve/improve_labels.h"
#include "core/mesh/improve/interface_projector.h"
#include "core/mesh/improve/star.h"
#include "core/mesh/improve/vertex_stars.h"

namespace tet {

/// Looks for places of vertices. Reads the mesh and does not change it. Not thread-safe: one
/// per task; scratch memory is reused from vertex to vertex.
class LabelMover {
 public:
  LabelMover(const TetMesh& mesh,
             const LabelledSpace& space,
             const MeshView& before,
             const AngleRange& mesh_angles);

  struct Outcome {
    std::optional<WorldPoint> place;  ///< as it would be stored; nothing when it stays
    bool good = false;                ///< no other place is wanted
  };

  /// A place nearer to where the labels around the vertex meet, as near as angles allow.
  Outcome approach(std::uint64_t vertex, std::span<const TetCorner> star);
  /// Such a place, or where that is barred one as near beside it.
  Outcome approach_aside(std::uint64_t vertex, std::span<const TetCorner> star);

  /// A place with better angles, as near to where labels meet as it is.
  Outcome relax(std::uint64_t vertex, std::span<const TetCorner> star);

  static constexpr double kReach = 0.5;  ///< spacings

 private:
  /// Labels around a vertex, ascending.
  struct Meeting {
    std::size_t count = 0;
    std::array<Label, kMostMeeting> label{};
    bool fixed = false;  ///< on the domain's faces, or where more labels meet

    void add(Label added) noexcept;
    std::span<const Label> labels() const noexcept { return std::span(label).first(count); }
  };

  Meeting meeting_of(std::span<const TetCorner> star, const WorldPoint& place) const noexcept;
  bool near_domain_face(const WorldPoint& place) const noexcept;
  Outcome bring_nearer(std::uint64_t vertex, std::span<const TetCorner> star, bool aside);
  std::optional<WorldPoint> find_aside(const WorldPoint& ahead,
                                       const InterfaceProjector::Levels& levels);
  std::optional<double> cost_at(const std::optional<WorldPoint>& place) noexcept;

  const TetMesh& mesh_;
  const LabelledSpace& space_;
  const MeshView before_;  // where vertices were at first
  AngleGoal goal_;
  AngleRange limit_;  // no star need be better than this
  InterfaceProjector projector_;
  Star star_;

  // These belong to the vertex that is brought nearer.
  WorldPoint home_;
  StarBound bound_;
};

}  // namespace tet
