#include "core/files/write_msh.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>

#include "core/files/face_groups.h"
#include "core/files/mesh_columns.h"
#include "core/files/number_limits.h"
#include "core/files/tet_groups.h"
#include "core/mesh/faces.h"

namespace tet {
namespace {

/// What the elements of a file belong to: all are in physical groups, as solvers take no
/// others. Volumes may be empty, surfaces are not.
struct MshGroups {
  std::vector<TetGroup> volumes;
  std::vector<FaceGroup> surfaces;
};

constexpr std::int32_t kSurface = 2, kVolume = 3;  ///< dimensions of our entities
/// Gmsh's numbers for elements of so many nodes.
constexpr std::int32_t element_type(std::size_t nodes) {
  switch (nodes) {
    case 3:
      return 2;
    case 4:
      return 4;
    case 6:
      return 9;
    default:
      return 11;
  }
}

std::uint64_t file_bytes(const FileMesh& mesh, std::uint64_t triangles) noexcept {
  const MeshHeader& header = mesh.mesh.header;
  const auto [nodes, nodes_per_tet] = mesh.shape();
  std::uint64_t fields = 0;
  for (const FieldArray& field : header.fields) fields += nodes * (4 + 8 * field.components);
  return nodes * 4 * 8 + header.tet_count * (1 + nodes_per_tet) * 8 +
         triangles * (nodes_per_tet == 4 ? 4 : 7) * 8 + fields;
}

/// The number of an element and those of its nodes, which the file counts from 1.
template <std::size_t kNodes>
std::array<std::uint64_t, 1 + kNodes> element(std::uint64_t number,
                                              const std::array<std::uint64_t, kNodes>& nodes) {
  std::array<std::uint64_t, 1 + kNodes> row;
  row[0] = number;
  for (std::size_t i = 0; i < kNodes; ++i) row[i + 1] = nodes[i] + 1;
  return row;
}

/// The format has 8 bytes for the number of a node, but 4 where it has data.
absl::Status check_node_numbers(const MeshHeader& header, const FileShape& shape) {
  if (header.fields.empty()) return absl::OkStatus();
  return check_count(shape.nodes, kMostInt32, "vertices", ".msh with fields");
}

/// A line for each of these groups, which are of one dimension.
template <class Group>
std::string physical_names(std::int32_t dimension, const std::vector<Group>& groups) {
  const std::vector<std::string> names = names_in_file(names_of(groups), kMshNames);
  std::string text;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    absl::StrAppend(&text, dimension, " ", groups[i].tag, " \"", names[i], "\"\n");
  }
  return text;
}

void write_physical_names(BlockWriter& writer, const MshGroups& groups) {
  writer.text(absl::StrCat("$PhysicalNames\n", groups.volumes.size() + groups.surfaces.size(),
                           "\n", physical_names(kSurface, groups.surfaces),
                           physical_names(kVolume, groups.volumes), "$EndPhysicalNames\n"));
}

/// An entity with the whole mesh's bounds, a physical group of its own, and nothing said of
/// what bounds it.
void write_entity(BlockWriter& writer, std::int32_t tag, const WorldBox& box) {
  writer.number(tag);
  writer.number(std::array{box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z});
  writer.number(std::uint64_t{1});  // physical tags
  writer.number(tag);
  writer.number(std::uint64_t{0});  // bounding entities
}

void write_entities(BlockWriter& writer, const WorldBox& bounds, const MshGroups& groups) {
  writer.text("$Entities\n");
  // Points, curves, surfaces, volumes.
  writer.number(
      std::array<std::uint64_t, 4>{0, 0, groups.surfaces.size(), groups.volumes.size()});
  for (const FaceGroup& surface : groups.surfaces) write_entity(writer, surface.tag, bounds);
  for (const TetGroup& volume : groups.volumes) write_entity(writer, volume.tag, bounds);
  writer.text("\n$EndEntities\n");
}

/// Leaves room for a column, and returns where it begins.
std::uint64_t leave_room(BlockWriter& writer, std::uint64_t rows, std::uint64_t row_bytes) {
  const std::uint64_t begin = writer.position();
  writer.move_to(begin + rows * row_bytes);
  return begin;
}

/// Bytes of an element's row: its number, and those of its nodes.
constexpr std::uint64_t element_bytes(std::size_t nodes) noexcept {
  return (1 + nodes) * sizeof(std::uint64_t);
}

/// Begins a block of elements, and returns where their rows do.
std::uint64_t begin_elements(BlockWriter& writer,
                             std::int32_t dimension,
                             std::int32_t tag,
                             std::size_t nodes,
                             std::uint64_t count) {
  writer.number(std::array<std::int32_t, 3>{dimension, tag, element_type(nodes)});
  writer.number(count);
  return leave_room(writer, count, element_bytes(nodes));
}

/// A number of four bytes and a field's values as doubles.
constexpr std::uint64_t field_row_bytes(const FieldArray& field) noexcept {
  return sizeof(std::int32_t) + field.components * sizeof(double);
}

/// Numbers of nodes from `first` on, counted from 1.
void write_node_numbers(BlockWriter& writer, std::uint64_t first, std::uint64_t count) {
  writer.rows_side_by_side(count, [&](std::uint64_t i) { return first + i + 1; });
}

void write_node_points(BlockWriter& writer, const FileMesh& mesh) {
  writer.rows_side_by_side(mesh.shape().nodes, [&](std::uint64_t i) {
    const auto [x, y, z] = mesh.node(i);
    return std::array{x, y, z};
  });
}

/// The tets of one volume, with their numbers in the mesh as tags.
template <std::size_t kNodes>
void write_volume(BlockWriter& writer, const FileMesh& mesh, const TetGroup& volume) {
  const auto row = [&](std::uint64_t tet) {
    auto nodes = mesh.nodes_of<kNodes>(tet);
    if constexpr (kNodes == 10) std::swap(nodes[8], nodes[9]);  // Gmsh's order
    return element(tet + 1, nodes);
  };
  if (volume.region) {
    TetsOfGroup tets(mesh.mesh, volume);
    writer.rows(volume.tets, [&](std::uint64_t) { return row(tets.next()); });
  } else {
    writer.rows_side_by_side(volume.tets, [&](std::uint64_t i) { return row(volume.tet(i)); });
  }
}

/// The triangles of one surface, numbered behind the tets.
template <std::size_t kNodes>
void write_surface(BlockWriter& writer,
                   const FileMesh& mesh,
                   const FaceGroups& faces,
                   const FaceGroup& surface) {
  const std::uint64_t first = mesh.mesh.header.tet_count + 1 + surface.first;
  writer.rows_side_by_side(surface.faces, [&](std::uint64_t i) {
    const TetFace face = faces[surface.first + i];
    return element(first + i,
                   nodes_of_face(mesh.nodes_of<kNodes>(face.tet()), face.opposite()));
  });
}

/// Writes everything of a file but the rows of its columns.
absl::StatusOr<MshColumns> begin_msh(BlockWriter& writer,
                                     const MeshHeader& header,
                                     const FileShape& shape,
                                     const MshGroups& groups) {
  if (auto status = check_node_numbers(header, shape); !status.ok()) return status;
  MshColumns columns{.tet_count = header.tet_count};
  writer.text("$MeshFormat\n4.1 1 8\n");  // binary, with eight-byte sizes
  writer.number(std::int32_t{1});         // tells a reader the byte order
  writer.text("\n$EndMeshFormat\n");
  write_physical_names(writer, groups);
  write_entities(writer, header.bounds, groups);

  writer.text("$Nodes\n");
  // Blocks, nodes, tags from, to.
  writer.number(std::array<std::uint64_t, 4>{1, shape.nodes, 1, shape.nodes});
  // All are the first volume's; 0: not parametric.
  writer.number(std::array<std::int32_t, 3>{kVolume, groups.volumes.front().tag, 0});
  writer.number(shape.nodes);
  columns.numbers = leave_room(writer, shape.nodes, sizeof(std::uint64_t));
  columns.points = leave_room(writer, shape.nodes, 3 * sizeof(double));
  writer.text("\n$EndNodes\n$Elements\n");

  // Not every reader takes an empty block.
  const auto blocks = static_cast<std::uint64_t>(std::ranges::count_if(
      groups.volumes, [](const TetGroup& volume) { return volume.tets > 0; }));
  std::uint64_t count = header.tet_count;
  for (const FaceGroup& surface : groups.surfaces) count += surface.faces;
  writer.number(std::array<std::uint64_t, 4>{blocks + groups.surfaces.size(), count, 1, count});
  // Tets come first, so that their tags are their numbers in the mesh.
  for (const TetGroup& volume : groups.volumes) {
    columns.volumes.push_back(
        volume.tets == 0
            ? 0
            : begin_elements(writer, kVolume, volume.tag, shape.nodes_per_tet, volume.tets));
  }
  const std::size_t nodes_per_face = shape.nodes_per_tet == 4 ? 3 : 6;
  for (const FaceGroup& surface : groups.surfaces) {
    columns.surfaces.push_back(
        begin_elements(writer, kSurface, surface.tag, nodes_per_face, surface.faces));
  }
  writer.text("\n$EndElements\n");
  for (const FieldArray& field : header.fields) {
    writer.text(absl::StrCat("$NodeData\n1\n\"", field.name, "\"\n"));
    writer.text("1\n0.0\n");  // the time
    // Its step, components, and nodes.
    writer.text(absl::StrCat("3\n0\n", field.components, "\n", shape.nodes, "\n"));
    columns.fields.push_back(leave_room(writer, shape.nodes, field_row_bytes(field)));
    writer.text("\n$EndNodeData\n");
  }
  if (!writer.status().ok()) return writer.status();
  return columns;
}

}  // namespace

