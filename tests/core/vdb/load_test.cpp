#include "core/vdb/openvdb/load.h"

#include <cmath>
#include <functional>
#include <limits>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/io/Stream.h>

#include "core/vdb/openvdb/vdb_grids.h"
#include "core/volume/volume_reader.h"
#include "tests/core/vdb/vdb_test_files.h"
#include "tests/support/vdb_fixtures.h"

namespace tet {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using test::ball;
using test::write_vdb;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class Load : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { openvdb::initialize(); }

  absl::StatusOr<Volume> loaded(const openvdb::GridCPtrVec& grids,
                                const std::string& name = "") {
    write_vdb(path_, grids);
    return load_volume(path_, name);
  }
  absl::Status refusal(const openvdb::GridBase::ConstPtr& grid) {
    return loaded({grid}).status();
  }

  test::TestDirectory directory_;
  std::string path_ = directory_.file("test.vdb");
};

/// Every voxel within `extent` of the origin reads as OpenVDB has it.
void expect_same_values(const Volume& volume, const FloatGrid& grid, int extent, int step) {
  VolumeReader reader(volume);
  const FloatGrid::ConstAccessor values = grid.getConstAccessor();
  for (int x = -extent; x <= extent; x += step) {
    for (int y = -extent; y <= extent; y += step) {
      for (int z = -extent; z <= extent; ++z) {
        ASSERT_EQ(reader.value({x, y, z}), values.getValue({x, y, z}))
            << x << ' ' << y << ' ' << z;
      }
    }
  }
}

TEST_F(Load, ReadsEveryValueOfALevelSet) {
  const FloatGrid::Ptr grid = ball(20);
  const absl::StatusOr<Volume> volume = loaded({grid});
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_EQ(volume->name, "ball");
  EXPECT_EQ(volume->kind, VolumeKind::kLevelSet);
  EXPECT_EQ(volume->background, grid->background());
  EXPECT_EQ(volume->bricks.size(), grid->tree().leafCount());
  expect_same_values(*volume, *grid, 30, 1);
}

TEST_F(Load, ReadsTilesOfEverySize) {
  const FloatGrid::Ptr grid = FloatGrid::create(3);
  grid->fill({Coord(-4096, 0, 0), Coord(-1, 4095, 4095)}, -3, false);
  grid->fill({Coord(0, 128, -128), Coord(127, 255, -1)}, -2, true);
  grid->fill({Coord(8, 16, -32), Coord(15, 23, -25)}, -1, false);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  const absl::StatusOr<Volume> volume = loaded({grid});
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_THAT(volume->bricks, IsEmpty());
  EXPECT_EQ(volume->cubes.size(), 2U);
  expect_same_values(*volume, *grid, 300, 12);
}

TEST_F(Load, ReadsABigBallAsFewBricks) {
  const FloatGrid::Ptr grid = ball(120, "ball", {64, 64, -64});
  const absl::StatusOr<Volume> volume = loaded({grid});
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_GT(volume->cubes.size(), 0U);
  EXPECT_EQ(volume->bricks.size(), grid->tree().leafCount());
  expect_same_values(*volume, *grid, 190, 15);
}

TEST_F(Load, ReadsHalfFloatsAsOpenVdbDoes) {
  const FloatGrid::Ptr grid = ball(20);
  grid->setSaveFloatAsHalf(true);
  const absl::StatusOr<Volume> volume = loaded({grid});
  ASSERT_TRUE(volume.ok()) << volume.status();
  openvdb::io::File file(path_);
  file.open();
  expect_same_values(*volume, *openvdb::gridPtrCast<FloatGrid>(file.readGrid("ball")), 30, 1);
}

TEST_F(Load, ConvertsDoubles) {
  const auto grid = openvdb::DoubleGrid::create(2.5);
  grid->tree().setValue({1, -2, 3}, -0.1);
  const absl::StatusOr<Volume> volume = loaded({grid});
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_EQ(VolumeReader(*volume).value({1, -2, 3}), -0.1F);
  EXPECT_EQ(VolumeReader(*volume).value({1, -2, 4}), 2.5F);
}

TEST_F(Load, ReadsAStreamWithoutOffsets) {
  const FloatGrid::Ptr grid = ball(20, "second");
  std::ofstream out(path_, std::ios::binary);
  openvdb::io::Stream(out).write(openvdb::GridCPtrVec{ball(9, "first"), grid});
  out.close();
  const absl::StatusOr<Volume> volume = load_volume(path_, "second");
  ASSERT_TRUE(volume.ok()) << volume.status();
  expect_same_values(*volume, *grid, 30, 2);
  EXPECT_EQ(list_grids(path_)->size(), 2U);
}

