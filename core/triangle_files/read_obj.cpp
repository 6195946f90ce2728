#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include <absl/strings/str_format.h>

#include "core/surface/triangulate_polygon.h"
#include "core/triangle_files/surface_file.h"
#include "core/triangle_files/surface_reading.h"

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

/// What was read of a file so far, and room for a face's corners.
struct ObjParts {
  TriangleSurface surface;
  std::vector<std::uint32_t> corners;
  std::uint64_t spare_looks = kSpareLooks;
};

absl::Status read_face(std::string_view words, ObjParts& parts) {
  std::vector<std::uint32_t>& corners = parts.corners;
  corners.clear();
  for (std::string_view word = take_word(words); !word.empty(); word = take_word(words)) {
    if (word.starts_with('#')) break;
    const absl::StatusOr<std::uint32_t> corner =
        parse_corner(word, parts.surface.vertices.size());
    if (!corner.ok()) return corner.status();
    corners.push_back(*corner);
  }
  if (corners.size() < 3) {
    return absl::InvalidArgumentError(
        absl::StrFormat("a face has %d corners; it needs three", corners.size()));
  }
  add_polygon(corners, parts.surface, parts.spare_looks);
  return absl::OkStatus();
}

/// Whether the next line goes on with this one: of a vertex or a face. A comment or a name may
/// end in a backslash, as paths do, and must not take the next vertex with it.
bool goes_on(std::string_view line) {
  if (!line.ends_with('\\') || line.find('#') != std::string_view::npos) return false;
  const std::string_view keyword = take_word(line);
  return keyword == "v" || keyword == "f" || keyword == "fo";
}

/// The statements of a text: lines, put together where a backslash ends one.
class StatementReader {
 public:
  explicit StatementReader(std::string_view text) : lines_(text) {}

  bool next() {
    if (!lines_.next()) return false;
    number_ = lines_.number();
    statement_ = lines_.line();
    if (goes_on(statement_)) join();
    return true;
  }
  std::string_view statement() const noexcept { return statement_; }
  std::size_t number() const noexcept { return number_; }  ///< of its first line

 private:
  void join() {
    joined_.clear();
    bool more = true;
    while (more) {
      std::string_view line = lines_.line();
      more = line.ends_with('\\');
      if (more) line.remove_suffix(1);
      joined_.append(line).push_back(' ');
      more = more && lines_.next();
    }
    statement_ = joined_;
  }

  LineReader lines_;
  std::string_view statement_;
  std::string joined_;
  std::size_t number_ = 0;
};

/// Surfaces that are no polygons, and files within files: to leave them out would leave holes.
bool is_unreadable(std::string_view keyword) {
  constexpr std::array<std::string_view, 5> kUnreadable{"surf", "bzp", "bsp", "cdp", "call"};
  return std::ranges::find(kUnreadable, keyword) != kUnreadable.end();
}

absl::Status read_statement(std::string_view words, ObjParts& parts) {
  const std::string_view keyword = take_word(words);
  // "fo" is a face of version 2.
  if (keyword == "f" || keyword == "fo") return read_face(words, parts);
  if (is_unreadable(keyword)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "'%s' cannot be read, only polygons: export the surface as polygons", keyword));
  }
  if (keyword != "v") return absl::OkStatus();
  WorldPoint point;
  if (!take_point(words, point)) {
    return absl::InvalidArgumentError("a vertex needs three finite numbers");
  }
  parts.surface.vertices.push_back(point);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<TriangleSurface> read_obj(std::string_view text) {
  if (absl::Status s = check_not_utf16(text); !s.ok()) return s;
  ObjParts parts;
  StatementReader statements(without_byte_order_mark(text));
  while (statements.next()) {
    const absl::Status status = read_statement(statements.statement(), parts);
    if (!status.ok()) return line_error(statements.number(), std::string(status.message()));
  }
  return checked(std::move(parts.surface));
}

}  // namespace tet
