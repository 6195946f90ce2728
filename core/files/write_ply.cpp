#include <array>
#include <cstring>
#include <string>
#include <vector>

#include <absl/strings/str_cat.h>

#include "core/base/printable.h"
#include "core/files/boundary_mesh.h"
#include "core/files/mesh_columns.h"
#include "core/files/number_limits.h"
#include "core/files/write_boundary.h"

namespace tet {
namespace {

/// The count, three ids and a label, without padding.
using PlyFace = std::array<std::byte, 15>;

std::string ply_header(const BoundaryMesh& boundary, CoordinateType type) {
  const FaceGroups& faces = boundary.faces();
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment written by tetstream\n";
  for (const FaceGroup& group : faces.groups()) {
    absl::StrAppend(&text, "comment label ", group.tag, " ", for_terminal(group.name), "\n");
  }
  const char* const real = type == CoordinateType::kFloat64 ? "double" : "float";
  absl::StrAppend(&text, "element vertex ", boundary.vertex_count(), "\n");
  for (const char* const axis : {"x", "y", "z"}) {
    absl::StrAppend(&text, "property ", real, " ", axis, "\n");
  }
  const std::vector<FieldArray>& fields = boundary.mesh().header.fields;
  const std::vector<std::string> names =
      array_names_in_file(names_of(fields), components_of(fields), kPlyNames);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (const std::string_view ending : component_endings(fields[i].components)) {
      absl::StrAppend(&text, "property float ", names[i], std::string(ending), "\n");
    }
  }
  return absl::StrCat(text, "element face ", faces.count(),
                      "\nproperty list uchar int vertex_indices\nproperty ushort label\n",
                      "end_header\n");
}

PlyFace ply_face(const Triangle& triangle, std::int32_t label) {
  PlyFace row;
  row[0] = std::byte{3};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto vertex = static_cast<std::int32_t>(triangle[k]);
    std::memcpy(row.data() + 1 + 4 * k, &vertex, sizeof(vertex));
  }
  const auto tag = static_cast<std::uint16_t>(label);
  std::memcpy(row.data() + 13, &tag, sizeof(tag));
  return row;
}

/// The vertices with their fields, whose count of values is not known when this is compiled.
template <class Number>
void write_ply_vertices(BlockWriter& writer, const BoundaryMesh& boundary) {
  const TetMesh& mesh = boundary.mesh();
  const std::size_t field_bytes = mesh.header.field_values() * sizeof(float);
  const std::size_t row_bytes = 3 * sizeof(Number) + field_bytes;
  std::uint64_t next = 0;
  // Rows of bytes are lines without an end.
  writer.lines(boundary.vertex_count(), row_bytes, [&](std::uint64_t, char* place) {
    const std::uint64_t vertex = boundary.vertex_from(next);
    next = vertex + 1;
    const auto [x, y, z] = mesh.vertex(vertex);
    const std::array position{static_cast<Number>(x), static_cast<Number>(y),
                              static_cast<Number>(z)};
    std::memcpy(place, position.data(), sizeof(position));
    if (field_bytes > 0) {
      std::memcpy(place + sizeof(position), mesh.fields.bytes().data() + vertex * field_bytes,
                  field_bytes);
    }
    return place + row_bytes;
  });
}

}  // namespace

absl::Status write_ply(AtomicFile& file, const TetMesh& mesh, const WriteControl& control) {
  const BoundaryMesh boundary(mesh, control.stop());
  const CoordinateType type = file_coordinate_type(mesh.header);
  if (auto s = check_count(boundary.vertex_count(), kMostInt32, "vertices", ".ply"); !s.ok()) {
    return s;
  }
  const std::size_t row_bytes = 3 * size_of(type) + mesh.header.field_values() * sizeof(float);
  if (auto s = check_count(row_bytes, BlockWriter::kMostLineBytes, "bytes a vertex", ".ply");
      !s.ok()) {
    return s;
  }
  BlockWriter writer(
      file, boundary.vertex_count() * row_bytes + boundary.faces().count() * sizeof(PlyFace),
      control);
  writer.text(ply_header(boundary, type));
  if (type == CoordinateType::kFloat64) {
    write_ply_vertices<double>(writer, boundary);
  } else {
    write_ply_vertices<float>(writer, boundary);
  }
  for (const FaceGroup& group : boundary.faces().groups()) {
    writer.rows(group.faces, [&](std::uint64_t i) {
      return ply_face(boundary.triangle(group.first + i), group.tag);
    });
  }
  return writer.status();
}

}  // namespace tet
