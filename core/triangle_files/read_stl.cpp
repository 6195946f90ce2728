#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <absl/strings/ascii.h>
#include <absl/strings/str_format.h>

#include "core/surface/weld.h"
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

/// Makes a triangle of each three corners. Those of equal coordinates get one vertex: STL
/// repeats each vertex in every triangle. Vertices are in the order of their first corners.
///
/// Corners are sorted, since whoever knows how a table hashes them can choose them so that they
/// all meet in one place of it.
absl::StatusOr<TriangleSurface> welded(const std::vector<WorldPoint>& corners) {
  constexpr std::size_t kMostCorners = 0xFFFFFFFF;
  if (corners.size() > kMostCorners) {
    return absl::InvalidArgumentError(absl::StrFormat("it has %d triangles; the limit is %d",
                                                      corners.size() / 3, kMostCorners / 3));
  }
  TriangleSurface surface;
  surface.triangles.reserve(corners.size() / 3);
  std::vector<std::uint32_t> ids = weld_equal(corners);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (ids[i] != i) {
      ids[i] = ids[ids[i]];  // the first of its kind has its vertex by now
      continue;
    }
    ids[i] = static_cast<std::uint32_t>(surface.vertices.size());
    surface.vertices.push_back(corners[i]);
  }
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    surface.triangles.push_back({ids[i], ids[i + 1], ids[i + 2]});
  }
  return checked(std::move(surface));
}

/// Adding zero makes -0 and 0 the same.
WorldPoint without_signed_zeros(const WorldPoint& p) {
  return {p.x + 0.0, p.y + 0.0, p.z + 0.0};
}

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

/// Programs write keywords in either case.
bool is_keyword(std::string_view word, std::string_view keyword) {
  return std::ranges::equal(word, keyword, {}, [](char c) {
    return absl::ascii_tolower(static_cast<unsigned char>(c));
  });
}

/// The first word of the first line that is neither blank nor a comment.
std::string_view first_keyword(std::string_view text) {
  LineReader lines(text);
  while (lines.next()) {
    std::string_view words = lines.line();
    const std::string_view word = take_word(words);
    if (!word.empty() && !is_comment(word)) return word;
  }
  return {};
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
  return is_keyword(first_keyword(without_byte_order_mark(bytes)), "solid");
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
  std::vector<WorldPoint> points;
  points.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = kHeaderBytes + i * kTriangleBytes + kNormalBytes;
    std::array<std::array<float, 3>, 3> corners;
    std::memcpy(&corners, bytes.data() + at, sizeof(corners));
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& [x, y, z] = corners[c];
      if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
        return absl::InvalidArgumentError(absl::StrFormat(
            "byte %d: triangle %d has a corner that is not finite", at + c * 12, i));
      }
      points.push_back(without_signed_zeros({x, y, z}));
    }
  }
  return welded(points);
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
    if (corners_.size() != ended_) {
      return line_error(lines.number(), "the last facet does not end");
    }
    return welded(corners_);
  }

 private:
  absl::Status read_line(std::string_view words) {
    for (std::string_view word = take_word(words); !word.empty(); word = take_word(words)) {
      if (is_comment(word)) break;
      absl::Status status;
      if (is_keyword(word, "solid") || is_keyword(word, "endsolid")) skip_name(words);
      if (is_keyword(word, "vertex")) status = read_vertex(words);
      if (is_keyword(word, "endfacet")) status = end_facet();
      if (!status.ok()) return status;
    }
    return absl::OkStatus();
  }

  /// A name is what follows in the line, up to a facet and its normal; it may hold any word.
  static void skip_name(std::string_view& words) {
    bool after_facet = false;
    for (std::string_view rest = words; !rest.empty();) {
      const std::string_view here = rest;
      const std::string_view word = take_word(rest);
      if (after_facet && is_keyword(word, "normal")) return;
      after_facet = is_keyword(word, "facet");
      words = after_facet ? here : rest;
    }
  }

  absl::Status read_vertex(std::string_view& words) {
    WorldPoint point;
    if (!take_point(words, point)) {
      return absl::InvalidArgumentError("a vertex needs three finite numbers");
    }
    corners_.push_back(without_signed_zeros(point));
    return absl::OkStatus();
  }

  absl::Status end_facet() {
    const std::size_t corners = corners_.size() - ended_;
    if (corners != 3) {
      return absl::InvalidArgumentError(
          absl::StrFormat("a facet has %d vertices, not three", corners));
    }
    ended_ = corners_.size();
    return absl::OkStatus();
  }

  std::vector<WorldPoint> corners_;
  std::size_t ended_ = 0;  ///< corners of the facets that have ended
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