TEST_F(Load, ReadsATreeThatTwoGridsShare) {
  const FloatGrid::Ptr first = ball(20, "first");
  const FloatGrid::Ptr second = first->copyWithNewTree();
  second->setTree(first->treePtr());
  second->setTransform(openvdb::math::Transform::createLinearTransform(0.25));
  second->setName("second");
  for (const char* name : {"first", "second"}) {
    const absl::StatusOr<Volume> volume = loaded({first, second}, name);
    ASSERT_TRUE(volume.ok()) << volume.status();
    EXPECT_EQ(volume->transform.voxel_size, name == std::string("first") ? 1 : 0.25);
    expect_same_values(*volume, *first, 30, 2);
  }
}

TEST_F(Load, TellsTheKindFromTheGridClass) {
  test::write_fixture("fog", 0.1, path_);
  EXPECT_EQ(load_volume(path_, "")->kind, VolumeKind::kFogVolume);
  test::write_fixture("sphere", 0.1, path_);
  EXPECT_EQ(load_volume(path_, "")->kind, VolumeKind::kLevelSet);
}

TEST_F(Load, GuessesTheKindOfAnUnknownClassFromItsValues) {
  const auto kind = [&](float background, std::initializer_list<float> values) {
    const FloatGrid::Ptr grid = FloatGrid::create(background);
    int x = 0;
    for (const float value : values) grid->tree().setValue({x++, 0, 0}, value);
    const absl::StatusOr<Volume> volume = loaded({grid});
    return std::pair(volume->kind, volume->kind_source);
  };
  const std::pair density(VolumeKind::kFogVolume, KindSource::kValues);
  const std::pair level_set(VolumeKind::kLevelSet, KindSource::kValues);
  const std::pair unclear(VolumeKind::kLevelSet, KindSource::kNobody);
  EXPECT_EQ(kind(0, {1}), density);
  EXPECT_EQ(kind(0, {1, -1e-6F}), density);
  EXPECT_EQ(kind(1, {-1}), level_set);
  EXPECT_EQ(kind(0, {-1}), level_set);
  EXPECT_EQ(kind(0, {-1, 1}), unclear);
  EXPECT_EQ(kind(-1, {1}), unclear);
  EXPECT_EQ(kind(-1024, {40, 1200}), unclear);
  EXPECT_EQ(kind(1, {-1e-6F}), unclear);
  const FloatGrid::Ptr tile = FloatGrid::create(0);
  tile->fill({Coord(0, 0, 0), Coord(7, 7, 7)}, -1);
  EXPECT_EQ(loaded({tile})->kind, VolumeKind::kLevelSet);
}

TEST_F(Load, BelievesTheClassWhateverTheValuesAre) {
  for (const float background : {-1.F, 0.F, 1.F}) {
    const FloatGrid::Ptr grid = FloatGrid::create(background);
    grid->tree().setValue({0, 0, 0}, 2);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    EXPECT_EQ(loaded({grid})->kind, VolumeKind::kLevelSet);
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    const absl::StatusOr<Volume> fog = loaded({grid});
    EXPECT_EQ(fog->kind, VolumeKind::kFogVolume);
    EXPECT_EQ(fog->kind_source, KindSource::kClass);
  }
}

TEST_F(Load, HidesNoGridBehindTheNumberedNameOfAnother) {
  const FloatGrid::Ptr literal = ball(12, "ball[0]"), first = ball(4, "ball"),
                       second = ball(8, "ball");
  EXPECT_EQ(loaded({first, second, literal}, "ball[0]")->bricks.size(),
            literal->tree().leafCount());
  const auto listed = list_grids(path_);
  ASSERT_TRUE(listed.ok()) << listed.status();
  EXPECT_EQ((*listed)[2].name, "ball[0]");
  for (std::size_t i = 0; i < 2; ++i) {
    const absl::StatusOr<Volume> volume = load_volume(path_, (*listed)[i].name);
    ASSERT_TRUE(volume.ok()) << volume.status();
    EXPECT_EQ(volume->bricks.size(), (i == 0 ? first : second)->tree().leafCount());
  }
}

TEST_F(Load, ReadsGridsWhoseNamesAreLatin1OrEmpty) {
  const FloatGrid::Ptr latin = ball(4, "dichte f\xfcr"), nameless = ball(8, "");
  EXPECT_EQ(loaded({latin, nameless}, "dichte f\xc3\xbcr")->bricks.size(),
            latin->tree().leafCount());
  EXPECT_EQ(load_volume(path_, "[0]")->bricks.size(), nameless->tree().leafCount());
}

