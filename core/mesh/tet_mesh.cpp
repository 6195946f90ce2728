#include "core/mesh/tet_mesh.h"

namespace tet {
namespace {

template <class Number, std::size_t N>
std::array<Number, N> read_row(std::span<const std::byte> column, std::uint64_t row) noexcept {
  std::array<Number, N> numbers;
  std::memcpy(numbers.data(), column.data() + row * sizeof(numbers), sizeof(numbers));
  return numbers;
}

}  // namespace

TetMesh::TetMesh(const MeshHeader& mesh_header) : header(mesh_header) {
  const ChunkSizes sizes(header, header.vertex_count, header.tet_count);
  positions = ByteBuffer(sizes.positions);
  tets = ByteBuffer(sizes.tets);
  regions = ByteBuffer(sizes.regions);
}

WorldPoint TetMesh::stored_position(std::uint64_t i) const noexcept {
  if (header.coordinate_type == CoordinateType::kFloat64) {
    const auto [x, y, z] = read_row<double, 3>(positions.bytes(), i);
    return {x, y, z};
  }
  const auto [x, y, z] = read_row<float, 3>(positions.bytes(), i);
  return {x, y, z};
}

WorldPoint TetMesh::vertex(std::uint64_t i) const noexcept {
  const auto [x, y, z] = stored_position(i);
  return {header.origin.x + x, header.origin.y + y, header.origin.z + z};
}

std::array<std::uint64_t, 4> TetMesh::tet(std::uint64_t i) const noexcept {
  if (header.index_type == IndexType::kUint64) {
    return read_row<std::uint64_t, 4>(tets.bytes(), i);
  }
  const auto [a, b, c, d] = read_row<std::uint32_t, 4>(tets.bytes(), i);
  return {a, b, c, d};
}

MeshRegion TetMesh::region(std::uint64_t i) const noexcept {
  if (!header.has_regions) return MeshRegion::kInside;
  return static_cast<MeshRegion>(regions.bytes()[i]);
}

ChunkColumns TetMesh::columns_of(const ChunkExtent& chunk) noexcept {
  const ChunkSizes before(header, chunk.first_vertex, chunk.first_tet);
  const ChunkSizes size(header, chunk.vertex_count, chunk.tet_count);
  return {positions.bytes().subspan(before.positions, size.positions),
          tets.bytes().subspan(before.tets, size.tets),
          regions.bytes().subspan(before.regions, size.regions)};
}

}  // namespace tet
