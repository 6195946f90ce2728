#include "core/surface/default_voxel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/surface/orient_surface.h"

namespace tet {
namespace {

constexpr double kVoxelsAlongLongestExtent = 128;
constexpr double kVoxelsAcrossWalls = 2.5;

/// Voxels across the band around a surface.
constexpr double kBandVoxels = 7;

/// Looks at the triangles alone: files of modellers have loose vertices anywhere, which none
/// names.
double longest_extent(const TriangleSurface& surface) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  WorldPoint low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (const auto& triangle : surface.triangles) {
    for (const std::uint32_t corner : triangle) {
      const WorldPoint& p = surface.vertices[corner];
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

/// A plate of a surface's area, on both sides of it, and volume.
struct PlateLike {
  double area = 0;
  double thickness = 0;  ///< 0 of a surface that encloses nothing
};

PlateLike plate_of(const TriangleSurface& surface) {
  PlateLike plate;
  if (surface.triangles.empty()) return plate;
  double six = 0;
  for (const auto& t : surface.triangles) {
    six += six_volume(surface, t, surface.vertices[surface.triangles[0][0]]);
    plate.area += twice_area(surface, t) / 2;
  }
  if (plate.area > 0) plate.thickness = std::abs(six / 3 / plate.area);
  return plate;
}

}  // namespace

double default_voxel(const TriangleSurface& surface, double most_band_voxels) {
  const double voxel = longest_extent(surface) / kVoxelsAlongLongestExtent;
  const PlateLike plate = plate_of(surface);
  if (!(plate.thickness > 0)) return voxel;
  const double least = std::sqrt(kBandVoxels * plate.area / most_band_voxels);
  return std::min(voxel, std::max(plate.thickness / kVoxelsAcrossWalls, least));
}

}  // namespace tet
