// Where a box cuts a mesh, as its vertices' array says it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/graded/cut_box.h"
#include "core/mesh/boundary.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_request.h"

namespace tet::test {

/// Reads each vertex's faces, the last of its values. Empty for a mesh without the array.
inline std::vector<CutFaces> cut_faces(const TetMesh& mesh) {
  const auto& arrays = mesh.header.fields;
  if (arrays.empty() || arrays.back().name != kCutFaceArray) return {};
  const std::size_t row_bytes = mesh.header.field_values() * sizeof(float);
  std::vector<CutFaces> faces(mesh.header.vertex_count);
  const std::byte* end_of_row = mesh.fields.bytes().data();
  for (CutFaces& vertex : faces) {
    float number = 0;
    end_of_row += row_bytes;
    std::memcpy(&number, end_of_row - sizeof(number), sizeof(number));
    vertex = static_cast<CutFaces>(number);
  }
  return faces;
}

/// The faces that a whole triangle lies in.
inline CutFaces faces_of(const std::vector<CutFaces>& faces, const Triangle& triangle) {
  return faces.empty() ? CutFaces{0}
                       : static_cast<CutFaces>(faces[triangle[0]] & faces[triangle[1]] &
                                               faces[triangle[2]]);
}

/// The coordinate along an axis, of which a face's bits are 1 << 2 * axis and twice that.
inline double coordinate(const WorldPoint& point, std::size_t axis) {
  return std::array{point.x, point.y, point.z}[axis];
}

}  // namespace tet::test
