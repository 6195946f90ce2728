// Whether the regions of a surface that a request names are sound.
#pragma once

#include <span>
#include <string>

#include <absl/status/status.h>

#include "core/mesh/face_regions.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// The regions' field in a request: what refusals begin with.
inline constexpr char kFaceRegionsField[] = "face_regions";

/// OK or kInvalidArgument; the message begins with the field that is wrong, as
/// `face_regions[3].ball.radius`, and says its value and what it may be.
absl::Status check_face_regions(std::span<const FaceRegion> regions);

/// Whether each of their nodes is one of these, the scene's; a grid has none. Error: as above.
absl::Status check_face_nodes(std::span<const FaceRegion> regions,
                              std::span<const std::string> nodes);

/// Whether all labels of a mesh of several grids, whose faces have regions, can be: there are
/// not too many, and no two are alike. Error: as above.
absl::Status check_part_labels(const MeshHeader& header);

}  // namespace tet
