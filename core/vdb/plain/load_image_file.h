// Images of files in, where load.h reads grids of .vdb files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/vdb/plain/load_limits.h"
#include "core/vdb/walk/charge_file.h"
#include "core/volume/grid_info.h"
#include "core/volume/label_volume.h"
#include "core/volume/volume.h"

namespace tet {

/// Errors of all three: those of core/image/load_image.h, told of the file.
absl::StatusOr<std::vector<GridInfo>> list_image_file(const OpenGridFile& file);
absl::StatusOr<Volume> load_image_file(const OpenGridFile& file,
                                       const std::string& name,
                                       GridUse use,
                                       std::uint32_t component,
                                       const LoadLimits& limits);
absl::StatusOr<LabelVolume> load_label_file(const OpenGridFile& file,
                                            const std::string& name,
                                            const LoadLimits& limits);

}  // namespace tet
