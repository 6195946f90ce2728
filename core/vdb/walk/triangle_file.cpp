#include "core/vdb/walk/triangle_file.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <absl/strings/str_format.h>

#include "core/base/posix/byte_source.h"
#include "core/triangle_files/surface_format.h"

namespace tet {
namespace {

/// Bricks along a surface are filled to a third or a half by the band around it.
constexpr double kVolumeBytesPerBandVoxel = 16;
/// Distances, the triangles that they are to, OpenVDB's trees of both, and the volume.
constexpr double kReadingBytesPerBandVoxel = 80;
/// Pieces of surfaces that overlap: as they are cut, and as a surface.
constexpr std::uint64_t kPieceBytes = 160 * kMostFilePieces;
/// A triangle takes 50 bytes of a binary file, and of text hardly less than 12: as it is read,
/// in voxels, mended, and in the tree of winding numbers.
constexpr std::uint64_t kBytesPerFileByte = 32;

}  // namespace

bool holds_triangles(const OpenGridFile& file) {
  const auto bytes = static_cast<std::uint64_t>(file.size_bytes);
  std::vector<std::byte> buffer;
  const auto window = ByteSource(file.descriptor, bytes).window(0, kSurfaceMagicBytes, buffer);
  const std::string_view head(reinterpret_cast<const char*>(window.data()),
                              std::min(window.size(), kSurfaceMagicBytes));
  return surface_format(head, bytes) != SurfaceFormat::kNone;
}

absl::Status told_of_triangles(const OpenGridFile& file, const absl::Status& why) {
  const bool broken = absl::IsInvalidArgument(why);
  return {why.code(), absl::StrFormat("'%s'%s: %s", file.name, broken ? " makes no solid" : "",
                                      std::string(why.message()))};
}

absl::StatusOr<MemoryCharge> charge_triangles(const OpenGridFile& file,
                                              std::uint64_t max_volume_bytes,
                                              std::uint64_t max_reading_bytes) {
  MemoryCharge charge;
  charge.volume = static_cast<std::uint64_t>(kVolumeBytesPerBandVoxel * kMostFileBandVoxels);
  charge.reading = static_cast<std::uint64_t>(kReadingBytesPerBandVoxel * kMostFileBandVoxels) +
                   kPieceBytes +
                   kBytesPerFileByte * static_cast<std::uint64_t>(file.size_bytes);
  const absl::Status fits = check_memory(charge, max_volume_bytes, max_reading_bytes);
  return fits.ok() ? absl::StatusOr<MemoryCharge>(charge) : told_of_triangles(file, fits);
}

}  // namespace tet
