#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include <absl/strings/str_format.h>

#include "core/surface/triangulate_polygon.h"
#include "core/triangle_files/ply_header.h"
#include "core/triangle_files/surface_file.h"
#include "core/triangle_files/surface_reading.h"

namespace tet {
namespace {

template <class Number>
double decode_as(const std::array<char, 8>& bytes) {
  Number number;
  std::memcpy(&number, bytes.data(), sizeof(number));
  return static_cast<double>(number);
}

/// A double holds them all, but for integers of eight bytes beyond 2^53, which are no corners.
double decode(const std::array<char, 8>& bytes, PlyType type) {
  const bool is_signed = type.kind == PlyType::kSigned;
  if (type.kind == PlyType::kFloat) {
    return type.size == 4 ? decode_as<float>(bytes) : decode_as<double>(bytes);
  }
  switch (type.size) {
    case 1:
      return is_signed ? decode_as<std::int8_t>(bytes) : decode_as<std::uint8_t>(bytes);
    case 2:
      return is_signed ? decode_as<std::int16_t>(bytes) : decode_as<std::uint16_t>(bytes);
    case 8:
      return is_signed ? decode_as<std::int64_t>(bytes) : decode_as<std::uint64_t>(bytes);
    default:
      return is_signed ? decode_as<std::int32_t>(bytes) : decode_as<std::uint32_t>(bytes);
  }
}

/// The numbers of a PLY body, one after the other.
class PlyBody {
 public:
  PlyBody(std::string_view bytes, const PlyHeader& header)
      : bytes_(bytes), at_(header.body), format_(header.format) {}

  std::size_t at() const noexcept { return at_; }
  std::size_t left() const noexcept { return bytes_.size() - at_; }

  /// Fewest bytes that a number of this type takes: in text a digit, and a blank before the
  /// next.
  std::size_t smallest(PlyType type) const noexcept {
    return format_ == PlyFormat::kAscii ? 2 : type.size;
  }

  /// Whether nothing follows but blanks, or zeros that fill a block.
  bool is_over() const noexcept {
    constexpr std::string_view kNothing(" \t\r\n\0\x1A", 6);
    return bytes_.find_first_not_of(kNothing, at_) == std::string_view::npos;
  }

  bool next(PlyType type, double& value) {
    return format_ == PlyFormat::kAscii ? next_word(value) : next_binary(type, value);
  }

 private:
  bool next_word(double& value) {
    constexpr std::string_view kBlanks = " \t\r\n";
    const std::size_t start = std::min(bytes_.find_first_not_of(kBlanks, at_), bytes_.size());
    const std::size_t end = std::min(bytes_.find_first_of(kBlanks, start), bytes_.size());
    at_ = start;
    if (!parse_any_number(bytes_.substr(start, end - start), value)) return false;
    at_ = end;
    return true;
  }

  bool next_binary(PlyType type, double& value) {
    if (left() < type.size) return false;
    std::array<char, 8> number{};
    const bool native =
        (format_ == PlyFormat::kLittleEndian) == (std::endian::native == std::endian::little);
    for (std::size_t i = 0; i < type.size; ++i) {
      number[native ? i : type.size - 1 - i] = bytes_[at_ + i];
    }
    value = decode(number, type);
    at_ += type.size;
    return true;
  }

