// Voxels of every shape, and grids of whole numbers, bools and masks.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/vdb/openvdb/load.h"
#include "core/vdb/openvdb/vdb_grids.h"
#include "core/vdb/walk/memory_charge.h"
#include "core/vdb/walk/walk_vdb.h"
#include "core/volume/volume_reader.h"
#include "tests/core/vdb/vdb_test_files.h"

namespace tet {
namespace {

using openvdb::FloatGrid;
using test::ball;
using ::testing::HasSubstr;

class LoadVoxels : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { openvdb::initialize(); }

  absl::StatusOr<Volume> loaded(const openvdb::GridCPtrVec& grids) {
    test::write_vdb(path_, grids);
    return load_volume(path_, "");
  }
  absl::Status refusal(const openvdb::GridBase::ConstPtr& grid) {
    return loaded({grid}).status();
  }

  test::TestDirectory directory_;
  std::string path_ = directory_.file("voxels.vdb");
};

// tests/data/whole_numbers: 1 from (-3, 2, 5) to (20, 30, 40), but for 0 at (0, 10, 10), which
// is not active.
TEST_F(LoadVoxels, ReadsWholeNumbersBoolsAndMasks) {
  for (const std::string kind : {"int32", "int64", "bool", "mask"}) {
    SCOPED_TRACE(kind);
    const absl::StatusOr<Volume> volume =
        load_volume(std::string(WHOLE_NUMBERS_PATH) + "/" + kind + ".vdb", "");
    ASSERT_TRUE(volume.ok()) << volume.status();
    EXPECT_EQ(volume->kind, VolumeKind::kFogVolume);
    VolumeReader reader(*volume);
    EXPECT_EQ(reader.value({-3, 2, 5}), 1);
    EXPECT_EQ(reader.value({20, 30, 40}), 1);
    EXPECT_EQ(reader.value({9, 17, 17}), 1);
    EXPECT_EQ(reader.value({0, 10, 10}), 0);
    EXPECT_EQ(reader.value({21, 30, 40}), 0);
  }
}

TEST_F(LoadVoxels, ReadsWholeNumbersBoolsAndMasksAsLabels) {
  for (const std::string kind : {"int32", "int64", "bool", "mask"}) {
    SCOPED_TRACE(kind);
    const absl::StatusOr<LabelVolume> labels =
        load_labels(std::string(WHOLE_NUMBERS_PATH) + "/" + kind + ".vdb", "");
    ASSERT_TRUE(labels.ok()) << labels.status();
    EXPECT_EQ(labels->labels, (std::vector<std::int64_t>{0, 1}));
    EXPECT_EQ(labels->voxel_counts, (std::vector<std::uint64_t>{1, 24 * 29 * 36 - 1}));
    EXPECT_EQ(labels->at({-3, 2, 5}), 1);
    EXPECT_EQ(labels->at({9, 17, 17}), 1);
    EXPECT_EQ(labels->at({0, 10, 10}), 0);
    EXPECT_EQ(labels->at({21, 30, 40}), LabelVolume::kNoLabel);
  }
}

TEST_F(LoadVoxels, KeepsEveryBitOfALabel) {
  const auto grid = openvdb::Int32Grid::create(-7);
  grid->setName("atlas");
  grid->fill({{0, 0, 0}, {15, 7, 7}}, 2'000'000'001);
  grid->tree().setValue({3, 3, 3}, 2'000'000'002);
  grid->tree().setValue({20, 3, 3}, 5);
  test::write_vdb(path_, {grid, ball(4)});
  const absl::StatusOr<LabelVolume> labels = load_labels(path_, "");
  ASSERT_TRUE(labels.ok()) << labels.status();
  EXPECT_EQ(labels->name, "atlas");
  EXPECT_EQ(labels->labels, (std::vector<std::int64_t>{-7, 5, 2'000'000'001, 2'000'000'002}));
  EXPECT_EQ(labels->voxel_counts, (std::vector<std::uint64_t>{5 * 64 - 1, 1, 16 * 64 - 1, 1}));
}

TEST_F(LoadVoxels, ChargesForTheWholeBoxOfSparseLabels) {
  // A long box of which every brick is cut, and one of which most are whole; then one voxel.
  for (const openvdb::Coord& far : {openvdb::Coord(3, 4, 640'000),
                                    openvdb::Coord(400, 300, 203), openvdb::Coord(1, 0, 0)}) {
    const auto grid = openvdb::Int32Grid::create();
    grid->tree().setValue({0, 0, 0}, 1);
    grid->tree().setValue(far, 2);
    test::write_vdb(path_, {grid});
    const absl::StatusOr<VdbOutline> outline = walk_vdb(path_);
    ASSERT_TRUE(outline.ok()) << outline.status();
    const MemoryCharge charge = loading_charge(*outline, "", GridUse::kLabels);
    const absl::StatusOr<LabelVolume> labels = load_labels(path_, "");
    ASSERT_TRUE(labels.ok()) << labels.status();
    EXPECT_GE(charge.volume, labels->size_bytes());
    constexpr std::uint64_t kLists = 1'100'000;  // of as many labels as there may be
    EXPECT_LE(charge.volume, labels->size_bytes() + kLists);
    EXPECT_EQ(load_labels(path_, "", {.max_bytes = labels->size_bytes()}).status().code(),
              absl::StatusCode::kResourceExhausted);
  }
}

TEST_F(LoadVoxels, RefusesWhatIsNoSegmentation) {
  const auto said = [&](const openvdb::GridCPtrVec& grids) {
    test::write_vdb(path_, grids);
    return std::string(load_labels(path_, "").status().message());
  };
  EXPECT_THAT(said({ball(4)}), HasSubstr("its values are float, and labels are whole numbers"));
  const auto empty = openvdb::Int32Grid::create();
  EXPECT_THAT(said({empty}), HasSubstr("it is empty: no voxel is active"));
  const auto far = openvdb::Int32Grid::create();
  far->tree().setValue({0, 0, 0}, 1);
  far->tree().setValue({1 << 20, 1 << 20, 1 << 20}, 1);
  EXPECT_THAT(said({far}), HasSubstr("more than 16777216 bricks of 8 x 8 x 8 voxels: crop it"));
  const auto one = openvdb::Int32Grid::create(), other = openvdb::Int32Grid::create();
  one->tree().setValue({0, 0, 0}, 1);
  other->tree().setValue({0, 0, 0}, 1);
  one->setName("one");
  other->setName("other");
  EXPECT_THAT(said({one, other}), HasSubstr("name one of them: 'one', 'other'"));
}

TEST_F(LoadVoxels, KeepsVoxelsThatAreNoCubes) {
  const FloatGrid::Ptr grid = ball(8);
  openvdb::Mat4d rhombus = openvdb::Mat4d::identity();
  rhombus(1, 0) = 0.6;
  rhombus(1, 1) = 0.8;
  rhombus(2, 2) = -1.5;
  grid->setTransform(openvdb::math::Transform::createLinearTransform(rhombus));
  const absl::StatusOr<Volume> volume = loaded({grid});
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_DOUBLE_EQ(volume->transform.voxel_size, 1);
  const WorldPoint world = volume->transform.to_world({10, 20, 30});
  EXPECT_NEAR(world.x, 22, 1e-12);
  EXPECT_NEAR(world.y, 16, 1e-12);
  EXPECT_NEAR(world.z, -45, 1e-12);
}

TEST_F(LoadVoxels, RefusesFlatEndlessAndFrustumVoxels) {
  const FloatGrid::Ptr grid = ball(8);
  openvdb::Mat4d flat = openvdb::Mat4d::identity();
  flat(1, 0) = 1;
  flat(1, 1) = 1e-4;
  grid->setTransform(openvdb::math::Transform::createLinearTransform(flat));
  EXPECT_THAT(refusal(grid).message(), HasSubstr("sheared flat"));

  openvdb::math::Transform stretched;
  stretched.preScale(openvdb::Vec3d(1, 1, 2000));
  grid->setTransform(stretched.copy());
  EXPECT_THAT(refusal(grid).message(), HasSubstr("1 x 1 x 2000"));

  grid->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd({-9, -9, -9}, {9, 9, 9}), 0.5, 20, 1));
  EXPECT_THAT(refusal(grid).message(), HasSubstr("frustum"));
}

}  // namespace
}  // namespace tet
