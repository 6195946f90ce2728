#include "core/fidelity/surface_triangles.h"

#include <algorithm>
#include <cstring>
#include <iterator>

#include "core/mesh/boundary.h"
#include "core/plan/mesh_request.h"

namespace tet {
namespace {

/// Sorted as boundary_triangles sorts.
bool comes_before(const Triangle& a, const Triangle& b) noexcept {
  return sort_face(a).vertices < sort_face(b).vertices;
}

std::vector<Triangle> between_both_sides(const TetMesh& mesh) {
  const std::vector<Triangle> inside = boundary_triangles(mesh, MeshRegion::kInside);
  const std::vector<Triangle> outside = boundary_triangles(mesh, MeshRegion::kOutside);
  std::vector<Triangle> shared;
  std::ranges::set_intersection(inside, outside, std::back_inserter(shared), comes_before);
  return shared;
}

bool has_box_faces(const MeshHeader& header) {
  return !header.fields.empty() && header.fields.back().name == kCutFaceArray;
}

}  // namespace

std::vector<Triangle> surface_triangles(const TetMesh& mesh) {
  if (mesh.header.has_regions) return between_both_sides(mesh);
  std::vector<Triangle> triangles = boundary_triangles(mesh);
  if (!has_box_faces(mesh.header)) return triangles;
  std::erase_if(triangles, [&](const Triangle& t) {
    return (box_faces_at(mesh, t[0]) & box_faces_at(mesh, t[1]) & box_faces_at(mesh, t[2])) !=
           0;
  });
  return triangles;
}

/// The last of a vertex's values tells.
std::uint32_t box_faces_at(const TetMesh& mesh, std::uint64_t vertex) noexcept {
  constexpr float kAllFaces = 63;
  if (!has_box_faces(mesh.header)) return 0;
  const std::size_t row = mesh.header.field_values() * sizeof(float);
  float number = 0;
  std::memcpy(&number, mesh.fields.bytes().data() + (vertex + 1) * row - sizeof(number),
              sizeof(number));
  // It may come from a server: it may be anything.
  return number >= 0 && number <= kAllFaces ? static_cast<std::uint32_t>(number) : 0;
}

}  // namespace tet
