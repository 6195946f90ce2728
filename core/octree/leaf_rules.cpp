#include "core/octree/leaf_rules.h"

#include <algorithm>

namespace tet {

BrickBox box_around(const std::vector<BrickBox>& boxes) {
  BrickBox all = boxes.front();
  for (const auto& [min, max] : boxes) {
    all.min = {std::min(all.min.x, min.x), std::min(all.min.y, min.y),
               std::min(all.min.z, min.z)};
    all.max = {std::max(all.max.x, max.x), std::max(all.max.y, max.y),
               std::max(all.max.z, max.z)};
  }
  return all;
}

}  // namespace tet
