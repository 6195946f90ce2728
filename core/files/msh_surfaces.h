// The boundary of a mesh that a box cuts, by what it lies on: physical surfaces of a .msh file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/files/block_writer.h"
#include "core/mesh/boundary.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// The dimension of a surface.
inline constexpr std::int32_t kMshSurface = 2;

/// Triangles of one name, with the number that entity and physical group have in the file.
struct MshSurface {
  std::int32_t tag = 0;
  std::string name;  ///< "surface", or "cut_x_min" to "cut_z_max"
  std::vector<Triangle> triangles;
};

/// Those that have a triangle; none of a mesh whose vertices have no kCutFaceArray.
std::vector<MshSurface> msh_surfaces(const TetMesh& mesh);

std::uint64_t count_triangles(const std::vector<MshSurface>& surfaces) noexcept;

/// The triangles as a block of elements, numbered from `first` on.
void write_triangles(BlockWriter& writer, const MshSurface& surface, std::uint64_t first);

}  // namespace tet
