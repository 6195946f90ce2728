// What the three readers of surface files share: words, numbers, triangles and their checks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/surface/triangle_surface.h"

namespace tet {

/// The lines of a text, one after the other, with their numbers (from 1).
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  /// Moves to the next line; false at the end. Line ends are \n, \r\n or \r.
  bool next();
  std::string_view line() const noexcept { return line_; }
  std::size_t number() const noexcept { return number_; }
  /// What ended the current line; empty at the end of the text.
  std::string_view line_end() const noexcept { return line_end_; }
  /// What follows the current line.
  std::string_view rest() const noexcept { return rest_; }

 private:
  std::string_view rest_, line_, line_end_;
  std::size_t number_ = 0;
};

/// The text behind a byte order mark of UTF-8, if it begins with one.
std::string_view without_byte_order_mark(std::string_view text);

/// Errors: kInvalidArgument where it begins with a byte order mark of UTF-16.
absl::Status check_not_utf16(std::string_view text);

/// Takes the next word off the front of `text`; empty when there is none.
std::string_view take_word(std::string_view& text);

/// "line 12: why"
absl::Status line_error(std::size_t line, std::string_view why);

/// The whole word as a number, which may be infinite or none. What is too small for a double
/// is 0.
bool parse_any_number(std::string_view word, double& value);
/// The whole word as a finite number.
bool parse_number(std::string_view word, double& value);
bool parse_number(std::string_view word, std::int64_t& value);

/// Takes three finite numbers off the front of `text`.
bool take_point(std::string_view& text, WorldPoint& point);

/// Adds a polygon as triangles, by ears that are cut off it; as a fan around its first corner
/// where it names vertices that there are not. `spare_looks` is of all polygons of a file: see
/// triangulate_polygon.
void add_polygon(std::span<const std::uint32_t> corners,
                 TriangleSurface& surface,
                 std::uint64_t& spare_looks);

/// The surface, or why it is none: no triangles, too many vertices.
absl::StatusOr<TriangleSurface> checked(TriangleSurface surface);

}  // namespace tet
