// What each label of a segmentation's mesh has.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/tet_mesh.h"

namespace tet {

struct MeasuredLabel {
  std::uint64_t tets = 0;
  double volume = 0;  ///< world units cubed
};

/// By the labels' numbers; empty of a mesh without labels. One value for any machine.
std::vector<MeasuredLabel> measure_labels(const TetMesh& mesh);

/// How many pieces each label has that have no vertex in common, by the labels' numbers. Takes
/// several times as long.
std::vector<std::uint64_t> count_label_parts(const TetMesh& mesh);

}  // namespace tet
