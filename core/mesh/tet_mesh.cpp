#include "core/mesh/tet_mesh.h"

#include <algorithm>
#include <utility>

#include "core/base/vector_clones.h"

namespace tet {
namespace {

template <class Number, std::size_t N>
void write_row(std::span<std::byte> column,
               std::uint64_t row,
               const std::array<Number, N>& numbers) noexcept {
  std::memcpy(column.data() + row * sizeof(numbers), numbers.data(), sizeof(numbers));
}

template <class Number, std::size_t N>
std::array<Number, N> row_of(std::span<const std::byte> column, std::uint64_t row) noexcept {
  std::array<Number, N> numbers;
  std::memcpy(numbers.data(), column.data() + row * sizeof(numbers), sizeof(numbers));
  return numbers;
}

template <class Id>
std::uint64_t largest_id(std::span<const std::byte> ids) noexcept {
  Id largest = 0;
  for (std::size_t i = 0; i < ids.size(); i += sizeof(Id)) {
    Id id = 0;
    std::memcpy(&id, ids.data() + i, sizeof id);
    largest = std::max(largest, id);
  }
  return largest;
}

}  // namespace

double MeshHeader::spacing_at(std::uint64_t tet) const noexcept {
  const auto after = std::ranges::upper_bound(parts, tet, {}, &MeshPart::first_tet);
  return after == parts.begin() ? spacing : (after - 1)->spacing;
}

TET_VECTOR_CLONES
bool ids_are_within(std::span<const std::byte> ids, const MeshHeader& header) noexcept {
  const std::uint64_t largest = header.index_type == IndexType::kUint64
                                    ? largest_id<std::uint64_t>(ids)
                                    : largest_id<std::uint32_t>(ids);
  return ids.empty() || largest < header.vertex_count;
}

TetMesh::TetMesh(const MeshHeader& mesh_header) : header(mesh_header) {
  const ChunkSizes sizes(header, whole_of(header));
  positions = ByteBuffer(sizes.positions);
  tets = ByteBuffer(sizes.tets);
  regions = ByteBuffer(sizes.regions);
  fields = ByteBuffer(sizes.fields);
  faces = ByteBuffer(sizes.faces);
  face_tets = ByteBuffer(sizes.face_tets);
  face_labels = ByteBuffer(sizes.face_labels);
}

TetMesh::TetMesh(const MeshHeader& mesh_header, TetMesh&& used) : header(mesh_header) {
  const ChunkSizes sizes(header, whole_of(header));
  positions = ByteBuffer(sizes.positions, std::move(used.positions));
  tets = ByteBuffer(sizes.tets, std::move(used.tets));
  regions = ByteBuffer(sizes.regions, std::move(used.regions));
  fields = ByteBuffer(sizes.fields, std::move(used.fields));
  faces = ByteBuffer(sizes.faces, std::move(used.faces));
  face_tets = ByteBuffer(sizes.face_tets, std::move(used.face_tets));
  face_labels = ByteBuffer(sizes.face_labels, std::move(used.face_labels));
}

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

Triangle TetMesh::face(std::uint64_t i) const noexcept {
  if (header.index_type == IndexType::kUint64) {
    return row_of<std::uint64_t, 3>(faces.bytes(), i);
  }
  const auto [a, b, c] = row_of<std::uint32_t, 3>(faces.bytes(), i);
  return {a, b, c};
}

std::uint64_t TetMesh::face_tet(std::uint64_t i) const noexcept {
  if (header.index_type == IndexType::kUint64) {
    return row_of<std::uint64_t, 1>(face_tets.bytes(), i)[0];
  }
  return row_of<std::uint32_t, 1>(face_tets.bytes(), i)[0];
}

std::uint16_t TetMesh::face_label(std::uint64_t i) const noexcept {
  return row_of<std::uint16_t, 1>(face_labels.bytes(), i)[0];
}

MeshRegion TetMesh::region(std::uint64_t i) const noexcept {
  if (!header.has_regions) return MeshRegion::kInside;
  return static_cast<MeshRegion>(regions.bytes()[i]);
}

LabelNumber TetMesh::label(std::uint64_t i) const noexcept {
  LabelNumber label = 0;
  std::memcpy(&label, regions.bytes().data() + i * sizeof(label), sizeof(label));
  return label;
}

ChunkColumns TetMesh::columns_of(const ChunkExtent& chunk) noexcept {
  const ChunkSizes before = ChunkSizes::before(header, chunk);
  const ChunkSizes size(header, chunk);
  return {positions.bytes().subspan(before.positions, size.positions),
          tets.bytes().subspan(before.tets, size.tets),
          regions.bytes().subspan(before.regions, size.regions),
          fields.bytes().subspan(before.fields, size.fields),
          faces.bytes().subspan(before.faces, size.faces),
          face_tets.bytes().subspan(before.face_tets, size.face_tets),
          face_labels.bytes().subspan(before.face_labels, size.face_labels)};
}

ConstColumns TetMesh::columns() const noexcept {
  ConstColumns columns;
  columns.positions = positions.bytes();
  columns.tets = tets.bytes();
  columns.regions = regions.bytes();
  columns.fields = fields.bytes();
  columns.faces = faces.bytes();
  columns.face_tets = face_tets.bytes();
  columns.face_labels = face_labels.bytes();
  return columns;
}

MeshHeader header_of_chunk(const MeshHeader& header, const ChunkExtent& chunk) {
  MeshHeader of_chunk = header;
  of_chunk.vertex_count = chunk.vertex_count;
  of_chunk.tet_count = chunk.tet_count;
  of_chunk.face_count = chunk.face_count;
  return of_chunk;
}

}  // namespace tet
