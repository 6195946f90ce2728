#include "core/triangle_files/surface_reading.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include <absl/strings/str_format.h>

#include "core/surface/triangulate_polygon.h"

namespace tet {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

template <class Number>
std::errc parse_whole(std::string_view word, Number& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  return stop == end ? error : std::errc::invalid_argument;
}

/// Tells, of a number that no double can hold, that it is too small.
bool is_tiny(std::string_view word) {
  const std::size_t exponent = word.find_first_of("eE");
  return exponent != std::string_view::npos && word.substr(exponent + 1).starts_with('-');
}

}  // namespace

bool LineReader::next() {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(end);
  line_end_ = rest_.substr(0, rest_.starts_with("\r\n") ? 2 : 1);
  rest_.remove_prefix(line_end_.size());
  ++number_;
  return true;
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

absl::Status check_not_utf16(std::string_view text) {
  if (!text.starts_with("\xFF\xFE") && !text.starts_with("\xFE\xFF")) return absl::OkStatus();
  return absl::InvalidArgumentError("it is text in UTF-16: save it as ASCII or UTF-8");
}

std::string_view take_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  const std::size_t end = std::min(text.find_first_of(kBlanks), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(end);
  return word;
}

absl::Status line_error(std::size_t line, std::string_view why) {
  return absl::InvalidArgumentError(absl::StrFormat("line %d: %s", line, why));
}

bool parse_any_number(std::string_view word, double& value) {
  const std::errc error = parse_whole(word, value);
  if (error != std::errc::result_out_of_range || !is_tiny(word)) return error == std::errc();
  value = 0;
  return true;
}

bool parse_number(std::string_view word, double& value) {
  return parse_any_number(word, value) && std::isfinite(value);
}

bool parse_number(std::string_view word, std::int64_t& value) {
  return parse_whole(word, value) == std::errc();
}

bool take_point(std::string_view& text, WorldPoint& point) {
  return parse_number(take_word(text), point.x) && parse_number(take_word(text), point.y) &&
         parse_number(take_word(text), point.z);
}

void add_polygon(std::span<const std::uint32_t> corners,
                 TriangleSurface& surface,
                 std::uint64_t& spare_looks) {
  const bool known = std::all_of(corners.begin(), corners.end(), [&](std::uint32_t id) {
    return id < surface.vertices.size();
  });
  std::vector<WorldPoint> points(corners.size());
  for (std::size_t i = 0; known && i < corners.size(); ++i) {
    points[i] = surface.vertices[corners[i]];
  }
  for (const auto& [a, b, c] : triangulate_polygon(points, spare_looks)) {
    surface.triangles.push_back({corners[a], corners[b], corners[c]});
  }
}

absl::StatusOr<TriangleSurface> checked(TriangleSurface surface) {
  constexpr std::size_t kMaxVertices = 0xFFFFFFFF;  // ids are 32 bits, the last one means none
  if (surface.triangles.empty()) {
    return absl::InvalidArgumentError("there is no triangle in it");
  }
  if (surface.vertices.size() > kMaxVertices) {
    return absl::InvalidArgumentError(absl::StrFormat("it has %d vertices; the limit is %d",
                                                      surface.vertices.size(), kMaxVertices));
  }
  return surface;
}

}  // namespace tet
