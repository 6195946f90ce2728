// Files with images, where a .vdb file could be: what reading one takes, by its header.
#pragma once

#include <cstdint>
#include <string>

#include <absl/status/statusor.h>

#include "core/vdb/walk/charge_file.h"

namespace tet {

/// By the file's first bytes.
bool holds_image(const OpenGridFile& file);

/// What listing an image's arrays takes, or reading one of them. Errors: those of outline_image
/// and check_memory, told of the file.
absl::StatusOr<MemoryCharge> charge_image(const OpenGridFile& file,
                                          bool lists,
                                          std::uint64_t max_volume_bytes,
                                          std::uint64_t max_reading_bytes);

/// Puts the file in front of what is wrong with it.
absl::Status told_of_image(const OpenGridFile& file, const absl::Status& why);

}  // namespace tet
