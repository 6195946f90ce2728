// Pieces of a mesh's surface that a request gives names of their own.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/types.h"

namespace tet {

/// Faces of the surface that meet every condition that is set; world units. Where a face lies
/// is told by the middle of its vertices, and borders belong to a region.
struct FaceRegion {
  struct Ball {
    WorldPoint centre;
    double radius = 0;
  };
  /// All that is within `radius` of the segment, up to the planes across its ends.
  struct Cylinder {
    WorldPoint start, end;
    double radius = 0;
  };
  /// All points p with dot(normal, p) <= offset * length(normal).
  struct HalfSpace {
    WorldPoint normal;
    double offset = 0;
  };
  /// Outward normals that are at most so far from a direction.
  struct Facing {
    WorldPoint direction;
    double angle_deg = 0;
  };

  /// Divided where the surface turns by more than an angle: see crease_patches.h.
  struct Creases {
    double angle_deg = 0;
    friend bool operator==(const Creases&, const Creases&) = default;
  };

  std::string name;  ///< regions with the same name are one
  std::optional<WorldBox> box = {};
  std::optional<Ball> ball = {};
  std::optional<Cylinder> cylinder = {};
  std::optional<HalfSpace> half_space = {};
  /// All that is nearer to one of these than to those of every other region; none is no
  /// condition.
  std::vector<WorldPoint> nearest = {};
  std::optional<Facing> facing = {};
  std::string node = {};  ///< of the scene, whose primitives or grids made the faces; or empty

  /// No condition of a face, but what becomes of all that are in the region.
  std::optional<Creases> creases = {};

  static constexpr std::size_t kMaxRegions = 256;
  static constexpr std::size_t kMaxPoints = 1024;  ///< of all regions' `nearest` together
  static constexpr std::size_t kMaxNameBytes = 100;

  /// Without any the region has all faces that no region before it has.
  bool has_condition() const noexcept {
    return box || ball || cylinder || half_space || !nearest.empty() || facing || !node.empty();
  }
};

/// Whether faces of a region are divided at creases.
bool have_creases(std::span<const FaceRegion> regions) noexcept;

/// The names of regions, each once, in the order in which they come first.
std::vector<std::string> region_names(std::span<const FaceRegion> regions);

}  // namespace tet
