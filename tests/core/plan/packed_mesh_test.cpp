#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/mesh/packed/packed_chunk.h"
#include "core/plan/make/fill_mesh.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"

namespace tet::packed_mesh_test {
namespace {

using Bytes = std::vector<std::byte>;

struct Packed {
  TetMesh mesh;
  std::vector<ChunkExtent> extents;
  std::vector<Bytes> chunks;

  double bytes_per_tet() const {
    std::size_t bytes = 0;
    for (const Bytes& chunk : chunks) bytes += chunk.size();
    return static_cast<double>(bytes) / static_cast<double>(mesh.header.tet_count);
  }
};

Packed pack(const Volume& volume, const MeshRequest& request) {
  const auto plan =
      plan_mesh({.shape = std::make_shared<const Volume>(volume), .request = request});
  EXPECT_TRUE(plan.ok()) << plan.status();
  Packed packed;
  packed.mesh = std::move(fill_mesh(**plan, Cancellation(), nullptr)->mesh);
  ChunkPacker packer;
  for (std::uint64_t i = 0; i < packed.mesh.header.chunk_count; ++i) {
    const ChunkExtent& extent = packed.extents.emplace_back((*plan)->chunk(i));
    const auto bytes = packer.pack(packed.mesh.header, extent, packed.mesh.columns_of(extent));
    packed.chunks.emplace_back(bytes.begin(), bytes.end());
  }
  return packed;
}

TetMesh unpack(const Packed& packed) {
  TetMesh mesh(packed.mesh.header);
  ChunkUnpacker unpacker;
  for (std::size_t i = 0; i < packed.chunks.size(); ++i) {
    const absl::Status status = unpacker.unpack(
        packed.chunks[i], mesh.header, packed.extents[i], mesh.columns_of(packed.extents[i]));
    EXPECT_TRUE(status.ok()) << status;
  }
  return mesh;
}

TEST(PackedMesh, IsByteForByteThePlainMesh) {
  MeshRequest graded, uniform, both_sides, improved, wide;
  uniform.levels = 0;
  both_sides.preset = Preset::kBothSides;
  improved.improve = true;
  wide.coordinates = CoordinateType::kFloat64;
  wide.indices = IndexType::kUint64;
  for (MeshRequest request : {graded, uniform, both_sides, improved, wide}) {
    for (const bool faces : {false, true}) {
      request.faces = faces;
      const Packed packed = pack(test::ball(test::sanitized_or(12, 20)), request);
      EXPECT_TRUE(test::same_bytes(unpack(packed), packed.mesh));
    }
  }
  const Packed noise = pack(test::random_signs(20, 3), graded);
  EXPECT_TRUE(test::same_bytes(unpack(noise), noise.mesh));
}

TEST(PackedMesh, TakesAtMostFourBytesATetWhereItIsGraded) {
  // The spacing is no power of two: coordinates have all their bits.
  MeshRequest other_steps;
  other_steps.spacing = 0.93;
  for (const MeshRequest& request : {MeshRequest(), other_steps}) {
    EXPECT_LT(pack(test::ball(test::sanitized_or(30, 60)), request).bytes_per_tet(), 4);
  }
}

}  // namespace
}  // namespace tet::packed_mesh_test
