#include "core/triangle_files/surface_file.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/posix/check_file.h"

namespace tet {
namespace {

using Reader = absl::StatusOr<TriangleSurface> (*)(std::string_view);

/// The reader for a path's ending, or null.
Reader reader_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".obj") return read_obj;
  if (ending == ".stl") return read_stl;
  if (ending == ".ply") return read_ply;
  return nullptr;
}

absl::StatusOr<std::string> read_bytes(const std::string& path) {
  if (absl::Status s = check_file(path); !s.ok()) return s;
  std::ifstream file(path, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(std::filesystem::file_size(path)), '\0');
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    return absl::InvalidArgumentError(absl::StrFormat("'%s' cannot be read", path));
  }
  return bytes;
}

}  // namespace

absl::StatusOr<TriangleSurface> read_surface(const std::string& path) {
  const Reader reader = reader_of(path);
  if (reader == nullptr) {
    return absl::InvalidArgumentError(
        absl::StrFormat("'%s' does not end in .obj, .stl or .ply", path));
  }
  const absl::StatusOr<std::string> bytes = read_bytes(path);
  if (!bytes.ok()) return bytes.status();
  absl::StatusOr<TriangleSurface> surface = reader(*bytes);
  if (surface.ok()) return surface;
  return absl::Status(surface.status().code(),
                      absl::StrCat("'", path, "': ", surface.status().message()));
}

}  // namespace tet
