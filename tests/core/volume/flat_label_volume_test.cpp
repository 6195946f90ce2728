#include "core/volume/flat_label_volume.h"

#include <cstring>
#include <new>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tet {
namespace {

LabelVolume mixed_labels() {
  std::vector<std::int64_t> values(std::size_t{20} * 17 * 9);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = i % 20 < 9 ? 3 : static_cast<std::int64_t>(i / 40 % 5) - 2;
  }
  VoxelTransform transform;
  transform.linear[2][2] = 3;
  return *make_label_volume({"labels", transform, {20, 17, 9}, {-4, 0, 2}, values});
}

std::string flat_labels(const LabelVolume& volume) {
  std::string block;
  const absl::Status status = write_flat_labels(volume, [&](std::span<const std::byte> bytes) {
    block.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return absl::OkStatus();
  });
  EXPECT_TRUE(status.ok()) << status;
  return block;
}

absl::StatusOr<LabelVolume> read_labels(const std::string& block) {
  struct alignas(64) Line {
    std::array<std::byte, 64> bytes;
  };
  std::vector<Line> aligned(block.size() / 64 + 1);
  std::memcpy(aligned.data(), block.data(), block.size());
  return read_flat_labels({aligned.front().bytes.data(), block.size()}, 1 << 20);
}

TEST(FlatLabelVolume, KeepsAll) {
  const LabelVolume volume = mixed_labels();
  const std::string block = flat_labels(volume);
  EXPECT_EQ(block.size(), flat_label_bytes(volume));
  const auto read = read_labels(block);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->name, volume.name);
  EXPECT_EQ(read->transform, volume.transform);
  EXPECT_EQ(read->bricks, volume.bricks);
  EXPECT_EQ(read->values, volume.values);
  EXPECT_EQ(read->labels, volume.labels);
  EXPECT_EQ(read->voxel_counts, volume.voxel_counts);
  EXPECT_EQ(read->first_brick, volume.first_brick);
}

TEST(FlatLabelVolume, RefusesEveryTruncation) {
  const std::string block = flat_labels(mixed_labels());
  for (std::size_t size = 0; size < block.size(); ++size) {
    EXPECT_FALSE(read_labels(block.substr(0, size)).ok()) << size;
  }
}

TEST(FlatLabelVolume, RefusesOrCountsWhateverItsBytesAre) {
  const std::string block = flat_labels(mixed_labels());
  std::mt19937 random(5);
  for (int trial = 0; trial < 5000; ++trial) {
    std::string changed = block;
    changed[random() % changed.size()] = static_cast<char>(random());
    const auto read = read_labels(changed);
    if (!read.ok()) continue;
    std::uint64_t voxels = 0;
    for (const std::uint64_t count : read->voxel_counts) voxels += count;
    const VoxelBox& box = read->box;
    EXPECT_EQ(voxels, static_cast<std::uint64_t>(box.max.x - box.min.x + 1) *
                          static_cast<std::uint64_t>(box.max.y - box.min.y + 1) *
                          static_cast<std::uint64_t>(box.max.z - box.min.z + 1));
  }
}

}  // namespace
}  // namespace tet