absl::Status write_msh(AtomicFile& file, const FileMesh& mesh, const WriteControl& control) {
  const FaceGroups faces(mesh.mesh, control.stop());
  const MshGroups groups{tet_groups(mesh.mesh), faces.groups()};
  const FileShape shape = mesh.shape();
  BlockWriter writer(file, file_bytes(mesh, faces.count()), control);
  const auto columns = begin_msh(writer, mesh.mesh.header, shape, groups);
  if (!columns.ok()) return columns.status();
  writer.move_to(columns->numbers);
  write_node_numbers(writer, 0, shape.nodes);
  writer.move_to(columns->points);
  write_node_points(writer, mesh);
  with_nodes_per_tet(mesh, [&](auto nodes) {
    constexpr std::size_t kNodes = decltype(nodes)::value;
    for (std::size_t i = 0; i < groups.volumes.size(); ++i) {
      writer.move_to(columns->volumes[i]);
      write_volume<kNodes>(writer, mesh, groups.volumes[i]);
    }
    for (std::size_t i = 0; i < groups.surfaces.size(); ++i) {
      writer.move_to(columns->surfaces[i]);
      write_surface<kNodes>(writer, mesh, faces, groups.surfaces[i]);
    }
  });
  for (std::size_t i = 0; i < columns->fields.size(); ++i) {
    writer.move_to(columns->fields[i]);
    write_numbered_field(writer, mesh, i, 0);
  }
  return writer.status();
}

