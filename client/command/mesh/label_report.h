// What became of each label of a segmentation.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "client/command/mesh/mesh_maker.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"

namespace tet {

/// `7`, or `7 (bone)`.
std::string title_of(const MeshLabel& label);

/// The volumes of the voxels of a segmentation's labels, by their numbers in the mesh.
std::vector<double> voxel_volumes_of(const Shape& shape, const MeshRequest& request);

/// For each label value, name, tets, volume, parts, and voxel_volume where that is known.
nlohmann::ordered_json labels_json(const MadeMesh& made);

/// What labels are those of.
enum class LabelOrigin {
  kVoxels,  ///< which are smoothed
  kSolids,  ///< which compete with each other
};

/// What to tell of labels that the mesh has not, or has less than half of; empty where all is
/// well, and of a mesh that a box cuts. A line for each of the first few.
std::string lost_labels_warning(const MadeMesh& made, LabelOrigin origin);

}  // namespace tet