TEST_F(Load, KeepsRotationTranslationAndMirror) {
  openvdb::math::Transform transform;
  transform.preScale(openvdb::Vec3d(0.5, 0.5, -0.5));
  transform.postRotate(0.7, openvdb::math::X_AXIS);
  transform.postRotate(-1.1, openvdb::math::Z_AXIS);
  transform.postTranslate({20000, -3, 1e-3});
  const FloatGrid::Ptr grid = ball(8);
  grid->setTransform(transform.copy());
  const absl::StatusOr<Volume> volume = loaded({grid});
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_DOUBLE_EQ(volume->transform.voxel_size, 0.5);
  EXPECT_TRUE(volume->transform.mirrors());
  const openvdb::Vec3d expected = transform.indexToWorld(openvdb::Vec3d(3, -7, 11.5));
  const WorldPoint world = volume->transform.to_world({3, -7, 11.5});
  EXPECT_NEAR(world.x, expected.x(), 1e-9);
  EXPECT_NEAR(world.y, expected.y(), 1e-9);
  EXPECT_NEAR(world.z, expected.z(), 1e-9);
}

TEST_F(Load, TakesTheOnlyMeshableGridWhenNoneIsNamed) {
  const openvdb::GridBase::Ptr vectors = openvdb::Vec3SGrid::create();
  vectors->setName("velocity");
  const absl::StatusOr<Volume> volume = loaded({vectors, ball(8)});
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_EQ(volume->name, "ball");
}

