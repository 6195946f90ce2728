#include "client/write_msh.h"

#include <array>

namespace tet {
namespace {

constexpr std::int32_t kVolume = 3;  ///< the dimension of our only entity
constexpr std::int32_t kEntityTag = 1;
constexpr std::int32_t kTetrahedron = 4;  ///< Gmsh's number for a linear tetrahedron

std::uint64_t file_bytes(const MeshHeader& header) noexcept {
  return header.vertex_count * 4 * 8 + header.tet_count * 5 * 8;
}

void write_entities(BlockWriter& writer, const WorldBox& box) {
  writer.text("$Entities\n");
  writer.number(std::array<std::uint64_t, 4>{0, 0, 0, 1});  // points, curves, surfaces, volumes
  writer.number(kEntityTag);
  writer.number(std::array{box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z});
  writer.number(std::array<std::uint64_t, 2>{0, 0});  // physical tags, bounding surfaces
  writer.text("\n$EndEntities\n");
}

void write_nodes(BlockWriter& writer, const TetMesh& mesh) {
  const std::uint64_t count = mesh.header.vertex_count;
  writer.text("$Nodes\n");
  writer.number(
      std::array<std::uint64_t, 4>{1, count, 1, count});  // blocks, nodes, tags from, to
  writer.number(std::array<std::int32_t, 3>{kVolume, kEntityTag, 0});  // 0: not parametric
  writer.number(count);
  writer.rows(count, [](std::uint64_t i) { return i + 1; });
  writer.rows(count, [&](std::uint64_t i) {
    const auto [x, y, z] = mesh.vertex(i);
    return std::array{x, y, z};
  });
  writer.text("\n$EndNodes\n");
}

void write_elements(BlockWriter& writer, const TetMesh& mesh) {
  const std::uint64_t count = mesh.header.tet_count;
  writer.text("$Elements\n");
  writer.number(std::array<std::uint64_t, 4>{1, count, 1, count});
  writer.number(std::array<std::int32_t, 3>{kVolume, kEntityTag, kTetrahedron});
  writer.number(count);
  writer.rows(count, [&](std::uint64_t i) {
    const auto [a, b, c, d] = mesh.tet(i);
    return std::array<std::uint64_t, 5>{i + 1, a + 1, b + 1, c + 1, d + 1};
  });
  writer.text("\n$EndElements\n");
}

}  // namespace

absl::Status write_msh(AtomicFile& file, const TetMesh& mesh, const WriteControl& control) {
  BlockWriter writer(file, file_bytes(mesh.header), control);
  writer.text("$MeshFormat\n4.1 1 8\n");  // binary, with eight-byte sizes
  writer.number(std::int32_t{1});         // tells a reader the byte order
  writer.text("\n$EndMeshFormat\n");
  write_entities(writer, mesh.header.bounds);
  write_nodes(writer, mesh);
  write_elements(writer, mesh);
  return writer.status();
}

}  // namespace tet
