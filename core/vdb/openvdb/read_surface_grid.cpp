#include <string>
#include <string_view>
#include <vector>

#include <absl/strings/str_cat.h>

#include "core/base/posix/byte_source.h"
#include "core/surface/default_voxel.h"
#include "core/triangle_files/surface_format.h"
#include "core/vdb/openvdb/surface_grid.h"
#include "core/vdb/walk/triangle_file.h"

namespace tet {
namespace {

absl::StatusOr<TriangleSurface> read_triangles(const OpenGridFile& file) {
  const auto bytes = static_cast<std::uint64_t>(file.size_bytes);
  std::vector<std::byte> buffer;
  const auto all = ByteSource(file.descriptor, bytes).window(0, bytes, buffer);
  if (all.size() < bytes) return absl::InvalidArgumentError("it cannot be read to its end");
  return read_surface_bytes({reinterpret_cast<const char*>(all.data()), bytes});
}

/// Who hands over a file has no say in what becomes of its holes.
absl::Status with_remedy(const absl::Status& status) {
  if (!absl::IsFailedPrecondition(status)) return status;
  return {status.code(), absl::StrCat(status.message(),
                                      ". `tetstream convert` makes a grid of it with these")};
}

}  // namespace

absl::StatusOr<openvdb::FloatGrid::Ptr> read_surface_grid(const OpenGridFile& file) {
  const absl::StatusOr<TriangleSurface> surface = read_triangles(file);
  if (!surface.ok()) return told_of_triangles(file, surface.status());
  auto grid = surface_to_grid(*surface, default_voxel(*surface, kMostFileBandVoxels),
                              OpenSurface::kRefuse, kMostFilePieces);
  if (!grid.ok()) return told_of_triangles(file, with_remedy(grid.status()));
  return grid;
}

}  // namespace tet
