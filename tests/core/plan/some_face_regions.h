// Regions of faces as tests ask for them.
#pragma once

#include <string>
#include <utility>

#include "core/mesh/face_regions.h"

namespace tet {

inline FaceRegion in_box(std::string name, const WorldPoint& min, const WorldPoint& max) {
  FaceRegion region{std::move(name)};
  region.box = {min, max};
  return region;
}

inline FaceRegion of_node(std::string name, std::string node) {
  FaceRegion region{std::move(name)};
  region.node = std::move(node);
  return region;
}

/// All faces that are left, in patches between creases.
inline FaceRegion divided(std::string name, double angle_deg) {
  FaceRegion region{std::move(name)};
  region.creases = {angle_deg};
  return region;
}

}  // namespace tet
