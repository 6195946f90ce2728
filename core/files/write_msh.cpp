#include "core/files/write_msh.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>

#include "core/files/face_groups.h"
#include "core/files/mesh_columns.h"
#include "core/files/number_limits.h"
#include "core/files/tet_groups.h"

namespace tet {
namespace {

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

/// What the elements of a file belong to: all are in physical groups, as solvers take no
/// others.
struct FileEntities {
  std::vector<TetGroup> volumes;
  FaceGroups surfaces;
  explicit FileEntities(const TetMesh& mesh) : volumes(tet_groups(mesh)), surfaces(mesh) {}
};

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
absl::Status check_node_numbers(const FileMesh& mesh) {
  if (mesh.mesh.header.fields.empty()) return absl::OkStatus();
  return check_count(mesh.shape().nodes, kMostInt32, "vertices", ".msh with fields");
}

std::string physical_name(std::int32_t dimension, std::int32_t tag, const std::string& name) {
  const std::string quoted = absl::StrReplaceAll(name, {{"\"", "'"}});
  return absl::StrCat(dimension, " ", tag, " \"", quoted, "\"\n");
}

void write_physical_names(BlockWriter& writer, const FileEntities& entities) {
  const std::vector<FaceGroup>& surfaces = entities.surfaces.groups();
  std::string text =
      absl::StrCat("$PhysicalNames\n", entities.volumes.size() + surfaces.size(), "\n");
  for (const FaceGroup& surface : surfaces) {
    text += physical_name(kSurface, surface.tag, surface.name);
  }
  for (const TetGroup& volume : entities.volumes) {
    text += physical_name(kVolume, volume.tag, volume.name);
  }
  writer.text(text + "$EndPhysicalNames\n");
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

void write_entities(BlockWriter& writer, const WorldBox& bounds, const FileEntities& entities) {
  const std::vector<TetGroup>& volumes = entities.volumes;
  const std::vector<FaceGroup>& surfaces = entities.surfaces.groups();
  writer.text("$Entities\n");
  // Points, curves, surfaces, volumes.
  writer.number(std::array<std::uint64_t, 4>{0, 0, surfaces.size(), volumes.size()});
  for (const FaceGroup& surface : surfaces) write_entity(writer, surface.tag, bounds);
  for (const TetGroup& volume : volumes) write_entity(writer, volume.tag, bounds);
  writer.text("\n$EndEntities\n");
}

void write_nodes(BlockWriter& writer, const FileMesh& mesh, std::int32_t volume) {
  const std::uint64_t count = mesh.shape().nodes;
  writer.text("$Nodes\n");
  writer.number(
      std::array<std::uint64_t, 4>{1, count, 1, count});  // blocks, nodes, tags from, to
  // All are the first volume's; 0: not parametric.
  writer.number(std::array<std::int32_t, 3>{kVolume, volume, 0});
  writer.number(count);
  writer.rows_side_by_side(count, [](std::uint64_t i) { return i + 1; });
  writer.rows_side_by_side(count, [&](std::uint64_t i) {
    const auto [x, y, z] = mesh.node(i);
    return std::array{x, y, z};
  });
  writer.text("\n$EndNodes\n");
}

/// The tets of one volume, with their numbers in the mesh as tags.
template <std::size_t kNodes>
void write_volume(BlockWriter& writer, const FileMesh& mesh, const TetGroup& volume) {
  writer.number(std::array<std::int32_t, 3>{kVolume, volume.tag, element_type(kNodes)});
  writer.number(volume.tets);
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
  constexpr std::int32_t kType = element_type(kNodes == 4 ? 3 : 6);
  writer.number(std::array<std::int32_t, 3>{kSurface, surface.tag, kType});
  writer.number(surface.faces);
  const std::uint64_t first = mesh.mesh.header.tet_count + 1 + surface.first;
  writer.rows_side_by_side(surface.faces, [&](std::uint64_t i) {
    const TetFace face = faces[surface.first + i];
    return element(first + i,
                   nodes_of_face(mesh.nodes_of<kNodes>(face.tet()), face.opposite()));
  });
}

/// Tets come first, so that their tags are their numbers in the mesh.
void write_elements(BlockWriter& writer, const FileMesh& mesh, const FileEntities& entities) {
  std::vector<TetGroup> volumes = entities.volumes;
  // Not every reader takes an empty block.
  std::erase_if(volumes, [](const TetGroup& volume) { return volume.tets == 0; });
  const FaceGroups& faces = entities.surfaces;
  const std::uint64_t count = mesh.mesh.header.tet_count + faces.count();
  writer.text("$Elements\n");
  writer.number(
      std::array<std::uint64_t, 4>{volumes.size() + faces.groups().size(), count, 1, count});
  with_nodes_per_tet(mesh, [&](auto nodes) {
    constexpr std::size_t kNodes = decltype(nodes)::value;
    for (const TetGroup& volume : volumes) write_volume<kNodes>(writer, mesh, volume);
    for (const FaceGroup& surface : faces.groups()) {
      write_surface<kNodes>(writer, mesh, faces, surface);
    }
  });
  writer.text("\n$EndElements\n");
}

void write_node_data(BlockWriter& writer, const FileMesh& mesh, std::size_t i) {
  const FieldArray& field = mesh.mesh.header.fields[i];
  writer.text(absl::StrCat("$NodeData\n1\n\"", field.name, "\"\n"));
  writer.text("1\n0.0\n");  // the time
  // Its step, components, and nodes.
  writer.text(absl::StrCat("3\n0\n", field.components, "\n", mesh.shape().nodes, "\n"));
  write_numbered_field(writer, mesh, i);
  writer.text("\n$EndNodeData\n");
}

}  // namespace

absl::Status write_msh(AtomicFile& file, const FileMesh& mesh, const WriteControl& control) {
  if (auto status = check_node_numbers(mesh); !status.ok()) return status;
  const MeshHeader& header = mesh.mesh.header;
  const FileEntities entities(mesh.mesh);
  BlockWriter writer(file, file_bytes(mesh, entities.surfaces.count()), control);
  writer.text("$MeshFormat\n4.1 1 8\n");  // binary, with eight-byte sizes
  writer.number(std::int32_t{1});         // tells a reader the byte order
  writer.text("\n$EndMeshFormat\n");
  write_physical_names(writer, entities);
  write_entities(writer, header.bounds, entities);
  write_nodes(writer, mesh, entities.volumes.front().tag);
  write_elements(writer, mesh, entities);
  for (std::size_t i = 0; i < header.fields.size(); ++i) write_node_data(writer, mesh, i);
  return writer.status();
}

}  // namespace tet
