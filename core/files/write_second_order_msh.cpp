// Gmsh 4.1 binary with ten-node tets (type 11) and six-node triangles (type 9).
#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>

#include "core/files/face_groups.h"
#include "core/files/tet_groups.h"
#include "core/files/write_second_order.h"
#include "core/mesh/faces.h"

namespace tet {
namespace {

constexpr std::int32_t kSheet = 2, kSolid = 3;                  ///< dimensions of entities
constexpr std::int32_t kTenNodeTet = 11, kSixNodeTriangle = 9;  ///< Gmsh's numbers

/// The edge of a tet between two of its corners, a place in kTetEdges.
std::size_t edge_between(std::size_t a, std::size_t b) noexcept {
  std::size_t e = 0;
  while (kTetEdges[e] != std::array{a, b} && kTetEdges[e] != std::array{b, a}) ++e;
  return e;
}

/// The six nodes of a tet's face: its corners, counter-clockwise seen from outside, and the
/// middles from each to the next.
std::array<std::uint64_t, 6> nodes_of_face(const SecondOrderMesh& all, const TetFace& face) {
  const auto nodes = all.nodes_of(face.tet());
  const auto& [a, b, c] = kFaceCorners[face.opposite()];
  return {nodes[a],
          nodes[b],
          nodes[c],
          nodes[4 + edge_between(a, b)],
          nodes[4 + edge_between(b, c)],
          nodes[4 + edge_between(c, a)]};
}

/// Writes the sections of a file, one after the other.
class MshSections {
 public:
  MshSections(BlockWriter& writer, const SecondOrderMesh& all)
      : writer_(writer), all_(all), groups_(tet_groups(all.mesh)), surfaces_(all.mesh) {}

  void write() {
    writer_.text("$MeshFormat\n4.1 1 8\n");  // binary, with eight-byte sizes
    writer_.number(std::int32_t{1});         // tells a reader the byte order
    writer_.text("\n$EndMeshFormat\n");
    write_names();
    write_entities();
    write_nodes();
    write_elements();
    for (std::size_t i = 0; i < all_.mesh.header.fields.size(); ++i) write_values(i);
  }

 private:
  void write_names() {
    std::string text =
        absl::StrCat("$PhysicalNames\n", groups_.size() + surfaces_.groups().size(), "\n");
    const auto add = [&](std::int32_t dimension, std::int32_t tag, const std::string& name) {
      absl::StrAppend(&text, dimension, " ", tag, " \"",
                      absl::StrReplaceAll(name, {{"\"", "'"}}), "\"\n");
    };
    for (const FaceGroup& surface : surfaces_.groups()) add(kSheet, surface.tag, surface.name);
    for (const TetGroup& group : groups_) add(kSolid, group.tag, group.name);
    writer_.text(text + "$EndPhysicalNames\n");
  }

  void write_entity(std::int32_t tag) {
    const auto& [min, max] = all_.mesh.header.bounds;
    writer_.number(tag);
    writer_.number(std::array{min.x, min.y, min.z, max.x, max.y, max.z});
    writer_.number(std::uint64_t{1});  // physical tags
    writer_.number(tag);
    writer_.number(std::uint64_t{0});  // bounding entities
  }

  void write_entities() {
    writer_.text("$Entities\n");
    writer_.number(
        std::array<std::uint64_t, 4>{0, 0, surfaces_.groups().size(), groups_.size()});
    for (const FaceGroup& surface : surfaces_.groups()) write_entity(surface.tag);
    for (const TetGroup& group : groups_) write_entity(group.tag);
    writer_.text("\n$EndEntities\n");
  }

  void write_nodes() {
    const std::uint64_t count = all_.node_count();
    writer_.text("$Nodes\n");
    writer_.number(std::array<std::uint64_t, 4>{1, count, 1, count});
    writer_.number(std::array<std::int32_t, 3>{kSolid, 1, 0});
    writer_.number(count);
    writer_.rows(count, [](std::uint64_t i) { return i + 1; });
    writer_.rows(count, [&](std::uint64_t i) {
      const auto [x, y, z] = all_.node(i);
      return std::array{x, y, z};
    });
    writer_.text("\n$EndNodes\n");
  }

