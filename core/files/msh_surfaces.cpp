#include "core/files/msh_surfaces.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <utility>

#include "core/plan/mesh_request.h"

namespace tet {
namespace {

constexpr std::int32_t kTriangle = 2;  ///< Gmsh's number for a linear triangle

/// The first is what no face of the box holds; the others are in the order of CutFace's bits.
constexpr std::array kNames{"surface",   "cut_x_min", "cut_x_max", "cut_y_min",
                            "cut_y_max", "cut_z_min", "cut_z_max"};

/// The faces that each vertex lies in, read from the last of its values.
class VertexFaces {
 public:
  explicit VertexFaces(const TetMesh& mesh)
      : row_bytes_(mesh.header.field_values() * sizeof(float)),
        last_(mesh.fields.bytes().data() + row_bytes_ - sizeof(float)) {}

  std::uint32_t operator[](std::uint64_t vertex) const noexcept {
    constexpr float kAllFaces = 63;
    float number = 0;
    std::memcpy(&number, last_ + vertex * row_bytes_, sizeof(number));
    // It came from a server: it may be anything.
    return number >= 0 && number <= kAllFaces ? static_cast<std::uint32_t>(number) : 0;
  }

 private:
  std::size_t row_bytes_;
  const std::byte* last_;
};

bool has_faces(const MeshHeader& header) {
  return !header.fields.empty() && header.fields.back().name == kCutFaceArray;
}

}  // namespace

std::vector<MshSurface> msh_surfaces(const TetMesh& mesh) {
  std::vector<MshSurface> surfaces;
  if (!has_faces(mesh.header)) return surfaces;
  const VertexFaces faces(mesh);
  std::array<std::vector<Triangle>, kNames.size()> triangles;
  for (const Triangle& triangle : boundary_triangles(mesh)) {
    const std::uint32_t shared = faces[triangle[0]] & faces[triangle[1]] & faces[triangle[2]];
    const auto at = shared == 0 ? 0 : 1 + static_cast<std::size_t>(std::countr_zero(shared));
    triangles[at].push_back(triangle);
  }
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (triangles[i].empty()) continue;
    surfaces.push_back({static_cast<std::int32_t>(i) + 1, kNames[i], std::move(triangles[i])});
  }
  return surfaces;
}

std::uint64_t count_triangles(const std::vector<MshSurface>& surfaces) noexcept {
  std::uint64_t count = 0;
  for (const MshSurface& surface : surfaces) count += surface.triangles.size();
  return count;
}

void write_triangles(BlockWriter& writer, const MshSurface& surface, std::uint64_t first) {
  writer.number(std::array<std::int32_t, 3>{kMshSurface, surface.tag, kTriangle});
  writer.number(std::uint64_t{surface.triangles.size()});
  writer.rows(surface.triangles.size(), [&](std::uint64_t i) {
    const auto& [a, b, c] = surface.triangles[i];
    return std::array<std::uint64_t, 4>{first + i, a + 1, b + 1, c + 1};
  });
}

}  // namespace tet
