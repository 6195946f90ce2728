// Moving points onto the interfaces, curves and points where labels meet.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "core/base/tet_geometry.h"
#include "core/base/types.h"
#include "core/labels/interface_probe.h"
#include "core/labels/label.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/tet_mesh.h"
#include "core/volume/to_voxel.h"

namespace tet {

/// Where some labels meet, as stored positions see it. Not thread-safe: one per task.
class InterfaceProjector {
 public:
  /// A projected point is so near to where it should be; spacings.
  static constexpr double kTolerance = 1e-4;

  InterfaceProjector(std::unique_ptr<InterfaceProbe> probe,
                     const LatticeToWorld& to_world,
                     const MeshHeader& mesh);

  /// What the functions of the labels are at a point.
  using Levels = std::array<double, kMostMeeting - 1>;

  /// From now on points are put where labels, ascending, meet near `p`: on a surface for two of
  /// them, a curve for three, a point for four. False where that is not known, or too nearly
  /// degenerate to be told.
  bool enter(std::span<const Label> labels, const WorldPoint& p);

  /// What the functions are at the point that was entered with; 0 where the labels meet.
  const Levels& levels() const noexcept { return levels_; }

  /// The part of a way that leads along where the labels meet, at the point of entry.
  Vector along(const Vector& way) const noexcept;
  /// Directions that span those ways: 3 less the number of functions; each of length 1.
  std::span<const Vector> tangents() const noexcept {
    return std::span(axes_).subspan(functions_, 3 - functions_);
  }

  /// The point near `p` where the functions have `levels`, by steps of least length, as it
  /// would be stored; nothing where few steps do not lead there.
  std::optional<WorldPoint> project(const WorldPoint& p, const Levels& levels);

  /// Rounds a position as the mesh would store it.
  WorldPoint rounded(const WorldPoint& p) const noexcept;
  WorldPoint lattice_of(const WorldPoint& stored) const noexcept;

 private:
  struct Slopes {
    std::array<ValueSlope, kMostMeeting - 1> of;
  };
  Slopes slopes_at(const WorldPoint& lattice);
  std::optional<Vector> step_to(const Slopes& here, const Levels& levels) const noexcept;
  bool find_axes(const Slopes& here) noexcept;
  WorldPoint stored_of(const WorldPoint& lattice) const noexcept;

  const std::unique_ptr<InterfaceProbe> probe_;
  const LatticeToWorld to_world_;
  const InverseLinear to_lattice_;  // of stored positions
  double per_divisor_;              // 1 / to_lattice_.divisor
  bool floats_;

  // These belong to what was entered.
  std::size_t functions_ = 0;
  Levels levels_{};
  std::array<Vector, 3> axes_{};  // across where the labels meet, and then along it
};

}  // namespace tet