  void write_tets(const TetGroup& group) {
    writer_.number(std::array<std::int32_t, 3>{kSolid, group.tag, kTenNodeTet});
    writer_.number(group.tets);
    TetsOfGroup tets(all_.mesh, group);  // rows are made in order
    writer_.rows(group.tets, [&](std::uint64_t) {
      const std::uint64_t tet = tets.next();
      auto nodes = all_.nodes_of(tet);
      std::swap(nodes[8], nodes[9]);  // Gmsh's order
      std::array<std::uint64_t, 11> row;
      row[0] = tet + 1;
      for (std::size_t i = 0; i < nodes.size(); ++i) row[i + 1] = nodes[i] + 1;
      return row;
    });
  }

  void write_curved_triangles(const FaceGroup& surface) {
    const std::uint64_t first = all_.mesh.header.tet_count + 1 + surface.first;
    writer_.number(std::array<std::int32_t, 3>{kSheet, surface.tag, kSixNodeTriangle});
    writer_.number(surface.faces);
    writer_.rows(surface.faces, [&](std::uint64_t i) {
      const auto nodes = nodes_of_face(all_, surfaces_[surface.first + i]);
      std::array<std::uint64_t, 7> row;
      row[0] = first + i;
      for (std::size_t n = 0; n < nodes.size(); ++n) row[n + 1] = nodes[n] + 1;
      return row;
    });
  }

  /// Tets come first, so that their tags are their numbers in the mesh.
  void write_elements() {
    const auto not_empty = static_cast<std::uint64_t>(
        std::ranges::count_if(groups_, [](const TetGroup& group) { return group.tets > 0; }));
    const std::uint64_t count = all_.mesh.header.tet_count + surfaces_.count();
    writer_.text("$Elements\n");
    writer_.number(
        std::array<std::uint64_t, 4>{not_empty + surfaces_.groups().size(), count, 1, count});
    for (const TetGroup& group : groups_) {
      if (group.tets > 0) write_tets(group);
    }
    for (const FaceGroup& surface : surfaces_.groups()) write_curved_triangles(surface);
    writer_.text("\n$EndElements\n");
  }

  template <std::size_t kComponents>
  void write_rows(std::size_t first) {
    const std::uint64_t vertices = all_.mesh.header.vertex_count;
    const std::size_t row_bytes = all_.mesh.header.field_values() * sizeof(float);
    writer_.rows(all_.node_count(), [&](std::uint64_t i) {
      const bool is_vertex = i < vertices;
      const std::byte* const rows =
          is_vertex ? all_.mesh.fields.bytes().data() : all_.middles.fields.bytes().data();
      std::array<float, kComponents> values;
      std::memcpy(values.data(), rows + (is_vertex ? i : i - vertices) * row_bytes + first,
                  sizeof(values));
      std::array<double, kComponents> wide;
      std::ranges::copy(values, wide.begin());
      const auto number = static_cast<std::int32_t>(i + 1);
      std::array<std::byte, sizeof(number) + sizeof(wide)> row;
      std::memcpy(row.data(), &number, sizeof(number));
      std::memcpy(row.data() + sizeof(number), wide.data(), sizeof(wide));
      return row;
    });
  }

  void write_values(std::size_t i) {
    const std::vector<FieldArray>& fields = all_.mesh.header.fields;
    std::size_t first = 0;
    for (std::size_t before = 0; before < i; ++before) {
      first += fields[before].components * sizeof(float);
    }
    writer_.text(absl::StrCat("$NodeData\n1\n\"", fields[i].name, "\"\n1\n0.0\n3\n0\n",
                              fields[i].components, "\n", all_.node_count(), "\n"));
    fields[i].components == 3 ? write_rows<3>(first) : write_rows<1>(first);
    writer_.text("\n$EndNodeData\n");
  }

  BlockWriter& writer_;
  const SecondOrderMesh& all_;
  std::vector<TetGroup> groups_;
  FaceGroups surfaces_;
};

}  // namespace

absl::Status write_second_order_msh(AtomicFile& file,
                                    const SecondOrderMesh& all,
                                    const WriteControl& control) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  const MeshHeader& header = all.mesh.header;
  if (!header.fields.empty() && all.node_count() > kMost) {
    return absl::FailedPreconditionError(absl::StrCat("a .msh with fields takes ", kMost,
                                                      " nodes and the mesh has ",
                                                      all.node_count(), ": write a .vtu"));
  }
  const std::uint64_t bytes = all.node_count() * 4 * 8 + header.tet_count * 11 * 8;
  BlockWriter writer(file, bytes, control);
  MshSections(writer, all).write();
  return writer.status();
}

}  // namespace tet
