// Packed chunks that no server wrote: refused, or ids of vertices; and columns of any bytes,
// which come back as they were.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "core/mesh/packed/packed_chunk.h"
#include "tests/fuzz/fuzz_target.h"

namespace tet::packed_chunk_fuzz {
namespace {

using namespace tet;
using Bytes = std::vector<std::byte>;

/// What the first bytes of an input say, and no more than is quick.
struct Input {
  MeshHeader header;
  ChunkExtent extent;

  Input(std::span<const std::byte, 8> bytes) {
    std::uint16_t numbers[4];
    std::memcpy(numbers, bytes.data(), sizeof(numbers));
    const auto& [flags, before, vertices, tets] = numbers;
    if ((flags & 1) != 0) header.coordinate_type = CoordinateType::kFloat64;
    if ((flags & 2) != 0) header.index_type = IndexType::kUint64;
    header.has_regions = (flags & 4) != 0;
    if ((flags & 8) != 0) header.fields = {{"t", 1}, {"v", 3}};
    extent = {before, vertices, 0, tets};
    if ((flags & 16) != 0) {
      header.face_labels = {{.name = "surface"}, {.name = "cut_x_min"}, {.name = "cut_x_max"}};
      extent.face_count = std::min<std::uint64_t>(flags >> 8, tets);
    }
    header.vertex_count = std::uint64_t{before} + vertices + 1000;
    header.tet_count = tets;
  }
};

struct Columns {
  Bytes positions, tets, regions, fields, faces, face_tets, face_labels;

  explicit Columns(const Input& input) {
    const ChunkSizes sizes(input.header, input.extent);
    positions.resize(sizes.positions);
    tets.resize(sizes.tets);
    regions.resize(sizes.regions, std::byte{1});
    fields.resize(sizes.fields);
    faces.resize(sizes.faces);
    face_tets.resize(sizes.face_tets);
    face_labels.resize(sizes.face_labels);
  }
  ChunkColumns places() {
    return {positions, tets, regions, fields, faces, face_tets, face_labels};
  }
  bool operator==(const Columns&) const = default;
};

std::uint64_t id_at(const Bytes& tets, std::size_t i, std::size_t size) {
  std::uint64_t id = 0;
  std::memcpy(&id, &tets[i * size], size);
  return id;
}

void expect_refused_or_ids_of_vertices(const Input& input, std::span<const std::byte> bytes) {
  Columns columns(input);
  ChunkUnpacker unpacker;
  const auto status = unpacker.unpack(bytes, input.header, input.extent, columns.places());
  if (!status.ok()) return;
  const std::size_t size = size_of(input.header.index_type);
  for (std::size_t i = 0; i < input.extent.tet_count * 4; ++i) {
    if (id_at(columns.tets, i, size) >= input.header.vertex_count) std::abort();
  }
  for (std::size_t i = 0; i < input.extent.face_count; ++i) {
    if (id_at(columns.face_tets, i, size) >= input.extent.tet_count) std::abort();
    if (id_at(columns.face_labels, i, 2) >= input.header.face_labels.size()) std::abort();
  }
}

/// Gives each of the first tets a face, and those labels by turns.
void add_some_faces(const Input& input, Columns& columns) {
  const std::size_t size = size_of(input.header.index_type);
  for (std::size_t i = 0; i < input.extent.face_count; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      std::memcpy(&columns.faces[(3 * i + c) * size],
                  &columns.tets[(4 * i + kFaceCorners[i % 4][c]) * size], size);
    }
    const std::uint64_t tet = i, label = i / 5 % input.header.face_labels.size();
    std::memcpy(&columns.face_tets[i * size], &tet, size);
    std::memcpy(&columns.face_labels[i * 2], &label, 2);
  }
}

void expect_same_back(const Input& input, std::span<const std::byte> bytes) {
  Columns columns(input);
  const auto fill = [&](Bytes& column) {
    const std::size_t size = std::min(column.size(), bytes.size());
    std::copy_n(bytes.begin(), size, column.begin());
    bytes = bytes.subspan(size);
  };
  fill(columns.tets);
  fill(columns.positions);
  fill(columns.fields);
  const std::size_t size = size_of(input.header.index_type);
  for (std::size_t i = 0; i < input.extent.tet_count * 4; ++i) {
    const std::uint64_t id = id_at(columns.tets, i, size) % input.header.vertex_count;
    std::memcpy(&columns.tets[i * size], &id, size);
  }
  add_some_faces(input, columns);
  ChunkPacker packer;
  const auto packed = packer.pack(input.header, input.extent, columns.places());
  if (packed.empty()) return;
  Columns back(input);
  ChunkUnpacker unpacker;
  if (!unpacker.unpack(packed, input.header, input.extent, back.places()).ok()) std::abort();
  if (!(back == columns)) std::abort();
}

}  // namespace

TET_FUZZ_TARGET(packed_chunk_fuzz) {
  if (size < 8) return 0;
  const auto bytes = std::as_bytes(std::span(data, size));
  const Input input(bytes.first<8>());
  expect_refused_or_ids_of_vertices(input, bytes.subspan(8));
  expect_same_back(input, bytes.subspan(8));
  return 0;
}

}  // namespace tet::packed_chunk_fuzz
