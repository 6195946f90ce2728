#include <string>
#include <vector>

#include <absl/strings/str_cat.h>

#include "core/base/printable.h"
#include "core/files/boundary_mesh.h"
#include "core/files/mesh_columns.h"
#include "core/files/text_numbers.h"
#include "core/files/write_boundary.h"

namespace tet {
namespace {

/// What a line of each kind takes, more or less: for progress.
constexpr std::uint64_t kObjVertexBytes = 34, kObjFaceBytes = 24;

void write_obj_vertices(BlockWriter& writer, const BoundaryMesh& boundary) {
  const TetMesh& mesh = boundary.mesh();
  const CoordinateType type = file_coordinate_type(mesh.header);
  std::uint64_t next = 0;
  writer.lines(boundary.vertex_count(), kObjVertexBytes, [&](std::uint64_t, char* place) {
    const std::uint64_t vertex = boundary.vertex_from(next);
    next = vertex + 1;
    const auto [x, y, z] = mesh.vertex(vertex);
    place = put_text(place, "v");
    for (const double v : {x, y, z}) place = put_coordinate(put_text(place, " "), v, type);
    return put_text(place, "\n");
  });
}

void write_obj_group(BlockWriter& writer,
                     const BoundaryMesh& boundary,
                     const FaceGroup& group) {
  writer.lines(group.faces, kObjFaceBytes, [&](std::uint64_t i, char* place) {
    place = put_text(place, "f");
    for (const std::uint64_t vertex : boundary.triangle(group.first + i)) {
      place = put_number(put_text(place, " "), vertex + 1);
    }
    return put_text(place, "\n");
  });
}

}  // namespace

absl::Status write_obj(AtomicFile& file, const TetMesh& mesh, const WriteControl& control) {
  const BoundaryMesh boundary(mesh, control.stop());
  const std::vector<FaceGroup>& groups = boundary.faces().groups();
  const std::vector<std::string> names = names_in_file(names_of(groups), kObjNames);
  BlockWriter writer(
      file,
      boundary.vertex_count() * kObjVertexBytes + boundary.faces().count() * kObjFaceBytes,
      control);
  writer.text("# the boundary of a mesh, written by tetstream\n");
  write_obj_vertices(writer, boundary);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (names[i] != groups[i].name) {
      writer.text(absl::StrCat("# ", names[i], ": ", for_terminal(groups[i].name), "\n"));
    }
    writer.text(absl::StrCat("g ", names[i], "\n"));
    write_obj_group(writer, boundary, groups[i]);
  }
  return writer.status();
}

}  // namespace tet