TEST_F(Load, AsksForANameWhenSeveralGridsCanBeMeshed) {
  const absl::Status status = loaded({ball(8, "a"), ball(9, "b")}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(status.message(), HasSubstr("name one of them: 'a', 'b'"));
}

TEST_F(Load, TellsGridsOfOneNameApart) {
  ASSERT_TRUE(loaded({ball(8, "a"), ball(12, "a")}, "a[1]").ok());
  EXPECT_EQ(load_volume(path_, "a[1]")->bricks.size(), ball(12)->tree().leafCount());
  EXPECT_EQ(load_volume(path_, "a[0]")->bricks.size(), ball(8)->tree().leafCount());
}

TEST_F(Load, ListsTheNamesWhenThereIsNoSuchGrid) {
  const absl::Status status = loaded({ball(8, "a"), ball(9, "b")}, "c").status();
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(status.message(), HasSubstr("no grid 'c'; the file has 'a', 'b'"));
}

TEST_F(Load, SaysWhyNoGridCanBeMeshed) {
  const openvdb::GridBase::Ptr a = openvdb::Vec3SGrid::create();
  const openvdb::GridBase::Ptr b = FloatGrid::create(1);
  a->setName("a");
  b->setName("b");
  EXPECT_THAT(loaded({a, b}).status().message(),
              AllOf(HasSubstr("'a': its values are vec3s"), HasSubstr("'b': it is empty")));
  EXPECT_THAT(loaded({}).status().message(), HasSubstr("holds no grid"));
}

TEST_F(Load, RefusesFilesThatAreNotThere) {
  const absl::Status missing = load_volume(directory_.file("no.vdb"), "").status();
  EXPECT_EQ(missing.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(missing.message(), HasSubstr("no.vdb"));
  EXPECT_THAT(list_grids(directory_.file("")).status().message(),
              HasSubstr("not a regular file"));
}

TEST_F(Load, RefusesOtherKindsOfValues) {
  EXPECT_THAT(refusal(openvdb::Vec3IGrid::create()).message(), HasSubstr("vec3i"));
  test::write_fixture("vec3", 0.1, path_);
  EXPECT_THAT(load_volume(path_, "").status().message(), HasSubstr("vec3s"));
  test::write_fixture("points", 0.1, path_);
  const absl::Status points = load_volume(path_, "").status();
  EXPECT_EQ(points.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(points.message(),
              HasSubstr("only float, double, int32, int64, bool and mask grids can be meshed"));
}

TEST_F(Load, RefusesAnEmptyGrid) {
  test::write_fixture("empty", 0.1, path_);
  const absl::Status status = load_volume(path_, "").status();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(status.message(), HasSubstr("empty"));
}

TEST_F(Load, RefusesValuesThatAreNotFinite) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const FloatGrid::Ptr voxel = ball(8);
  voxel->tree().setValue({5, -6, 0}, std::nanf(""));
  EXPECT_THAT(refusal(voxel).message(), HasSubstr("voxel (5, -6, 0) is nan"));
  const FloatGrid::Ptr tile = ball(8);
  tile->fill({Coord(128, 128, 128), Coord(255, 255, 255)}, -kInfinity);
  EXPECT_THAT(refusal(tile).message(), HasSubstr("voxel (128, 128, 128) is -inf"));
  const FloatGrid::Ptr background = FloatGrid::create(kInfinity);
  background->tree().setValue({0, 0, 0}, -1);
  EXPECT_THAT(refusal(background).message(), HasSubstr("background"));
  const auto overflow = openvdb::DoubleGrid::create(1);
  overflow->tree().setValue({1, 1, 1}, 1e300);
  EXPECT_THAT(refusal(overflow).message(), HasSubstr("voxel (1, 1, 1) is inf"));
}

TEST_F(Load, RefusesVoxelsTooFarOut) {
  const FloatGrid::Ptr far = FloatGrid::create(1);
  far->tree().setValue({0, kMaxVoxelCoord + 8, 0}, -1);
  EXPECT_THAT(refusal(far).message(),
              AllOf(HasSubstr("536870927"), HasSubstr("limit of 536870912")));
  const FloatGrid::Ptr near = FloatGrid::create(1);
  near->tree().setValue({0, -kMaxVoxelCoord, kMaxVoxelCoord - 1}, -1);
  EXPECT_TRUE(refusal(near).ok());
}

TEST_F(Load, RefusesMoreThanItsBudget) {
  const FloatGrid::Ptr grid = ball(20);
  write_vdb(path_, {grid});
  const absl::Status status = load_volume(path_, "", {.max_bytes = 100'000}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(status.message(), HasSubstr("the limit is 100000"));
}

TEST_F(Load, NeverTakesATruncatedFileForAWholeOne) {
  for (const bool offsets : {true, false}) {
    const FloatGrid::Ptr grid = ball(12);
    if (offsets) {
      write_vdb(path_, {grid});
    } else {
      std::ofstream out(path_, std::ios::binary);
      openvdb::io::Stream(out).write(openvdb::GridCPtrVec{grid});
    }
    const std::string whole = test::read_bytes(path_);
    for (std::size_t part = 0; part < 40; ++part) {
      const std::string path = directory_.file("part.vdb");
      test::write_bytes(
          path, whole.substr(0, part < 39 ? whole.size() * part / 39 : whole.size() - 1));
      const absl::Status status = load_volume(path, "").status();
      EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << part << ' ' << status;
      EXPECT_THAT(std::string(status.message()), HasSubstr("part.vdb"));
      EXPECT_FALSE(list_grids(path).ok() && part < 2);
    }
  }
}

TEST_F(Load, RefusesWhatIsNoVdbFile) {
  test::write_bytes(path_, std::string(1000, 'x'));
  EXPECT_EQ(load_volume(path_, "").status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(list_grids(path_).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(Load, RefusesFormatsThatItDoesNotKnow) {
  write_vdb(path_, {ball(8)});
  const std::string whole = test::read_bytes(path_);
  for (const char version : {'\xD7', '\xE1'}) {
    std::string bytes = whole;
    bytes[8] = version;  // 215 or 225: the low byte, after the magic number
    test::write_bytes(path_, bytes);
    EXPECT_THAT(load_volume(path_, "").status().message(), HasSubstr("only 222 to 224"));
  }
}

TEST_F(Load, ListsWhatTheFileHolds) {
  const openvdb::GridBase::Ptr vectors = openvdb::Vec3SGrid::create();
  vectors->setName("velocity");
  const FloatGrid::Ptr grid = ball(8);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.25));
  write_vdb(path_, {vectors, grid});
  const absl::StatusOr<std::vector<GridInfo>> grids = list_grids(path_);
  ASSERT_TRUE(grids.ok()) << grids.status();
  ASSERT_EQ(grids->size(), 2U);
  const GridInfo& velocity = (*grids)[0];
  EXPECT_EQ(velocity.value_type, "vec3s");
  EXPECT_TRUE(velocity.active_box.empty());
  EXPECT_THAT(velocity.not_meshable, Not(IsEmpty()));
  const GridInfo& info = (*grids)[1];
  EXPECT_EQ(info.name, "ball");
  EXPECT_EQ(info.value_type, "float");
  EXPECT_EQ(info.grid_class, "level set");
  EXPECT_EQ(info.voxel_size, 0.25);
  EXPECT_EQ(info.active_voxels, grid->activeVoxelCount());
  EXPECT_EQ(info.active_box.min, (VoxelCoord{-10, -10, -10}));
  EXPECT_EQ(info.active_box.max, (VoxelCoord{10, 10, 10}));
  EXPECT_EQ(info.background, 3);
  EXPECT_THAT(info.not_meshable, IsEmpty());
}

TEST_F(Load, ReadsEveryFixtureThatIsMeshable) {
  for (const std::string_view kind : test::fixture_kinds()) {
    test::write_fixture(kind, 0.1, path_);
    const absl::StatusOr<Volume> volume = load_volume(path_, "");
    const bool meshable = list_grids(path_)->front().not_meshable.empty();
    EXPECT_EQ(volume.ok(), meshable) << kind << ": " << volume.status();
    EXPECT_TRUE(meshable || kind == "empty" || kind == "vec3" || kind == "points") << kind;
  }
}

}  // namespace
}  // namespace tet
