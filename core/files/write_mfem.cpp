#include "core/files/write_mfem.h"

#include <algorithm>
#include <string>
#include <vector>

#include <absl/strings/str_cat.h>

#include "core/base/printable.h"
#include "core/files/face_groups.h"
#include "core/files/mesh_columns.h"
#include "core/files/number_limits.h"
#include "core/files/tet_groups.h"
#include "core/files/text_numbers.h"

namespace tet {
namespace {

/// What a line of each kind takes, more or less: for progress.
constexpr std::uint64_t kMfemElementBytes = 32, kMfemFaceBytes = 26, kMfemVertexBytes = 32;

/// MFEM's numbers for kinds of elements, in front of their vertices.
constexpr std::string_view kMfemTriangle = " 2", kMfemTet = " 4";

template <class Group>
std::string mfem_comments(const char* attribute, const std::vector<Group>& groups) {
  std::string text;
  for (const Group& group : groups) {
    absl::StrAppend(&text, "# ", attribute, " ", group.tag, ": ", for_terminal(group.name),
                    "\n");
  }
  return text;
}

template <class Vertices>
char* put_mfem_element(char* place,
                       std::int32_t attribute,
                       std::string_view kind,
                       const Vertices& vertices) {
  place = put_text(put_number(place, static_cast<std::uint32_t>(attribute)), kind);
  for (const std::uint64_t vertex : vertices) place = put_number(put_text(place, " "), vertex);
  return put_text(place, "\n");
}

void write_mfem_elements(BlockWriter& writer, const TetMesh& mesh) {
  writer.text(absl::StrCat("elements\n", mesh.header.tet_count, "\n"));
  const std::vector<TetGroup> groups = tet_groups(mesh);
  if (mesh.header.has_regions) {
    writer.lines(mesh.header.tet_count, kMfemElementBytes, [&](std::uint64_t i, char* place) {
      return put_mfem_element(place, static_cast<std::int32_t>(mesh.region(i)), kMfemTet,
                              mesh.tet(i));
    });
    return;
  }
  if (!mesh.header.labels.empty()) {
    const std::vector<std::int32_t> tags = tags_of_labels(mesh.header);
    writer.lines(mesh.header.tet_count, kMfemElementBytes, [&](std::uint64_t i, char* place) {
      return put_mfem_element(place, tags[mesh.label(i)], kMfemTet, mesh.tet(i));
    });
    return;
  }
  for (const TetGroup& group : groups) {
    writer.lines(group.tets, kMfemElementBytes, [&](std::uint64_t i, char* place) {
      return put_mfem_element(place, group.tag, kMfemTet, mesh.tet(group.first_tet + i));
    });
  }
}

void write_mfem_boundary(BlockWriter& writer, const FaceGroups& faces) {
  writer.text(absl::StrCat("\nboundary\n", faces.count(), "\n"));
  for (const FaceGroup& group : faces.groups()) {
    writer.lines(group.faces, kMfemFaceBytes, [&](std::uint64_t i, char* place) {
      return put_mfem_element(place, group.tag, kMfemTriangle, faces.triangle(group.first + i));
    });
  }
}

void write_mfem_vertices(BlockWriter& writer, const TetMesh& mesh) {
  const CoordinateType type = file_coordinate_type(mesh.header);
  writer.text(absl::StrCat("\nvertices\n", mesh.header.vertex_count, "\n3\n"));
  writer.lines(mesh.header.vertex_count, kMfemVertexBytes, [&](std::uint64_t i, char* place) {
    const auto [x, y, z] = mesh.vertex(i);
    place = put_text(put_coordinate(place, x, type), " ");
    place = put_text(put_coordinate(place, y, type), " ");
    return put_text(put_coordinate(place, z, type), "\n");
  });
}

}  // namespace

absl::Status write_mfem(AtomicFile& file, const TetMesh& mesh, const WriteControl& control) {
  if (auto s = check_numbers({mesh}, kMostInt32, "MFEM .mesh"); !s.ok()) return s;
  const FaceGroups faces(mesh, control.stop());
  const MeshHeader& header = mesh.header;
  BlockWriter writer(file,
                     header.tet_count * kMfemElementBytes + faces.count() * kMfemFaceBytes +
                         header.vertex_count * kMfemVertexBytes,
                     control);
  writer.text("MFEM mesh v1.0\n\n# written by tetstream\n");
  writer.text(mfem_comments("attribute", tet_groups(mesh)));
  writer.text(mfem_comments("boundary attribute", faces.groups()));
  writer.text("\ndimension\n3\n\n");
  write_mfem_elements(writer, mesh);
  write_mfem_boundary(writer, faces);
  write_mfem_vertices(writer, mesh);
  return writer.status();
}

}  // namespace tet
