#include "core/files/msh_surfaces.h"

#include <array>
#include <cstddef>
#include <utility>

#include "core/mesh/find_faces.h"

namespace tet {
namespace {

constexpr std::int32_t kTriangle = 2;  ///< Gmsh's number for a linear triangle

/// The faces by their labels; a label's number in the file is one more than its place.
std::vector<MshSurface> sort_by_label(const TetMesh& faces) {
  const MeshHeader& header = faces.header;
  std::vector<MshSurface> surfaces(header.face_labels.size());
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    surfaces[i] = {static_cast<std::int32_t>(i) + 1, header.face_labels[i].name, {}};
  }
  for (std::uint64_t i = 0; i < header.face_count; ++i) {
    surfaces[faces.face_label(i)].triangles.push_back(faces.face(i));
  }
  std::erase_if(surfaces, [](const MshSurface& surface) { return surface.triangles.empty(); });
  return surfaces;
}

/// The faces of a mesh that a box cuts, and has none of its own: nothing else of it.
TetMesh find_cut_faces(const TetMesh& mesh) {
  TetMesh faces;
  const FoundFaces found = find_faces(mesh);
  faces.header.index_type = mesh.header.index_type;
  faces.header.tet_count = mesh.header.tet_count;
  set_faces(found, mesh, faces);
  return faces;
}

}  // namespace

std::vector<MshSurface> msh_surfaces(const TetMesh& mesh) {
  if (mesh.header.has_faces()) return sort_by_label(mesh);
  if (!has_cut_faces(mesh.header)) return {};
  return sort_by_label(find_cut_faces(mesh));
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