bool msh_takes_parts(const MeshHeader& header) noexcept {
  return header.face_labels.size() == 1 && !header.has_regions && header.labels.empty() &&
         header.parts.empty();
}

absl::StatusOr<MshColumns> begin_msh_of_parts(BlockWriter& writer, const MeshHeader& header) {
  MshGroups groups{{TetGroup{.name = "inside", .tets = header.tet_count}}, {}};
  if (header.face_count > 0) {
    const FaceLabel& label = header.face_labels.front();
    groups.surfaces.push_back({1, label.name, label.kind, 0, header.face_count});
  }
  return begin_msh(writer, header, shape_of(header), groups);
}

void write_msh_part(BlockWriter& writer,
                    const MshColumns& columns,
                    const TetMesh& part,
                    const ChunkExtent& place) {
  const FileMesh mesh{part};
  writer.move_to(columns.numbers + place.first_vertex * sizeof(std::uint64_t));
  write_node_numbers(writer, place.first_vertex, place.vertex_count);
  writer.move_to(columns.points + place.first_vertex * 3 * sizeof(double));
  write_node_points(writer, mesh);
  if (place.tet_count > 0) {
    writer.move_to(columns.volumes.front() + place.first_tet * element_bytes(4));
    writer.rows_side_by_side(place.tet_count, [&](std::uint64_t i) {
      return element(place.first_tet + i + 1, part.tet(i));
    });
  }
  if (place.face_count > 0) {
    writer.move_to(columns.surfaces.front() + place.first_face * element_bytes(3));
    const std::uint64_t first = columns.tet_count + place.first_face + 1;
    writer.rows_side_by_side(place.face_count, [&](std::uint64_t i) {
      const auto tet = part.tet(part.face_tet(i) - place.first_tet);
      return element(first + i, face_of(tet, opposite_corner(tet, part.face(i))));
    });
  }
  for (std::size_t i = 0; i < columns.fields.size(); ++i) {
    writer.move_to(columns.fields[i] +
                   place.first_vertex * field_row_bytes(part.header.fields[i]));
    write_numbered_field(writer, mesh, i, place.first_vertex);
  }
}

}  // namespace tet
