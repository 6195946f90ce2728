#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <absl/strings/ascii.h>
#include <absl/strings/str_format.h>

#include "core/triangle_files/surface_file.h"
#include "core/triangle_files/surface_reading.h"

namespace tet {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is read as it lies");

// Binary: 80 bytes of anything, a triangle count, then per triangle a normal, three corners
// (float each) and two bytes of attributes.
constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kTriangleBytes = 50;
constexpr std::size_t kNormalBytes = 12;

/// Gives corners of equal coordinates one vertex: STL repeats each vertex in every triangle.
class Welder {
 public:
  explicit Welder(TriangleSurface& surface) : surface_(&surface) {}

  std::uint32_t vertex(const WorldPoint& point) {
    // Adding zero makes -0 and 0 the same.
    const WorldPoint key{point.x + 0.0, point.y + 0.0, point.z + 0.0};
    const auto next = static_cast<std::uint32_t>(surface_->vertices.size());
    const auto [it, added] = ids_.try_emplace(key, next);
    if (added) surface_->vertices.push_back(key);
    return it->second;
  }

 private:
  struct Hash {
    std::size_t operator()(const WorldPoint& p) const noexcept {
      std::uint64_t hash = 0;
      for (const double v : {p.x, p.y, p.z}) {
        // The multiplier is 2^64 over the golden ratio: it spreads close keys far apart.
        hash = (hash ^ std::bit_cast<std::uint64_t>(v)) * 0x9E3779B97F4A7C15ULL;
        hash ^= hash >> 32;
      }
      return hash;
    }
  };
  TriangleSurface* surface_;
  std::unordered_map<WorldPoint, std::uint32_t, Hash> ids_;
};

std::uint64_t claimed_triangles(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHeaderBytes - sizeof(count), sizeof(count));
  return count;
}

std::uint64_t held_triangles(std::string_view bytes) {
  return (bytes.size() - kHeaderBytes) / kTriangleBytes;
}

/// Lines that begin so are comments to several programs, and keywords to none.
bool is_comment(std::string_view word) {
  return word.starts_with(';') || word.starts_with('#') || word.starts_with("//");
}

/// The first word of the first line that is neither blank nor a comment.
std::string first_keyword(std::string_view text) {
  LineReader lines(text);
  while (lines.next()) {
    std::string_view words = lines.line();
    const std::string_view word = take_word(words);
    if (!word.empty() && !is_comment(word)) return absl::AsciiStrToLower(std::string(word));
  }
  return "";
}

/// Binary files may start with "solid" too, and have bytes behind their triangles. Their counts
/// and zeros are bytes that no text has.
bool is_text(std::string_view bytes) {
  constexpr std::size_t kLookedAt = 1024;
  const std::string_view start = bytes.substr(0, kLookedAt);
  if (start.find('\0') != std::string_view::npos) return false;
  if (bytes.size() >= kHeaderBytes &&
      bytes.size() == kHeaderBytes + claimed_triangles(bytes) * kTriangleBytes) {
    return false;
  }
  return first_keyword(without_byte_order_mark(bytes)) == "solid";
}

/// A count that is too large is of a file that was cut off; one that is too small would leave
/// triangles out. Bytes behind the last triangle are nobody's, if they are no triangle or all
/// 0.
absl::Status check_triangles(std::string_view bytes) {
  const std::uint64_t count = claimed_triangles(bytes), held = held_triangles(bytes);
  if (count > held) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "byte %d: it claims %d triangles, which take %d bytes, but has %d", kHeaderBytes - 4,
        count, kHeaderBytes + count * kTriangleBytes, bytes.size()));
  }
  const std::string_view rest = bytes.substr(kHeaderBytes + count * kTriangleBytes);
  if (count == held || rest.find_first_not_of('\0') == std::string_view::npos) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrFormat(
      "byte %d: it claims %d triangles, but its %d bytes hold %d: the count is wrong, or there "
      "are foreign bytes from byte %d on",
      kHeaderBytes - 4, count, bytes.size(), held, bytes.size() - rest.size()));
}

