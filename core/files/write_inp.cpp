#include "core/files/write_inp.h"

#include <array>
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
constexpr std::uint64_t kInpNodeBytes = 40, kInpNumberBytes = 8, kInpMemberBytes = 12;

/// The face opposite each corner of a C3D4 or C3D10: S1 is 1-2-3, S2 1-4-2, S3 2-4-3 and S4
/// 3-4-1.
constexpr std::array<std::string_view, 4> kInpFaces{", S3\n", ", S4\n", ", S2\n", ", S1\n"};

class InpWriter {
 public:
  InpWriter(AtomicFile& file, const FileMesh& mesh, const WriteControl& control)
      : nodes_(mesh),
        mesh_(mesh.mesh),
        shape_(mesh.shape()),
        tets_(tet_groups(mesh_)),
        tet_names_(names_in_file(names_of(tets_), kInpNames)),
        faces_(mesh_, control.stop()),
        face_names_(names_in_file(names_of(faces_.groups()), kInpNames)),
        // Each face is in a surface, and half a vertex of it in a set of nodes.
        writer_(file,
                shape_.nodes * kInpNodeBytes + mesh_.header.tet_count * element_bytes() +
                    faces_.count() * kInpMemberBytes * 3 / 2,
                control) {}

  absl::Status write() {
    write_heading();
    write_nodes();
    for (std::size_t i = 0; i < tets_.size(); ++i) write_elements(i);
    write_all_elements();
    RankMask nodes(shape_.nodes);
    for (std::size_t i = 0; i < faces_.groups().size() && writer_.status().ok(); ++i) {
      write_surface(i);
      faces_.collect_nodes(nodes_, faces_.groups()[i], nodes);
      write_node_set(i, nodes);
    }
    return writer_.status();
  }

 private:
  std::uint64_t element_bytes() const { return (1 + shape_.nodes_per_tet) * kInpNumberBytes; }

  void tell_name(const char* what, const std::string& name, const std::string& real_name) {
    if (name == real_name) return;
    writer_.text(absl::StrCat("** ", what, " ", name, ": ", for_terminal(real_name), "\n"));
  }

  void write_heading() {
    writer_.text(absl::StrCat("*HEADING\n", shape_.nodes, " nodes, ", mesh_.header.tet_count,
                              " elements, written by tetstream\n"));
    for (std::size_t i = 0; i < tets_.size(); ++i) {
      tell_name("ELSET", tet_names_[i], tets_[i].name);
    }
    for (std::size_t i = 0; i < face_names_.size(); ++i) {
      tell_name("SURFACE", face_names_[i], faces_.groups()[i].name);
    }
  }

  void write_nodes() {
    const CoordinateType type = file_coordinate_type(mesh_.header);
    writer_.text("*NODE, NSET=Nall\n");
    writer_.lines(shape_.nodes, kInpNodeBytes, [&](std::uint64_t i, char* place) {
      place = put_number(place, i + 1);
      const auto [x, y, z] = nodes_.node(i);
      for (const double coordinate : {x, y, z}) {
        place = put_short_coordinate(put_text(place, ", "), coordinate, type);
      }
      return put_text(place, "\n");
    });
  }

  void write_elements(std::size_t group) {
    if (tets_[group].tets == 0) return;  // readers take no empty set
    writer_.text(absl::StrCat("*ELEMENT, TYPE=C3D", shape_.nodes_per_tet,
                              ", ELSET=", tet_names_[group], "\n"));
    TetsOfGroup tets(mesh_, tets_[group]);
    with_nodes_per_tet(nodes_, [&](auto nodes) {
      writer_.lines(tets_[group].tets, element_bytes(), [&](std::uint64_t, char* place) {
        const std::uint64_t tet = tets.next();
        place = put_number(place, tet + 1);
        for (const auto node : nodes_.template nodes_of<decltype(nodes)::value>(tet)) {
          place = put_number(put_text(place, ", "), node + 1);
        }
        return put_text(place, "\n");
      });
    });
  }

  void write_all_elements() {
    writer_.text("*ELSET, ELSET=Eall\n");
    for (std::size_t i = 0; i < tets_.size(); ++i) {
      if (tets_[i].tets > 0) writer_.text(absl::StrCat(tet_names_[i], "\n"));
    }
  }

  void write_surface(std::size_t i) {
    const FaceGroup& group = faces_.groups()[i];
    writer_.text(absl::StrCat("*SURFACE, NAME=", face_names_[i], ", TYPE=ELEMENT\n"));
    writer_.lines(group.faces, kInpMemberBytes, [&](std::uint64_t face, char* place) {
      const TetFace of_tet = faces_[group.first + face];
      place = put_number(place, of_tet.tet() + 1);
      return put_text(place, kInpFaces[of_tet.opposite()]);
    });
  }

  void write_node_set(std::size_t i, const RankMask& nodes) {
    writer_.text(absl::StrCat("*NSET, NSET=", face_names_[i], "\n"));
    std::uint64_t next = 0;
    writer_.lines(nodes.count(), kInpMemberBytes, [&](std::uint64_t, char* place) {
      next = nodes.next(next) + 1;
      return put_text(put_number(place, next), "\n");
    });
  }

  const FileMesh& nodes_;
  const TetMesh& mesh_;
  FileShape shape_;
  std::vector<TetGroup> tets_;
  std::vector<std::string> tet_names_;
  FaceGroups faces_;
  std::vector<std::string> face_names_;
  BlockWriter writer_;
};

}  // namespace

absl::Status write_inp(AtomicFile& file, const FileMesh& mesh, const WriteControl& control) {
  constexpr std::uint64_t kMost = 999'999'999;
  if (auto status = check_numbers(mesh, kMost, ".inp"); !status.ok()) return status;
  return InpWriter(file, mesh, control).write();
}

}  // namespace tet
