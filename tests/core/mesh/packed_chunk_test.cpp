#include "core/mesh/packed/packed_chunk.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tet {
namespace {

using Bytes = std::vector<std::byte>;

/// A chunk of a mesh, and its columns.
struct Chunk {
  MeshHeader header;
  ChunkExtent extent;
  Bytes positions, tets, regions, fields;

  Chunk(const MeshHeader& mesh, const ChunkExtent& of_chunk) : header(mesh), extent(of_chunk) {
    const ChunkSizes sizes(header, extent);
    positions.resize(sizes.positions);
    tets.resize(sizes.tets);
    regions.resize(sizes.regions, std::byte{1});
    fields.resize(sizes.fields);
  }

  ChunkColumns columns() { return {positions, tets, regions, fields}; }

  void set_corner(std::size_t corner, std::uint64_t id) {
    const std::size_t size = size_of(header.index_type);
    std::memcpy(&tets[corner * size], &id, size);
  }
  std::uint64_t corner(std::size_t i) const {
    const std::size_t size = size_of(header.index_type);
    std::uint64_t id = 0;
    std::memcpy(&id, &tets[i * size], size);
    return id;
  }

  bool operator==(const Chunk& other) const {
    return positions == other.positions && tets == other.tets && regions == other.regions &&
           fields == other.fields;
  }
};

/// What a chunk may hold at worst: nothing is alike, of numbers any bits, also those of NaN.
Chunk random_chunk(const MeshHeader& header, const ChunkExtent& extent, unsigned seed) {
  Chunk chunk(header, extent);
  std::mt19937_64 random(seed);
  const auto any_byte = [&] { return static_cast<std::byte>(random()); };
  std::ranges::generate(chunk.positions, any_byte);
  std::ranges::generate(chunk.fields, any_byte);
  std::ranges::generate(chunk.regions,
                        [&] { return random() % 2 == 0 ? std::byte{1} : std::byte{2}; });
  for (std::size_t i = 0; i < extent.tet_count * 4; ++i) {
    chunk.set_corner(i, random() % header.vertex_count);
  }
  return chunk;
}

/// Numbers that step as those of meshes do, by `seed` a little or far, again and again.
Chunk stepping_chunk(const MeshHeader& header, const ChunkExtent& extent, unsigned seed) {
  Chunk chunk(header, extent);
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < extent.tet_count * 4; ++i) {
    const std::uint64_t before = i < 4 ? 0 : chunk.corner(i - 4);
    const std::uint64_t far = random() % header.vertex_count;
    const std::uint64_t near = before + random() % 5 + (random() % 4 == 0 ? 100 : 0);
    chunk.set_corner(i, random() % 8 == 0 ? far : near % header.vertex_count);
  }
  for (std::size_t i = 0; i < extent.vertex_count * 3; ++i) {
    const float at = static_cast<float>(random() % 8) * (random() % 2 == 0 ? 0.5F : 0.3F);
    if (header.coordinate_type == CoordinateType::kFloat64) {
      const double wide = random() % 2 == 0 ? double{at} : at / 3.0;
      std::memcpy(&chunk.positions[i * sizeof(wide)], &wide, sizeof(wide));
    } else {
      std::memcpy(&chunk.positions[i * sizeof(at)], &at, sizeof(at));
    }
  }
  return chunk;
}

std::vector<MeshHeader> headers() {
  std::vector<MeshHeader> headers;
  for (const auto type : {CoordinateType::kFloat32, CoordinateType::kFloat64}) {
    for (const auto index : {IndexType::kUint32, IndexType::kUint64}) {
      MeshHeader header;
      header.vertex_count = 100'000;
      header.tet_count = 500'000;
      header.coordinate_type = type;
      header.index_type = index;
      header.has_regions = index == IndexType::kUint64;
      if (type == CoordinateType::kFloat64) header.fields = {{"t", 1}, {"v", 3}};
      headers.push_back(header);
    }
  }
  // Bytes of 1 and 2 are numbers up to 514.
  MeshHeader labelled = headers.front();
  labelled.labels.resize(600);
  headers.push_back(labelled);
  return headers;
}

constexpr ChunkExtent kExtents[] = {
    {0, 0, 0, 0}, {17, 1, 0, 0}, {0, 0, 5, 1}, {4000, 40, 9, 150}, {90000, 5000, 10, 9000},
};

Bytes pack(Chunk& chunk) {
  ChunkPacker packer;
  const auto bytes = packer.pack(chunk.header, chunk.extent, chunk.columns());
  return {bytes.begin(), bytes.end()};
}

absl::Status unpack(const Bytes& bytes, Chunk& into) {
  return ChunkUnpacker().unpack(bytes, into.header, into.extent, into.columns());
}

void expect_same_back(Chunk chunk) {
  SCOPED_TRACE(testing::Message() << chunk.extent.tet_count << " tets");
  Chunk back(chunk.header, chunk.extent);
  const absl::Status status = unpack(pack(chunk), back);
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_TRUE(back == chunk);
}

