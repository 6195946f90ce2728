#include "core/mesh/tet_mesh.h"

#include <algorithm>

namespace tet {
namespace {

template <class Number, std::size_t N>
void write_row(std::span<std::byte> column,
               std::uint64_t row,
               const std::array<Number, N>& numbers) noexcept {
  std::memcpy(column.data() + row * sizeof(numbers), numbers.data(), sizeof(numbers));
}

}  // namespace

TetMesh::TetMesh(const MeshHeader& mesh_header)
    : header(mesh_header),
      positions(mesh_header.vertex_count * 3 * size_of(mesh_header.coordinate_type)),
      tets(mesh_header.tet_count * 4 * size_of(mesh_header.index_type)) {}

void TetMesh::store_position(std::uint64_t i, const WorldPoint& position) noexcept {
  const auto [x, y, z] = position;
  if (header.coordinate_type == CoordinateType::kFloat64) {
    write_row<double, 3>(positions.bytes(), i, {x, y, z});
  } else {
    const auto round = [](double v) { return static_cast<float>(v); };
    write_row<float, 3>(positions.bytes(), i, {round(x), round(y), round(z)});
  }
}

WorldPoint TetMesh::vertex(std::uint64_t i) const noexcept {
  const auto [x, y, z] = stored_position(i);
  return {header.origin.x + x, header.origin.y + y, header.origin.z + z};
}

void MeshView::load(std::uint64_t first, std::size_t count, TetBatch& batch) const noexcept {
  for (std::size_t lane = 0; lane < TetBatch::kSize; ++lane) {
    const auto corners = tet(first + std::min(lane, count - 1));
    for (std::size_t k = 0; k < 4; ++k) batch.set(lane, k, stored_position(corners[k]));
  }
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
