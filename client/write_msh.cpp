#include "client/write_msh.h"

#include <array>
#include <limits>
#include <span>
#include <vector>

#include <absl/strings/str_cat.h>

#include "client/mesh_columns.h"
#include "core/mesh/regions.h"

namespace tet {
namespace {

constexpr std::int32_t kVolume = 3;       ///< the dimension of our entities
constexpr std::int32_t kTetrahedron = 4;  ///< Gmsh's number for a linear tetrahedron

/// Of a volume entity, and of the physical volume it makes up.
std::int32_t tag_of(MeshRegion region) noexcept { return static_cast<std::int32_t>(region); }

/// The volume entities of a file; all nodes are in the first.
std::span<const MeshRegion> volumes_of(const MeshHeader& header) noexcept {
  static constexpr std::array kVolumes{MeshRegion::kInside, MeshRegion::kOutside};
  return std::span(kVolumes).first(header.has_regions ? 2 : 1);
}

std::uint64_t file_bytes(const MeshHeader& header) noexcept {
  std::uint64_t fields = 0;
  for (const FieldArray& field : header.fields) {
    fields += header.vertex_count * (4 + 8 * field.components);
  }
  return header.vertex_count * 4 * 8 + header.tet_count * 5 * 8 + fields;
}

/// The format has 8 bytes for the number of a node, but 4 where it has data.
absl::Status check_node_numbers(const MeshHeader& header) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  if (header.fields.empty() || header.vertex_count <= kMost) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("a .msh with fields takes ", kMost, " vertices and the mesh has ",
                   header.vertex_count, ": write a .vtu or .vtkhdf"));
}

void write_physical_names(BlockWriter& writer) {
  writer.text("$PhysicalNames\n2\n3 1 \"inside\"\n3 2 \"outside\"\n$EndPhysicalNames\n");
}

void write_entities(BlockWriter& writer, const MeshHeader& header) {
  const WorldBox& box = header.bounds;
  const auto volumes = volumes_of(header);
  writer.text("$Entities\n");
  // Points, curves, surfaces, volumes.
  writer.number(std::array<std::uint64_t, 4>{0, 0, 0, volumes.size()});
  for (const MeshRegion region : volumes) {
    writer.number(tag_of(region));
    writer.number(std::array{box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z});
    writer.number(std::uint64_t{header.has_regions});  // physical tags
    if (header.has_regions) writer.number(tag_of(region));
    writer.number(std::uint64_t{0});  // bounding surfaces
  }
  writer.text("\n$EndEntities\n");
}

void write_nodes(BlockWriter& writer, const TetMesh& mesh) {
  const std::uint64_t count = mesh.header.vertex_count;
  writer.text("$Nodes\n");
  writer.number(
      std::array<std::uint64_t, 4>{1, count, 1, count});  // blocks, nodes, tags from, to
  const std::int32_t tag = tag_of(MeshRegion::kInside);
  writer.number(std::array<std::int32_t, 3>{kVolume, tag, 0});  // 0: not parametric
  writer.number(count);
  writer.rows(count, [](std::uint64_t i) { return i + 1; });
  writer.rows(count, [&](std::uint64_t i) {
    const auto [x, y, z] = mesh.vertex(i);
    return std::array{x, y, z};
  });
  writer.text("\n$EndNodes\n");
}

/// The tets of one volume, with their numbers in the mesh as tags.
void write_volume(BlockWriter& writer,
                  const TetMesh& mesh,
                  MeshRegion region,
                  std::uint64_t count) {
  writer.number(std::array<std::int32_t, 3>{kVolume, tag_of(region), kTetrahedron});
  writer.number(count);
  std::uint64_t next = 0;  // rows are made in order
  writer.rows(count, [&](std::uint64_t) {
    while (mesh.region(next) != region) ++next;
    const auto [a, b, c, d] = mesh.tet(next);
    return std::array<std::uint64_t, 5>{++next, a + 1, b + 1, c + 1, d + 1};
  });
}

struct FilledVolume {
  MeshRegion region;
  std::uint64_t tets;
};

/// Not those without a tet, for not every reader takes an empty block.
std::vector<FilledVolume> filled_volumes(const TetMesh& mesh) {
  std::vector<FilledVolume> filled;
  for (const MeshRegion region : volumes_of(mesh.header)) {
    const std::uint64_t tets = count_tets(mesh, region);
    if (tets > 0) filled.push_back({region, tets});
  }
  return filled;
}

void write_elements(BlockWriter& writer, const TetMesh& mesh) {
  const std::uint64_t count = mesh.header.tet_count;
  const auto volumes = filled_volumes(mesh);
  writer.text("$Elements\n");
  writer.number(std::array<std::uint64_t, 4>{volumes.size(), count, 1, count});
  for (const FilledVolume& volume : volumes) {
    write_volume(writer, mesh, volume.region, volume.tets);
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
  BlockWriter writer(file, file_bytes(mesh.header), control);
  writer.text("$MeshFormat\n4.1 1 8\n");  // binary, with eight-byte sizes
  writer.number(std::int32_t{1});         // tells a reader the byte order
  writer.text("\n$EndMeshFormat\n");
  if (mesh.header.has_regions) write_physical_names(writer);
  write_entities(writer, mesh.header);
  write_nodes(writer, mesh);
  write_elements(writer, mesh);
  for (std::size_t i = 0; i < mesh.header.fields.size(); ++i) write_node_data(writer, mesh, i);
  return writer.status();
}

}  // namespace tet
