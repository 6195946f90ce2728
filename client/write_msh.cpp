#include "client/write_msh.h"

#include <array>
#include <span>
#include <vector>

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
  return header.vertex_count * 4 * 8 + header.tet_count * 5 * 8;
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

}  // namespace

absl::Status write_msh(AtomicFile& file, const TetMesh& mesh, const WriteControl& control) {
  BlockWriter writer(file, file_bytes(mesh.header), control);
  writer.text("$MeshFormat\n4.1 1 8\n");  // binary, with eight-byte sizes
  writer.number(std::int32_t{1});         // tells a reader the byte order
  writer.text("\n$EndMeshFormat\n");
  if (mesh.header.has_regions) write_physical_names(writer);
  write_entities(writer, mesh.header);
  write_nodes(writer, mesh);
  write_elements(writer, mesh);
  return writer.status();
}

}  // namespace tet
