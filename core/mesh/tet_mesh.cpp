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

TetMesh::TetMesh(const MeshHeader& mesh_header)
    : header(mesh_header),
      positions(mesh_header.vertex_count * 3 * size_of(mesh_header.coordinate_type)),
      tets(mesh_header.tet_count * 4 * size_of(mesh_header.index_type)) {}

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

std::span<std::byte> TetMesh::positions_of(const ChunkExtent& chunk) noexcept {
  const std::size_t row = 3 * size_of(header.coordinate_type);
  return positions.bytes().subspan(chunk.first_vertex * row, chunk.vertex_count * row);
}

std::span<std::byte> TetMesh::tets_of(const ChunkExtent& chunk) noexcept {
  const std::size_t row = 4 * size_of(header.index_type);
  return tets.bytes().subspan(chunk.first_tet * row, chunk.tet_count * row);
}

}  // namespace tet
