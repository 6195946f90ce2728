#include "core/files/write_msh.h"

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>

#include "core/files/mesh_columns.h"
#include "core/files/msh_surfaces.h"
#include "core/mesh/regions.h"

namespace tet {
namespace {

constexpr std::int32_t kVolume = 3;       ///< the dimension of our entities
constexpr std::int32_t kTetrahedron = 4;  ///< Gmsh's number for a linear tetrahedron

/// A volume entity, and the physical volume that it makes up.
struct FileVolume {
  std::int32_t tag = 1;
  std::string name = {};
  std::optional<MeshRegion> region =
      {};  ///< of its tets; they are all that follow each other if unset
  std::uint64_t first_tet = 0, tets = 0;
};

/// What the elements of a file belong to.
struct FileEntities {
  std::vector<FileVolume> volumes;
  std::vector<MshSurface> surfaces;
};

/// The volumes of a file, in the order of their tags, which are the tets' labels.
std::vector<FileVolume> volumes_of(const TetMesh& mesh) {
  const MeshHeader& header = mesh.header;
  std::vector<FileVolume> volumes;
  for (const MeshPart& part : header.parts) {
    const auto tag = static_cast<std::int32_t>(volumes.size() + 1);
    volumes.push_back({tag, part.name, {}, part.first_tet, part.tet_count});
  }
  if (!volumes.empty()) return volumes;
  if (!header.has_regions) {
    return {FileVolume{.name = "inside", .tets = header.tet_count}};
  }
  for (const auto& [region, name] :
       {std::pair(MeshRegion::kInside, "inside"), std::pair(MeshRegion::kOutside, "outside")}) {
    volumes.push_back(
        {static_cast<std::int32_t>(region), name, region, 0, count_tets(mesh, region)});
  }
  return volumes;
}

/// All elements are in physical groups, as solvers take no others.
FileEntities entities_of(const TetMesh& mesh) { return {volumes_of(mesh), msh_surfaces(mesh)}; }

std::uint64_t file_bytes(const MeshHeader& header, std::uint64_t triangles) noexcept {
  std::uint64_t fields = 0;
  for (const FieldArray& field : header.fields) {
    fields += header.vertex_count * (4 + 8 * field.components);
  }
  return header.vertex_count * 4 * 8 + header.tet_count * 5 * 8 + triangles * 4 * 8 + fields;
}

/// The format has 8 bytes for the number of a node, but 4 where it has data.
absl::Status check_node_numbers(const MeshHeader& header) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  if (header.fields.empty() || header.vertex_count <= kMost) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("a .msh with fields takes ", kMost, " vertices and the mesh has ",
                   header.vertex_count, ": write a .vtu or .vtkhdf"));
}

std::string physical_name(std::int32_t dimension, std::int32_t tag, const std::string& name) {
  const std::string quoted = absl::StrReplaceAll(name, {{"\"", "'"}});
  return absl::StrCat(dimension, " ", tag, " \"", quoted, "\"\n");
}

void write_physical_names(BlockWriter& writer, const FileEntities& entities) {
  const auto& [volumes, surfaces] = entities;
  std::string text = absl::StrCat("$PhysicalNames\n", volumes.size() + surfaces.size(), "\n");
  for (const MshSurface& surface : surfaces) {
    text += physical_name(kMshSurface, surface.tag, surface.name);
  }
  for (const FileVolume& volume : volumes) {
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
  const auto& [volumes, surfaces] = entities;
  writer.text("$Entities\n");
  // Points, curves, surfaces, volumes.
  writer.number(std::array<std::uint64_t, 4>{0, 0, surfaces.size(), volumes.size()});
  for (const MshSurface& surface : surfaces) write_entity(writer, surface.tag, bounds);
  for (const FileVolume& volume : volumes) write_entity(writer, volume.tag, bounds);
  writer.text("\n$EndEntities\n");
}

void write_nodes(BlockWriter& writer, const TetMesh& mesh) {
  const std::uint64_t count = mesh.header.vertex_count;
  writer.text("$Nodes\n");
  writer.number(
      std::array<std::uint64_t, 4>{1, count, 1, count});  // blocks, nodes, tags from, to
  // All are the first volume's; 0: not parametric.
  writer.number(std::array<std::int32_t, 3>{kVolume, 1, 0});
  writer.number(count);
  writer.rows(count, [](std::uint64_t i) { return i + 1; });
  writer.rows(count, [&](std::uint64_t i) {
    const auto [x, y, z] = mesh.vertex(i);
    return std::array{x, y, z};
  });
  writer.text("\n$EndNodes\n");
}

/// The tets of one volume, with their numbers in the mesh as tags.
void write_volume(BlockWriter& writer, const TetMesh& mesh, const FileVolume& volume) {
  writer.number(std::array<std::int32_t, 3>{kVolume, volume.tag, kTetrahedron});
  writer.number(volume.tets);
  std::uint64_t next = volume.first_tet;  // rows are made in order
  writer.rows(volume.tets, [&](std::uint64_t) {
    while (volume.region && mesh.region(next) != *volume.region) ++next;
    const auto [a, b, c, d] = mesh.tet(next);
    return std::array<std::uint64_t, 5>{++next, a + 1, b + 1, c + 1, d + 1};
  });
}

/// Tets come first, so that their tags are their numbers in the mesh.
void write_elements(BlockWriter& writer, const TetMesh& mesh, FileEntities entities) {
  auto& [volumes, surfaces] = entities;
  // Not every reader takes an empty block.
  std::erase_if(volumes, [](const FileVolume& volume) { return volume.tets == 0; });
  const std::uint64_t tets = mesh.header.tet_count, count = tets + count_triangles(surfaces);
  writer.text("$Elements\n");
  writer.number(
      std::array<std::uint64_t, 4>{volumes.size() + surfaces.size(), count, 1, count});
  for (const FileVolume& volume : volumes) write_volume(writer, mesh, volume);
  std::uint64_t next = tets + 1;
  for (const MshSurface& surface : surfaces) {
    write_triangles(writer, surface, next);
    next += surface.triangles.size();
  }
  writer.text("\n$EndElements\n");
}

void write_node_data(BlockWriter& writer, const TetMesh& mesh, std::size_t i) {
  const FieldArray& field = mesh.header.fields[i];
  writer.text(absl::StrCat("$NodeData\n1\n\"", field.name, "\"\n"));
  writer.text("1\n0.0\n");  // the time
  // Its step, components, and nodes.
  writer.text(absl::StrCat("3\n0\n", field.components, "\n", mesh.header.vertex_count, "\n"));
  write_numbered_field(writer, mesh, i);
  writer.text("\n$EndNodeData\n");
}

}  // namespace

absl::Status write_msh(AtomicFile& file, const TetMesh& mesh, const WriteControl& control) {
  if (auto status = check_node_numbers(mesh.header); !status.ok()) return status;
  const FileEntities entities = entities_of(mesh);
  BlockWriter writer(file, file_bytes(mesh.header, count_triangles(entities.surfaces)),
                     control);
  writer.text("$MeshFormat\n4.1 1 8\n");  // binary, with eight-byte sizes
  writer.number(std::int32_t{1});         // tells a reader the byte order
  writer.text("\n$EndMeshFormat\n");
  write_physical_names(writer, entities);
  write_entities(writer, mesh.header.bounds, entities);
  write_nodes(writer, mesh);
  write_elements(writer, mesh, entities);
  for (std::size_t i = 0; i < mesh.header.fields.size(); ++i) write_node_data(writer, mesh, i);
  return writer.status();
}

}  // namespace tet