  std::string_view bytes_;
  std::size_t at_;
  PlyFormat format_;
};

absl::Status byte_error(const PlyBody& body, std::string_view why) {
  return absl::InvalidArgumentError(absl::StrFormat("byte %d: %s", body.at(), why));
}

/// Before memory is taken: can the rest of the file hold that many elements?
absl::Status check_element(const PlyBody& body, const PlyElement& element) {
  std::size_t smallest = 0;
  for (const PlyProperty& property : element.properties) {
    smallest += body.smallest(property.count_type.value_or(property.type));
  }
  if (element.count <= (body.left() + 1) / smallest) return absl::OkStatus();
  return byte_error(body, absl::StrFormat("%d times '%s' take at least %d bytes each, but %d "
                                          "bytes are left",
                                          element.count, element.name, smallest, body.left()));
}

/// One element of the body: its single values by property, and its last wanted list.
struct PlyRow {
  std::vector<double> values;
  std::vector<double> list;
};

absl::Status read_list(PlyBody& body, const PlyProperty& property, std::vector<double>& list) {
  double count = 0;
  if (!body.next(*property.count_type, count) || count < 0 || count != std::floor(count)) {
    return byte_error(body, absl::StrFormat("no length of '%s' there", property.name));
  }
  const std::size_t most = (body.left() + 1) / body.smallest(property.type);
  if (count > static_cast<double>(most)) {
    return byte_error(body, absl::StrFormat("'%s' claims %.0f entries, but %d bytes are left",
                                            property.name, count, body.left()));
  }
  list.resize(static_cast<std::size_t>(count));
  for (double& entry : list) {
    if (!body.next(property.type, entry)) {
      return byte_error(body, absl::StrFormat("no entry of '%s' there", property.name));
    }
  }
  return absl::OkStatus();
}

bool holds_corners(const PlyProperty& property) {
  return property.name == "vertex_indices" || property.name == "vertex_index";
}

absl::Status read_row(PlyBody& body, const PlyElement& element, PlyRow& row) {
  row.values.resize(element.properties.size());
  row.list.clear();
  std::vector<double> skipped;
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (property.count_type) {
      auto& list = holds_corners(property) ? row.list : skipped;
      if (absl::Status s = read_list(body, property, list); !s.ok()) return s;
    } else if (!body.next(property.type, row.values[i])) {
      return byte_error(body, absl::StrFormat("no number for '%s' there", property.name));
    }
  }
  return absl::OkStatus();
}

/// Where x, y and z are among a vertex's properties.
absl::StatusOr<std::array<std::size_t, 3>> find_axes(const PlyElement& element) {
  constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
  std::array<std::size_t, 3> axes{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto found = std::find_if(
        element.properties.begin(), element.properties.end(),
        [&](const PlyProperty& p) { return p.name == kAxes[axis] && !p.count_type; });
    if (found == element.properties.end()) {
      return absl::InvalidArgumentError(
          absl::StrFormat("its vertices have no property '%s'", kAxes[axis]));
    }
    axes[axis] = static_cast<std::size_t>(found - element.properties.begin());
  }
  return axes;
}

absl::Status read_vertices(PlyBody& body, const PlyElement& element, TriangleSurface& surface) {
  const absl::StatusOr<std::array<std::size_t, 3>> axes = find_axes(element);
  if (!axes.ok()) return axes.status();
  surface.vertices.reserve(element.count);
  PlyRow row;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (absl::Status s = read_row(body, element, row); !s.ok()) return s;
    const WorldPoint p{row.values[(*axes)[0]], row.values[(*axes)[1]], row.values[(*axes)[2]]};
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      return byte_error(body, absl::StrFormat("vertex %d is not finite", i));
    }
    surface.vertices.push_back(p);
  }
  return absl::OkStatus();
}

absl::Status check_has_corners(const PlyElement& element) {
  const bool has_corners =
      std::ranges::any_of(element.properties, [](const PlyProperty& property) {
        return property.count_type && holds_corners(property);
      });
  if (has_corners || element.count == 0) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "its element '%s' has no list 'vertex_indices' or 'vertex_index'", element.name));
}

/// A corner's vertex; `what` and `i` are what names it.
absl::StatusOr<std::uint32_t> parse_corner(const PlyBody& body,
                                           double corner,
                                           std::string_view what,
                                           std::uint64_t i) {
  if (corner >= 0 && corner < 0xFFFFFFFF && corner == std::floor(corner)) {
    return static_cast<std::uint32_t>(corner);
  }
  return byte_error(body, absl::StrFormat("%s %d names vertex %g", what, i, corner));
}

