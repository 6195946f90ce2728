#include "core/mesh/face_regions.h"

#include <algorithm>

namespace tet {

bool have_creases(std::span<const FaceRegion> regions) noexcept {
  return std::ranges::any_of(
      regions, [](const FaceRegion& region) { return region.creases.has_value(); });
}

std::vector<std::string> region_names(std::span<const FaceRegion> regions) {
  std::vector<std::string> names;
  for (const FaceRegion& region : regions) {
    if (std::ranges::find(names, region.name) == names.end()) names.push_back(region.name);
  }
  return names;
}

}  // namespace tet
