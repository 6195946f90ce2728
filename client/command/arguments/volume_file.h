// Files of volumes by their endings: grids of OpenVDB, and images.
#pragma once

#include <string>

namespace tet {

/// Whether it is one, by its ending in letters of any case; what it holds its bytes say.
bool is_volume_file(const std::string& path);

/// Endings, as messages and --help list them.
inline constexpr const char* kVolumeEndings =
    ".vdb, .nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd, .vti, .npy";

}  // namespace tet
