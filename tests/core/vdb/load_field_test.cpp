// Grids whose values are looked up, one component at a time.
#include <array>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/vdb/openvdb/load.h"
#include "core/vdb/openvdb/vdb_grids.h"
#include "core/vdb/walk/walk_vdb.h"
#include "core/volume/volume_reader.h"
#include "tests/core/vdb/vdb_test_files.h"

namespace tet {
namespace {

using openvdb::Coord;
using test::ball;
using test::write_vdb;
using ::testing::AllOf;
using ::testing::HasSubstr;

template <class GridT>
typename GridT::Ptr named(const std::string& name,
                          const typename GridT::ValueType& background = {}) {
  const typename GridT::Ptr grid = GridT::create(background);
  grid->setName(name);
  return grid;
}

class LoadField : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { openvdb::initialize(); }

  absl::StatusOr<Volume> loaded(const openvdb::GridCPtrVec& grids,
                                const std::string& name = "",
                                std::uint32_t component = 0) {
    write_vdb(path_, grids);
    return load_field(path_, name, component);
  }

  test::TestDirectory directory_;
  std::string path_ = directory_.file("test.vdb");
};

/// A vector in a leaf, tiles of every size, and a background.
template <class GridT>
openvdb::GridBase::Ptr vectors() {
  using Vector = typename GridT::ValueType;
  const auto grid = named<GridT>("v", Vector(7, 8, 9));
  grid->tree().setValue({1, 2, 3}, Vector(0.5, -2, 4));
  grid->fill({Coord(8, 0, 0), Coord(15, 7, 7)}, Vector(1, 8, 3), true);
  grid->fill({Coord(128, 0, 0), Coord(255, 127, 127)}, Vector(-1, -2, -3), false);
  grid->fill({Coord(-4096, 0, 0), Coord(-1, 4095, 4095)}, Vector(10, 20, 30), true);
  return grid;
}

TEST_F(LoadField, ReadsEachComponentOfAVector) {
  using Values = std::array<float, 5>;
  const std::array<Values, 3> expected{Values{0.5, 1, -1, 10, 7}, Values{-2, 8, -2, 20, 8},
                                       Values{4, 3, -3, 30, 9}};
  for (const auto& grid : {vectors<openvdb::Vec3SGrid>(), vectors<openvdb::Vec3DGrid>()}) {
    for (std::uint32_t component = 0; component < 3; ++component) {
      const auto volume = loaded({grid}, "v", component);
      ASSERT_TRUE(volume.ok()) << volume.status();
      EXPECT_EQ(volume->kind, VolumeKind::kVectorField);
      VolumeReader at(*volume);
      const Values found{at.value({1, 2, 3}), at.value({9, 5, 5}), at.value({130, 90, 4}),
                         at.value({-9, 9, 999}), at.value({1, 2, 4})};
      EXPECT_EQ(found, expected[component]) << grid->valueType() << ' ' << component;
    }
  }
}

TEST_F(LoadField, ReadsNumbersWhateverTheyMean) {
  const openvdb::FloatGrid::Ptr half = ball(5);
  half->setSaveFloatAsHalf(true);
  const auto numbers = named<openvdb::DoubleGrid>("double", 2.5);
  numbers->tree().setValue({1, -2, 3}, -0.1);
  for (const auto& grid : openvdb::GridCPtrVec{ball(5), half, numbers}) {
    const auto volume = loaded({grid});
    ASSERT_TRUE(volume.ok()) << volume.status();
    EXPECT_EQ(volume->kind, VolumeKind::kField);
  }
  EXPECT_EQ(VolumeReader(*load_field(path_, "double", 0)).value({1, -2, 3}), -0.1F);
}

TEST_F(LoadField, TakesOneThatIsBackgroundThroughout) {
  const auto volume = loaded({named<openvdb::FloatGrid>("flat", 4)});
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_EQ(VolumeReader(*volume).value({1, 2, 3}), 4);
}

TEST_F(LoadField, TakesTheOnlyFieldOfAFile) {
  const openvdb::GridCPtrVec grids{named<openvdb::Int32Grid>("count"),
                                   vectors<openvdb::Vec3SGrid>()};
  const auto volume = loaded(grids);
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_EQ(volume->name, "v");
  EXPECT_THAT(std::string(loaded({ball(5), vectors<openvdb::Vec3SGrid>()}).status().message()),
              HasSubstr("it has 2 grids that can be a field; name one of them: 'ball', 'v'"));
  const openvdb::GridCPtrVec numbers{named<openvdb::Int32Grid>("a"),
                                     named<openvdb::BoolGrid>("b")};
  EXPECT_THAT(std::string(loaded(numbers).status().message()),
              HasSubstr("it has 2 grids that can be a field; name one of them: 'a', 'b'"));
  const openvdb::GridCPtrVec others{named<openvdb::Vec3IGrid>("a"),
                                    named<openvdb::Vec3IGrid>("b")};
  EXPECT_THAT(std::string(loaded(others).status().message()),
              HasSubstr("none of its grids can be a field: 'a': its values are vec3i"));
}

TEST_F(LoadField, RefusesOthersAndSaysWhatIsMissing) {
  const auto whole = loaded({named<openvdb::Vec3IGrid>("count")}).status();
  EXPECT_EQ(whole.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(whole.message()),
              AllOf(HasSubstr("grid 'count' of"), HasSubstr("its values are vec3i"),
                    HasSubstr("float, double, int32, int64, bool, vec3s or vec3d")));
  const auto missing = loaded({vectors<openvdb::Vec3SGrid>()}, "w").status();
  EXPECT_EQ(missing.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(missing.message()), HasSubstr("no grid 'w'; the file has 'v'"));
  EXPECT_EQ(loaded({vectors<openvdb::Vec3SGrid>()}, "v", 3).status().code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(loaded({ball(5)}, "ball", 1).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(LoadField, RefusesWhatIsNotFiniteInTheComponentThatHasIt) {
  const auto grid = named<openvdb::Vec3SGrid>("v");
  grid->tree().setValue({1, 2, 3}, {0, std::numeric_limits<float>::quiet_NaN(), 0});
  EXPECT_TRUE(loaded({grid}, "v", 0).ok());
  EXPECT_THAT(std::string(loaded({grid}, "v", 1).status().message()),
              HasSubstr("voxel (1, 2, 3) is nan"));
}

TEST_F(LoadField, ChargesForOneComponentAndItsTree) {
  write_vdb(path_, {vectors<openvdb::Vec3DGrid>()});
  const auto outline = walk_vdb(path_);
  ASSERT_TRUE(outline.ok());
  EXPECT_EQ(loading_charge(*outline, "v").volume, 0U);
  const MemoryCharge charge = loading_charge(*outline, "v", GridUse::kField);
  EXPECT_GE(charge.volume, load_field(path_, "v", 0)->size_bytes());
  EXPECT_GE(charge.reading, charge.volume + 512 * sizeof(openvdb::Vec3d));
  LoadLimits limits;
  limits.max_bytes = charge.volume - 1;
  EXPECT_EQ(load_field(path_, "v", 0, limits).status().code(),
            absl::StatusCode::kResourceExhausted);
}

TEST_F(LoadField, IsToldOfInAList) {
  write_vdb(path_, {ball(5), vectors<openvdb::Vec3DGrid>(), named<openvdb::Int32Grid>("n")});
  const auto grids = list_grids(path_);
  ASSERT_TRUE(grids.ok());
  EXPECT_EQ((*grids)[0].field_components, 1U);
  EXPECT_EQ((*grids)[1].field_components, 3U);
  EXPECT_EQ((*grids)[2].field_components, 1U);
}

}  // namespace
}  // namespace tet
