// Whether the labels of tets that somebody sent are labels.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>

#include "core/mesh/tet_mesh.h"

namespace tet {

/// Whether every number of a column of regions is that of a label, where the mesh has labels.
inline bool labels_are_within(std::span<const std::byte> regions,
                              const MeshHeader& header) noexcept {
  if (header.labels.empty()) return true;
  LabelNumber largest = 0;
  for (std::size_t i = 0; i + sizeof(LabelNumber) <= regions.size(); i += sizeof(LabelNumber)) {
    LabelNumber label = 0;
    std::memcpy(&label, regions.data() + i, sizeof(label));
    largest = std::max(largest, label);
  }
  return regions.empty() || largest < header.labels.size();
}

}  // namespace tet
