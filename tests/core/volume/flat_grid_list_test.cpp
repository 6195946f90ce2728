#include "core/volume/flat_grid_list.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/byte_buffer.h"

namespace tet {
namespace {

constexpr std::size_t kGridCount = 16;
constexpr std::size_t kTextBytes = 24;
constexpr std::size_t kRecords = 64;
constexpr std::size_t kVoxelSize = 8, kBox = 16, kNameBytes = 44, kFieldComponents = 60;

std::string flat(const std::vector<GridInfo>& grids) {
  std::string block;
  const absl::Status written =
      write_flat_grid_list(grids, [&](std::span<const std::byte> bytes) {
        block.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        return absl::OkStatus();
      });
  EXPECT_TRUE(written.ok()) << written;
  return block;
}

absl::StatusOr<std::vector<GridInfo>> read(const std::string& block) {
  ByteBuffer aligned(block.size());
  std::memcpy(aligned.bytes().data(), block.data(), block.size());
  return read_flat_grid_list(aligned.bytes());
}

template <class T>
std::string changed(std::string block, std::size_t at, T value) {
  std::memcpy(block.data() + at, &value, sizeof(T));
  return block;
}

std::vector<GridInfo> sample() {
  GridInfo good;
  good.name = "density\xC3\xA9";
  good.value_type = "float";
  good.grid_class = "fog volume";
  good.voxel_size = 0.25;
  good.active_voxels = 12345678901;
  good.active_box = {{-1, -2, -3}, {4, 5, 6}};
  good.background = 0.5F;
  GridInfo bad = good;
  bad.name = "";
  bad.active_box = {};
  bad.voxel_size = std::numeric_limits<double>::infinity();
  bad.not_meshable = "its values are vec3s";
  bad.field_components = 3;
  bad.made_of = "8 vertices, 12 triangles, closed";
  return {good, bad};
}

TEST(FlatGridList, ReadsBackEqual) {
  const std::vector<GridInfo> grids = sample();
  const absl::StatusOr<std::vector<GridInfo>> back = read(flat(grids));
  ASSERT_TRUE(back.ok()) << back.status();
  ASSERT_EQ(back->size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const GridInfo &a = grids[i], &b = (*back)[i];
    EXPECT_EQ(a.field_components, b.field_components);
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.value_type, b.value_type);
    EXPECT_EQ(a.grid_class, b.grid_class);
    EXPECT_EQ(a.voxel_size, b.voxel_size);
    EXPECT_EQ(a.active_voxels, b.active_voxels);
    EXPECT_EQ(a.active_box.min, b.active_box.min);
    EXPECT_EQ(a.active_box.max, b.active_box.max);
    EXPECT_EQ(a.background, b.background);
    EXPECT_EQ(a.not_meshable, b.not_meshable);
    EXPECT_EQ(a.made_of, b.made_of);
  }
  EXPECT_TRUE(read(flat({}))->empty());
}

TEST(FlatGridList, RefusesEveryTruncation) {
  const std::string whole = flat(sample());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(read(whole.substr(0, size)).ok()) << size;
  }
  EXPECT_FALSE(read(whole + std::string(64, '\0')).ok());
}

TEST(FlatGridList, RefusesEveryLie) {
  const std::string truth = flat(sample());
  const std::size_t text = kRecords + 2 * 72;
  EXPECT_FALSE(read(changed(truth, 0, 'x')).ok());
  EXPECT_FALSE(read(changed<std::uint32_t>(truth, 8, 1)).ok());
  EXPECT_FALSE(read(changed<std::uint32_t>(truth, 12, 1)).ok());
  for (const std::uint64_t count : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{3},
                                    std::uint64_t{1} << 58, ~std::uint64_t{0}}) {
    EXPECT_FALSE(read(changed(truth, kGridCount, count)).ok()) << count;
    EXPECT_FALSE(read(changed(truth, kTextBytes, count)).ok()) << count;
  }
  for (std::size_t at = kNameBytes; at < kFieldComponents; at += 4) {
    for (const std::uint32_t size : {0U, 4U, 1025U, 1U << 31, ~0U}) {
      if (at == kNameBytes + 12 && size == 0) continue;  // the first grid has no such text
      EXPECT_FALSE(read(changed(truth, kRecords + at, size)).ok()) << at << ' ' << size;
    }
  }
  EXPECT_FALSE(read(changed(truth, kRecords + kFieldComponents, 2)).ok());
  EXPECT_FALSE(read(changed(truth, kRecords + kBox, 5)).ok());
  EXPECT_FALSE(read(changed(truth, kRecords + kVoxelSize, std::nan(""))).ok());
  EXPECT_FALSE(read(changed(truth, text + 9, '\x1B')).ok());
  const std::size_t last = truth.find("density\xC3") + 8;  // of a character's two bytes
  EXPECT_FALSE(read(changed(truth, last, 'e')).ok());
}

}  // namespace
}  // namespace tet
