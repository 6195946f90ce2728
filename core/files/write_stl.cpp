#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <absl/strings/str_cat.h>

#include "core/files/face_groups.h"
#include "core/files/number_limits.h"
#include "core/files/write_boundary.h"

namespace tet {
namespace {

/// Twelve float32 and two bytes, without padding.
using StlRow = std::array<std::byte, 50>;

std::array<double, 3> unit_normal(const std::array<WorldPoint, 3>& corner) {
  const auto& [a, b, c] = corner;
  const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
  const double vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  const double x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
  const double length = std::sqrt(x * x + y * y + z * z);
  if (length == 0) return {0, 0, 0};
  return {x / length, y / length, z / length};
}

StlRow stl_row(const TetMesh& mesh, const Triangle& triangle) {
  // By stored positions: world coordinates far from zero would cost the normal its digits.
  const auto [nx, ny, nz] =
      unit_normal({mesh.stored_position(triangle[0]), mesh.stored_position(triangle[1]),
                   mesh.stored_position(triangle[2])});
  std::array<float, 12> numbers{static_cast<float>(nx), static_cast<float>(ny),
                                static_cast<float>(nz)};
  std::size_t next = 3;
  for (const std::uint64_t vertex : triangle) {
    const auto [x, y, z] = mesh.vertex(vertex);
    for (const double v : {x, y, z}) numbers[next++] = static_cast<float>(v);
  }
  StlRow row{};
  std::memcpy(row.data(), numbers.data(), sizeof(numbers));
  return row;
}

}  // namespace

absl::Status write_stl(AtomicFile& file, const TetMesh& mesh, const WriteControl& control) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  const FaceGroups faces(mesh, control.stop());
  if (auto s = check_count(faces.count(), kMost, "triangles", ".stl"); !s.ok()) return s;
  BlockWriter writer(file, 84 + faces.count() * sizeof(StlRow), control);
  // Readers take a file that begins with "solid" for text.
  std::string heading = "binary STL of a boundary, written by tetstream";
  heading.resize(80, ' ');
  writer.text(heading);
  writer.number(static_cast<std::uint32_t>(faces.count()));
  writer.rows(faces.count(), [&](std::uint64_t i) { return stl_row(mesh, faces.triangle(i)); });
  return writer.status();
}

}  // namespace tet
