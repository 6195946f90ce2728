// Where labels meet, at any point of the lattice and not at its nodes alone.
#pragma once

#include <cstddef>
#include <span>

#include "core/base/types.h"
#include "core/labels/label.h"
#include "core/volume/trilinear_cell.h"

namespace tet {

/// Four labels meet in points, and more only where something is degenerate.
inline constexpr std::size_t kMostMeeting = 4;

/// Functions that vanish where labels meet. What they say of a point depends on the point and
/// on what was chosen. Points are in units of the spacing. Not thread-safe: one per task.
class InterfaceProbe {
 public:
  virtual ~InterfaceProbe() = default;

  /// How far from `near` functions may be asked for, spacings.
  static constexpr double kReach = 1.5;

  /// Chooses 2 to kMostMeeting labels, ascending, that meet near a point. There are as many
  /// functions as labels but one, and where all of them vanish all of the labels meet. False
  /// where nothing is known of these labels.
  virtual bool choose(std::span<const Label> labels, const WorldPoint& near) = 0;

  /// Writes the functions' values and slopes.
  virtual void at(const WorldPoint& p, std::span<ValueSlope> out) = 0;
};

}  // namespace tet