absl::StatusOr<TriangleSurface> read_binary(std::string_view bytes) {
  if (absl::Status s = check_triangles(bytes); !s.ok()) return s;
  const std::uint64_t count = claimed_triangles(bytes);
  TriangleSurface surface;
  surface.triangles.reserve(count);
  Welder welder(surface);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = kHeaderBytes + i * kTriangleBytes + kNormalBytes;
    std::array<std::array<float, 3>, 3> corners;
    std::memcpy(&corners, bytes.data() + at, sizeof(corners));
    std::array<std::uint32_t, 3> triangle;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& [x, y, z] = corners[c];
      if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
        return absl::InvalidArgumentError(absl::StrFormat(
            "byte %d: triangle %d has a corner that is not finite", at + c * 12, i));
      }
      triangle[c] = welder.vertex({x, y, z});
    }
    surface.triangles.push_back(triangle);
  }
  return checked(std::move(surface));
}

/// Reads the facets of one text after the other, several of them in a line if need be.
class AsciiReader {
 public:
  absl::StatusOr<TriangleSurface> read(std::string_view text) {
    LineReader lines(text);
    while (lines.next()) {
      if (absl::Status s = read_line(lines.line()); !s.ok()) {
        return line_error(lines.number(), std::string(s.message()));
      }
    }
    if (!corners_.empty()) return line_error(lines.number(), "the last facet does not end");
    return checked(std::move(surface_));
  }

 private:
  absl::Status read_line(std::string_view words) {
    for (std::string_view word = take_word(words); !word.empty(); word = take_word(words)) {
      if (is_comment(word)) break;
      const std::string keyword = absl::AsciiStrToLower(std::string(word));
      absl::Status status;
      if (keyword == "solid" || keyword == "endsolid") skip_name(words);
      if (keyword == "vertex") status = read_vertex(words);
      if (keyword == "endfacet") status = end_facet();
      if (!status.ok()) return status;
    }
    return absl::OkStatus();
  }

  /// A name is what follows in the line, up to a facet; it may hold any word.
  static void skip_name(std::string_view& words) {
    const std::string line = absl::AsciiStrToLower(std::string(words));
    std::size_t facet = line.find("facet");
    while (facet != std::string::npos) {
      std::string_view after = std::string_view(line).substr(facet);
      if (take_word(after) == "facet" && take_word(after) == "normal") break;
      facet = line.find("facet", facet + 1);
    }
    words.remove_prefix(std::min(facet, words.size()));
  }

  absl::Status read_vertex(std::string_view& words) {
    WorldPoint point;
    if (!take_point(words, point)) {
      return absl::InvalidArgumentError("a vertex needs three finite numbers");
    }
    corners_.push_back(welder_.vertex(point));
    return absl::OkStatus();
  }

  absl::Status end_facet() {
    if (corners_.size() != 3) {
      return absl::InvalidArgumentError(
          absl::StrFormat("a facet has %d vertices, not three", corners_.size()));
    }
    add_polygon(corners_, surface_);
    corners_.clear();
    return absl::OkStatus();
  }

  TriangleSurface surface_;
  Welder welder_{surface_};
  std::vector<std::uint32_t> corners_;
};

}  // namespace

absl::StatusOr<TriangleSurface> read_stl(std::string_view bytes) {
  if (is_text(bytes)) return AsciiReader().read(without_byte_order_mark(bytes));
  const bool is_whole =
      bytes.size() >= kHeaderBytes && claimed_triangles(bytes) <= held_triangles(bytes);
  if (absl::Status s = check_not_utf16(bytes); !s.ok() && !is_whole) return s;
  if (bytes.size() >= kHeaderBytes) return read_binary(bytes);
  return absl::InvalidArgumentError(
      absl::StrFormat("it has %d bytes; a binary STL file starts with %d, and one in text with "
                      "'solid'",
                      bytes.size(), kHeaderBytes));
}

}  // namespace tet