TEST(PackedChunk, ComesBackByteForByteWhateverItHolds) {
  for (const MeshHeader& header : headers()) {
    for (const ChunkExtent& extent : kExtents) {
      for (unsigned seed = 0; seed < 3; ++seed) {
        expect_same_back(random_chunk(header, extent, seed));
        expect_same_back(stepping_chunk(header, extent, seed));
      }
    }
  }
}

TEST(PackedChunk, IsTheSameBytesFromAPackerThatPackedOthers) {
  ChunkPacker packer;
  ChunkUnpacker unpacker;
  for (const MeshHeader& header : headers()) {
    for (const ChunkExtent& extent : kExtents) {
      Chunk chunk = stepping_chunk(header, extent, 4), back(header, extent);
      const auto bytes = packer.pack(header, extent, chunk.columns());
      EXPECT_TRUE(std::ranges::equal(bytes, pack(chunk)));
      ASSERT_TRUE(unpacker.unpack(bytes, header, extent, back.columns()).ok());
      EXPECT_TRUE(back == chunk);
    }
  }
}

TEST(PackedChunk, IsNoneWhereSixteenBitsDoNotNumberItsVertices) {
  const MeshHeader header = headers()[0];
  for (const auto& [tets, packs] : {std::pair{15'000U, true}, {30'000U, false}}) {
    Chunk chunk(header, {0, 10, 0, tets});
    for (std::size_t i = 0; i < tets * 4; ++i) chunk.set_corner(i, i % header.vertex_count);
    EXPECT_EQ(pack(chunk).empty(), !packs);
  }
}

TEST(PackedChunk, RefusesEveryTruncationAndEveryExtraByte) {
  Chunk chunk = stepping_chunk(headers()[3], kExtents[3], 1);
  const Bytes whole = pack(chunk);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(unpack(cut, chunk).code(), absl::StatusCode::kDataLoss) << size;
  }
  Bytes longer = whole;
  longer.push_back(std::byte{0});
  EXPECT_EQ(unpack(longer, chunk).code(), absl::StatusCode::kDataLoss);
}

/// An unpacker that still holds ids of a larger mesh.
ChunkUnpacker used_unpacker(const MeshHeader& header) {
  MeshHeader larger = header;
  larger.vertex_count = 4'000'000'000;
  Chunk chunk(larger, {3'900'000'000, 60'000, 0, 0});
  ChunkUnpacker unpacker;
  EXPECT_TRUE(unpacker.unpack(pack(chunk), larger, chunk.extent, chunk.columns()).ok());
  return unpacker;
}

TEST(PackedChunk, NamesOnlyVerticesOfTheMeshWhateverItsBytes) {
  std::mt19937_64 random(5);
  int accepted = 0;
  for (const MeshHeader& header : headers()) {
    ChunkUnpacker unpacker = used_unpacker(header);
    Chunk chunk = stepping_chunk(header, kExtents[3], 1);
    const Bytes whole = pack(chunk);
    for (std::size_t at = 0; at < whole.size(); ++at) {
      Bytes changed = whole;
      changed[at] ^= std::byte{1} << (random() % 8);
      const absl::Status status =
          unpacker.unpack(changed, header, chunk.extent, chunk.columns());
      if (!status.ok()) {
        EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss);
        continue;
      }
      ++accepted;
      for (std::size_t i = 0; i < chunk.extent.tet_count * 4; ++i) {
        ASSERT_LT(chunk.corner(i), header.vertex_count) << at;
      }
    }
  }
  EXPECT_GT(accepted, 1000);  // most bits are of coordinates and fields
}

TEST(PackedChunk, RefusesLabelsThatThereAreNot) {
  const MeshHeader header = headers().back();
  Chunk chunk = random_chunk(header, {0, 100, 0, 50}, 1);
  const Bytes bytes = pack(chunk);
  MeshHeader fewer = header;
  fewer.labels.resize(257);
  Chunk into(fewer, chunk.extent);
  EXPECT_FALSE(unpack(bytes, into).ok());
}

TEST(PackedChunk, RefusesVerticesOfOtherChunksThatThereAreNot) {
  MeshHeader header = headers()[0];
  Chunk chunk = stepping_chunk(header, kExtents[3], 1);
  const Bytes bytes = pack(chunk);
  chunk.header.vertex_count = chunk.extent.first_vertex + chunk.extent.vertex_count;
  EXPECT_EQ(unpack(bytes, chunk).code(), absl::StatusCode::kDataLoss);
  chunk.header = header;
  chunk.extent.vertex_count = std::numeric_limits<std::uint32_t>::max();
  EXPECT_EQ(unpack(bytes, chunk).code(), absl::StatusCode::kDataLoss);
}

}  // namespace
}  // namespace tet
