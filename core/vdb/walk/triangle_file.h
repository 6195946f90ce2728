// Files of triangles, where a .vdb file could be: what making a grid of one takes, by its size.
#pragma once

#include <chrono>
#include <cstdint>

#include <absl/status/statusor.h>

#include "core/vdb/walk/charge_file.h"

namespace tet {

/// Voxels near a surface, at most, that the grid of a file has where walls are thin.
inline constexpr double kMostFileBandVoxels = 2e6;

/// Pieces that a surface which overlaps itself is cut into, at most: four to ten for each voxel
/// along it.
inline constexpr std::uint64_t kMostFilePieces = 2'500'000;

/// What a processor may work on a solid that overlaps itself wherever it can, beside the time
/// that any file of its size gets: three times what it takes here.
inline constexpr std::chrono::seconds kConvertingTime{90};

/// By the file's first bytes and its size.
bool holds_triangles(const OpenGridFile& file);

/// What making a grid of the file takes, and listing it: its grid is made for that, too.
/// Errors: those of check_memory, told of the file.
absl::StatusOr<MemoryCharge> charge_triangles(const OpenGridFile& file,
                                              std::uint64_t max_volume_bytes,
                                              std::uint64_t max_reading_bytes);

/// Puts the file in front of what is wrong with it.
absl::Status told_of_triangles(const OpenGridFile& file, const absl::Status& why);

}  // namespace tet
