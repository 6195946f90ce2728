// The faces of a segmentation's mesh by the labels on their two sides.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/mesh/find_faces.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// The names of labels, no two alike: as they are given, `label_7` of one that has none, and of
/// those that share a name with their values, `bone_7`.
std::vector<std::string> distinct_names(std::span<const MeshLabel> labels);

/// Labels of faces by what lies on both sides: `bone_surface` where a label ends, `bone_marrow`
/// where two meet, the lower value first. More pairs than a mesh has labels of faces for are
/// told apart as `surface` and `interface` alone. `faces` belong to the tet with the lower one.
/// Parallel; once `cancellation` is requested it ends soon, and what it returns means nothing.
FoundFaces faces_between_labels(const TetMesh& mesh,
                                std::vector<TetFace> faces,
                                const Cancellation& cancellation);

}  // namespace tet
