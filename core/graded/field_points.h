// phi at many lattice points at once.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/cancel.h"
#include "core/field/phi_field.h"
#include "core/lattice/bcc.h"
#include "core/scene/scene_evaluator.h"

namespace tet {

/// Up to kSize points, in finest spacings, as columns.
struct FieldPoints {
  static constexpr std::size_t kSize = 128;
  alignas(64) std::array<double, kSize> x, y, z;
};

/// A box around nodes, in doubled finest spacings.
class NodeBounds {
 public:
  void add(LatticeCoord node) noexcept;
  /// Finest spacings.
  WorldPoint middle() const noexcept;
  double half_edge() const noexcept;  ///< of the cube around it

 private:
  std::array<double, 3> min_{}, max_{};
  bool empty_ = true;
};

/// Asks a field for phi at points. A point's phi depends on it alone. Not thread-safe: one per
/// task.
class LatticeSampler {
 public:
  /// Both must outlive it. What it says is made up once a look found it cancelled.
  LatticeSampler(const PhiField& field, const Cancellation& cancellation) : sampler_(field) {
    sampler_.stop_when(cancellation);
  }

  /// Has a scene evaluate only what matters within `bounds`: all points until the next focus
  /// lie there.
  void focus(const NodeBounds& bounds) noexcept;

  /// Exactly what the field says, before it is stored as a float.
  void sample(const FieldPoints& points, std::size_t count, double* phi) noexcept;

 private:
  PhiSampler sampler_;
};

}  // namespace tet
