// Regions of the surface as options: where each lies, or a JSON file of them.
#pragma once

#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/mesh/face_regions.h"

namespace tet {

/// What the commands say of `--face`, and how it is written.
inline constexpr const char* kFaceHelp =
    "Name for a piece of the surface, and where it lies: box:X0,Y0,Z0,X1,Y1,Z1, ball:X,Y,Z,R, "
    "cylinder:X0,Y0,Z0,X1,Y1,Z1,R, halfspace:NX,NY,NZ,OFFSET, nearest:X,Y,Z,..., "
    "facing:X,Y,Z,DEGREES or node:NAME, several with / between, and creases:DEGREES to divide "
    "it into patches; or a JSON file of such regions; may be repeated, the first that fits "
    "counts: docs/faces.md";
inline constexpr const char* kFaceType = "NAME=PLACE";

/// Whether an option is the path of a file of regions.
bool is_file_of_faces(const std::string& option);

/// The regions of all options, in their order. Errors: kInvalidArgument (as --face: why),
/// kNotFound (a file).
absl::StatusOr<std::vector<FaceRegion>> understand_faces(
    const std::vector<std::string>& options);

}  // namespace tet
