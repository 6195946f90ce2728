#include <absl/strings/str_format.h>

#include "core/files/surface_file.h"
#include "core/files/surface_reading.h"

namespace tet {
namespace {

/// "12", "12/5", "12//7" or "12/5/7" to the id of vertex 12; negative numbers count back from
/// the vertex read last.
absl::StatusOr<std::uint32_t> parse_corner(std::string_view word, std::size_t vertices) {
  std::int64_t index = 0;
  if (!parse_number(word.substr(0, word.find('/')), index)) {
    return absl::InvalidArgumentError(absl::StrFormat("'%s' is not a corner of a face", word));
  }
  const auto count = static_cast<std::int64_t>(vertices);
  if (index == 0 || index > count || index < -count) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "the face names vertex %d, but there are %d before it", index, vertices));
  }
  return static_cast<std::uint32_t>(index > 0 ? index - 1 : count + index);
}

absl::Status read_face(std::string_view words,
                       std::vector<std::uint32_t>& corners,
                       TriangleSurface& surface) {
  corners.clear();
  for (std::string_view word = take_word(words); !word.empty(); word = take_word(words)) {
    if (word.starts_with('#')) break;
    const absl::StatusOr<std::uint32_t> corner = parse_corner(word, surface.vertices.size());
    if (!corner.ok()) return corner.status();
    corners.push_back(*corner);
  }
  if (corners.size() < 3) {
    return absl::InvalidArgumentError(
        absl::StrFormat("a face has %d corners; it needs three", corners.size()));
  }
  add_polygon(corners, surface);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<TriangleSurface> read_obj(std::string_view text) {
  TriangleSurface surface;
  std::vector<std::uint32_t> corners;
  LineReader lines(text);
  while (lines.next()) {
    std::string_view words = lines.line();
    const std::string_view keyword = take_word(words);
    if (keyword == "v") {
      WorldPoint point;
      if (!take_point(words, point)) {
        return line_error(lines.number(), "a vertex needs three finite numbers");
      }
      surface.vertices.push_back(point);
    } else if (keyword == "f") {
      const absl::Status status = read_face(words, corners, surface);
      if (!status.ok()) return line_error(lines.number(), std::string(status.message()));
    }
  }
  return checked(std::move(surface));
}

}  // namespace tet