/// What was read of a file so far.
struct PlyParts {
  TriangleSurface surface;
  /// Polygons of vertices that come after them: how these are cut depends on where they lie.
  std::vector<std::vector<std::uint32_t>> later;
  std::uint64_t spare_looks = kSpareLooks;

  void add(std::span<const std::uint32_t> corners) {
    const bool known = std::ranges::all_of(
        corners, [&](std::uint32_t id) { return id < surface.vertices.size(); });
    if (known || corners.size() <= 3) {
      add_polygon(corners, surface, spare_looks);
    } else {
      later.emplace_back(corners.begin(), corners.end());
    }
  }
};

absl::Status read_faces(PlyBody& body, const PlyElement& element, PlyParts& parts) {
  if (absl::Status s = check_has_corners(element); !s.ok()) return s;
  TriangleSurface& surface = parts.surface;
  surface.triangles.reserve(surface.triangles.size() + element.count);
  PlyRow row;
  std::vector<std::uint32_t> corners;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (absl::Status s = read_row(body, element, row); !s.ok()) return s;
    corners.clear();
    for (const double entry : row.list) {
      const absl::StatusOr<std::uint32_t> corner = parse_corner(body, entry, "face", i);
      if (!corner.ok()) return corner.status();
      corners.push_back(*corner);
    }
    parts.add(corners);
  }
  return absl::OkStatus();
}

/// Every corner of a strip makes a triangle with the two before it, turned the other way each
/// time; -1 begins another strip.
absl::Status read_strips(PlyBody& body, const PlyElement& element, TriangleSurface& surface) {
  if (absl::Status s = check_has_corners(element); !s.ok()) return s;
  PlyRow row;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (absl::Status s = read_row(body, element, row); !s.ok()) return s;
    std::uint32_t before_last = 0, last = 0;
    std::size_t length = 0;
    for (const double entry : row.list) {
      if (entry == -1) {
        length = 0;
        continue;
      }
      const absl::StatusOr<std::uint32_t> corner = parse_corner(body, entry, "strip", i);
      if (!corner.ok()) return corner.status();
      if (length >= 2 && length % 2 == 0) {
        surface.triangles.push_back({before_last, last, *corner});
      } else if (length >= 2) {
        surface.triangles.push_back({last, before_last, *corner});
      }
      before_last = last;
      last = *corner;
      ++length;
    }
  }
  return absl::OkStatus();
}

absl::Status read_element(PlyBody& body, const PlyElement& element, PlyParts& parts) {
  if (absl::Status s = check_element(body, element); !s.ok()) return s;
  if (element.name == "vertex") return read_vertices(body, element, parts.surface);
  if (element.name == "face") return read_faces(body, element, parts);
  if (element.name == "tristrips") return read_strips(body, element, parts.surface);
  PlyRow skipped;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (absl::Status s = read_row(body, element, skipped); !s.ok()) return s;
  }
  return absl::OkStatus();
}

/// Faces may come before the vertices they name, so their corners are checked last.
absl::Status check_corners(const TriangleSurface& surface) {
  for (const auto& triangle : surface.triangles) {
    const std::uint32_t largest = *std::max_element(triangle.begin(), triangle.end());
    if (largest >= surface.vertices.size()) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "a face names vertex %d, but there are %d", largest, surface.vertices.size()));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<TriangleSurface> read_ply(std::string_view bytes) {
  const absl::StatusOr<PlyHeader> header = read_ply_header(bytes);
  if (!header.ok()) return header.status();
  PlyBody body(bytes, *header);
  PlyParts parts;
  for (const PlyElement& element : header->elements) {
    if (absl::Status s = read_element(body, element, parts); !s.ok()) return s;
  }
  if (!body.is_over()) {
    return byte_error(body,
                      "the header's elements end here, but more follows: a count is wrong");
  }
  for (const auto& corners : parts.later) {
    add_polygon(corners, parts.surface, parts.spare_looks);
  }
  if (absl::Status s = check_corners(parts.surface); !s.ok()) return s;
  return checked(std::move(parts.surface));
}

}  // namespace tet
