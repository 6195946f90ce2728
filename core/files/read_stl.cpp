#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include <absl/strings/str_format.h>

#include "core/files/surface_file.h"
#include "core/files/surface_reading.h"

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

/// Binary files may start with "solid" too, so the size decides.
bool is_binary(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes) return false;
  const std::uint64_t size = kHeaderBytes + claimed_triangles(bytes) * kTriangleBytes;
  return bytes.size() == size || !bytes.starts_with("solid");
}

absl::StatusOr<TriangleSurface> read_binary(std::string_view bytes) {
  const std::uint64_t count = claimed_triangles(bytes);
  if (count > (bytes.size() - kHeaderBytes) / kTriangleBytes) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "byte %d: it claims %d triangles, which take %d bytes, but has %d", kHeaderBytes - 4,
        count, kHeaderBytes + count * kTriangleBytes, bytes.size()));
  }
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

absl::StatusOr<TriangleSurface> read_ascii(std::string_view text) {
  TriangleSurface surface;
  Welder welder(surface);
  std::vector<std::uint32_t> corners;
  LineReader lines(text);
  while (lines.next()) {
    std::string_view words = lines.line();
    const std::string_view keyword = take_word(words);
    if (keyword == "vertex") {
      WorldPoint point;
      if (!take_point(words, point)) {
        return line_error(lines.number(), "a vertex needs three finite numbers");
      }
      corners.push_back(welder.vertex(point));
    } else if (keyword == "endfacet") {
      if (corners.size() != 3) {
        return line_error(lines.number(), absl::StrFormat("a facet has %d vertices, not three",
                                                          corners.size()));
      }
      add_polygon(corners, surface);
      corners.clear();
    }
  }
  if (!corners.empty()) return line_error(lines.number(), "the last facet does not end");
  return checked(std::move(surface));
}

}  // namespace

absl::StatusOr<TriangleSurface> read_stl(std::string_view bytes) {
  if (is_binary(bytes)) return read_binary(bytes);
  if (bytes.starts_with("solid")) return read_ascii(bytes);
  return absl::InvalidArgumentError(
      absl::StrFormat("it has %d bytes; a binary STL file starts with %d, and one in text with "
                      "'solid'",
                      bytes.size(), kHeaderBytes));
}

}  // namespace tet
