// How large leaves may be, as a caller asks for it.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <absl/status/status.h>

#include "core/base/types.h"
#include "core/volume/volume.h"

namespace tet {

struct BallRegion {
  WorldPoint centre;
  double radius = 0;
};
/// All that is within `radius` of the segment.
struct CapsuleRegion {
  WorldPoint start, end;
  double radius = 0;
};
/// All that is within `depth` of the surface.
struct ShellRegion {
  double depth = 0;
};

/// A leaf that reaches into the region has edges of `size` at most; world units.
struct SizingRegion {
  double size = 0;
  std::variant<std::monostate, WorldBox, BallRegion, CapsuleRegion, ShellRegion> shape = {};
};

/// A leaf is at most as long as the smallest positive value, world units, of the voxels that it
/// reaches into; values below the spacing count as it.
struct SizingGrid {
  std::string file = {};  ///< for whoever loads it; empty: that of the grid that is meshed
  std::string name = {};  ///< within the file; empty: its only one
  std::shared_ptr<const Volume> volume = nullptr;  ///< loaded before anything is meshed
};

/// Sizes of leaves; at the surface all are finest unless it is graded. Lengths are world units.
struct Sizing {
  std::optional<double> coarsest = {};  ///< of any leaf
  /// A leaf whose middle lies d from the surface is at most spacing + growth * d long, and one
  /// that lies d from a smaller leaf at most about growth * d longer.
  double growth = 1;
  std::vector<SizingRegion> regions = {};
  std::optional<SizingGrid> grid = {};
  /// Leaves at the surface are as large as the rest of this lets them be; it needs `coarsest`.
  bool grade_surface = false;
  /// An edge as long as a leaf at the surface departs from it by at most this.
  std::optional<double> chord_error = {};
  int leaves_across = 0;  ///< walls are at least so many leaves thick; 0: any

  static constexpr int kMaxLeavesAcross = 64;
  static constexpr std::size_t kMaxRegions = 256;
  static constexpr double kMinGrowth = 0.0625;

  /// True when the surface's shape decides how large leaves are.
  bool sizes_surface() const noexcept { return chord_error || leaves_across > 0; }
  bool any() const noexcept {
    return coarsest || growth != 1 || !regions.empty() || grid || grade_surface ||
           sizes_surface();
  }
};

/// A sizing's field in a request: what refusals begin with.
inline constexpr char kSizingField[] = "sizing";

// Both are OK or kInvalidArgument, and the message begins with the field that is wrong, as
// `regions[3].ball.radius`, and says its value and what it may be.

absl::Status check_sizing(const Sizing& sizing);

/// What is finer than the finest leaves.
absl::Status check_sizing(const Sizing& sizing, double spacing);

/// The level of the largest leaves that are not longer than `size`, at most `max_levels`.
int level_of_size(double size, double spacing, int max_levels) noexcept;

}  // namespace tet
