#include "core/volume/label_volume.h"

#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace tet {
namespace {

/// An image of runs of labels, so that some bricks are of one label and others are not.
std::vector<std::int64_t> runs_of_labels(std::size_t voxels) {
  std::mt19937 random(7);
  const std::vector<std::int64_t> labels{0, 614454277, -3, 7, 65536};
  std::vector<std::int64_t> values;
  while (values.size() < voxels) {
    const std::size_t run = 1 + random() % 4000;
    const std::int64_t label = labels[random() % labels.size()];
    for (std::size_t i = 0; i < run && values.size() < voxels; ++i) values.push_back(label);
  }
  return values;
}

TEST(LabelVolume, HasTheLabelOfEveryVoxelAndCountsThem) {
  const std::array<std::int32_t, 3> size{21, 40, 33};
  const VoxelCoord min{-5, 3, 8};
  const std::vector<std::int64_t> values = runs_of_labels(std::size_t{21} * 40 * 33);
  const auto made = make_label_volume({"scan", {}, size, min, values});
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(made->labels, (std::vector<std::int64_t>{-3, 0, 7, 65536, 614454277}));
  std::map<std::int64_t, std::uint64_t> counts;
  std::size_t next = 0;
  for (std::int32_t z = 0; z < size[2]; ++z) {
    for (std::int32_t y = 0; y < size[1]; ++y) {
      for (std::int32_t x = 0; x < size[0]; ++x) {
        const std::uint16_t number = made->at({min.x + x, min.y + y, min.z + z});
        ASSERT_LT(number, made->labels.size());
        ASSERT_EQ(made->labels[number], values[next]) << x << " " << y << " " << z;
        ++counts[values[next++]];
      }
    }
  }
  for (std::size_t i = 0; i < made->labels.size(); ++i) {
    EXPECT_EQ(made->voxel_counts[i], counts[made->labels[i]]);
  }
}

TEST(LabelVolume, HasNoLabelBeyondItsBox) {
  const std::vector<std::int64_t> values(8, 4);
  const auto made = make_label_volume({"cube", {}, {2, 2, 2}, {7, 7, 7}, values});
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(made->at({7, 7, 7}), 0);
  EXPECT_EQ(made->at({8, 8, 8}), 0);
  EXPECT_EQ(made->at({6, 7, 7}), LabelVolume::kNoLabel);
  EXPECT_EQ(made->at({9, 8, 8}), LabelVolume::kNoLabel);
}

TEST(LabelVolume, KeepsABrickOfOneLabelAsOneNumber) {
  const std::vector<std::int64_t> values(std::size_t{64} * 64 * 64, 9);
  const auto made = make_label_volume({"solid", {}, {64, 64, 64}, {0, 0, 0}, values});
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_TRUE(made->values.empty());
  EXPECT_LT(made->size_bytes(), 8000);
}

TEST(LabelVolume, RefusesWhatIsNoSegmentation) {
  std::vector<std::int64_t> values(std::size_t{41} * 40 * 40);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::int64_t>(i);
  const auto made = make_label_volume({"scan", {}, {41, 40, 40}, {0, 0, 0}, values});
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_NE(made.status().message().find("--iso"), std::string::npos) << made.status();
}

TEST(LabelVolume, RefusesSizesThatDoNotMatchItsValues) {
  const std::vector<std::int64_t> values(7);
  for (const std::array<std::int32_t, 3> size :
       {std::array{2, 2, 2}, {0, 7, 1}, {-7, 1, -1}, {1 << 29, 1 << 29, 1 << 29}}) {
    const auto made = make_label_volume({"odd", {}, size, {0, 0, 0}, values});
    EXPECT_EQ(made.status().code(), absl::StatusCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace tet
