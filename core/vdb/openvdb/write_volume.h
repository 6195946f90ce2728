// A volume to a .vdb file.
#pragma once

#include <string>

#include <absl/status/status.h>

#include "core/volume/volume.h"

namespace tet {

/// Writes all of a volume as one float grid, whole and on disk or not at all: load_volume makes
/// the same volume of it. Errors: kUnavailable (the file cannot be written).
absl::Status write_volume(const Volume& volume, const std::string& path);

}  // namespace tet
