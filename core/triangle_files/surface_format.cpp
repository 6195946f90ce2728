#include "core/triangle_files/surface_format.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <absl/status/status.h>

#include "core/triangle_files/surface_file.h"
#include "core/triangle_files/surface_reading.h"

namespace tet {
namespace {

constexpr std::size_t kStlHeaderBytes = 84, kStlTriangleBytes = 50;

bool is_binary_stl(std::string_view head, std::uint64_t file_bytes) noexcept {
  if (head.size() < kStlHeaderBytes) return false;
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, head.data() + kStlHeaderBytes - sizeof(triangles), sizeof(triangles));
  return triangles > 0 && file_bytes == kStlHeaderBytes + triangles * kStlTriangleBytes;
}

/// The first line that is neither blank nor a comment, as far as it lies in `text`.
std::string_view first_statement(std::string_view text) {
  LineReader lines(text);
  while (lines.next()) {
    std::string_view words = lines.line();
    const std::string_view word = take_word(words);
    if (!word.empty() && !word.starts_with('#')) return lines.line();
  }
  return {};
}

bool has_only_text(std::string_view head) noexcept {
  return head.find('\0') == std::string_view::npos;
}

bool begins_obj(std::string_view statement) {
  constexpr std::array<std::string_view, 11> kKeywords{"v", "vn", "vt",     "vp",     "f", "o",
                                                       "g", "s",  "mtllib", "usemtl", "l"};
  const std::string_view word = take_word(statement);
  return std::ranges::find(kKeywords, word) != kKeywords.end() && !statement.empty();
}

}  // namespace

SurfaceFormat surface_format(std::string_view head, std::uint64_t file_bytes) noexcept {
  if (is_binary_stl(head, file_bytes)) return SurfaceFormat::kStl;
  if (!head.starts_with("ply") && !has_only_text(head)) return SurfaceFormat::kNone;
  std::string_view statement = first_statement(without_byte_order_mark(head));
  if (begins_obj(statement)) return SurfaceFormat::kObj;
  const std::string_view word = take_word(statement);
  if (word == "solid") return SurfaceFormat::kStl;
  return word == "ply" && take_word(statement).empty() ? SurfaceFormat::kPly
                                                       : SurfaceFormat::kNone;
}

absl::StatusOr<TriangleSurface> read_surface_bytes(std::string_view bytes) {
  switch (surface_format(bytes.substr(0, kSurfaceMagicBytes), bytes.size())) {
    case SurfaceFormat::kObj:
      return read_obj(bytes);
    case SurfaceFormat::kStl:
      return read_stl(bytes);
    case SurfaceFormat::kPly:
      return read_ply(bytes);
    case SurfaceFormat::kNone:
      break;
  }
  return absl::InvalidArgumentError("it is no OBJ, STL or PLY file");
}

}  // namespace tet
