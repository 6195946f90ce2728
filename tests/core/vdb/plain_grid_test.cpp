// What is read without OpenVDB is what OpenVDB reads, bit by bit.
#include "core/vdb/plain/plain_grid.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/vdb/openvdb/load.h"
#include "core/vdb/openvdb/read_grid_file.h"
#include "core/vdb/plain/plain_tree.h"
#include "core/vdb/plain/unpack_chunk.h"
#include "core/vdb/walk/plain_choice.h"
#include "core/vdb/walk/walk_vdb.h"
#include "core/volume/flat_grid_list.h"
#include "core/volume/flat_volume.h"
#include "tests/core/vdb/vdb_test_files.h"
#include "tests/support/sanitized.h"
#include "tests/support/vdb_bytes.h"
#include "tests/support/vdb_fixtures.h"

namespace tet {
namespace {

using openvdb::Coord;
using openvdb::DoubleGrid;
using openvdb::FloatGrid;
using openvdb::GridBase;
using openvdb::io::COMPRESS_ACTIVE_MASK;
using openvdb::io::COMPRESS_BLOSC;
using openvdb::io::COMPRESS_ZIP;
using openvdb::math::Transform;

constexpr unsigned kSeed = 20'261'126;

const std::vector<std::uint32_t> kCompressions{0,
                                               COMPRESS_ACTIVE_MASK,
                                               COMPRESS_BLOSC,
                                               COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK,
                                               COMPRESS_ZIP,
                                               COMPRESS_ZIP | COMPRESS_ACTIVE_MASK};

ByteSink into(std::string& bytes) {
  return [&bytes](std::span<const std::byte> more) {
    bytes.append(reinterpret_cast<const char*>(more.data()), more.size());
    return absl::OkStatus();
  };
}

/// The flat bytes of what was read, or why nothing was.
std::string told(const absl::StatusOr<Volume>& volume) {
  if (!volume.ok()) return volume.status().ToString();
  std::string bytes;
  EXPECT_TRUE(write_flat_volume(*volume, into(bytes)).ok());
  return bytes;
}

std::string told(const absl::StatusOr<std::vector<GridInfo>>& grids) {
  if (!grids.ok()) return grids.status().ToString();
  std::string bytes;
  EXPECT_TRUE(write_flat_grid_list(*grids, into(bytes)).ok());
  return bytes;
}

absl::StatusOr<const OpenVdbPart*> no_openvdb() { return absl::InternalError("not plain"); }

class PlainGrid : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { openvdb::initialize(); }

  void write(const std::string& bytes) { std::ofstream(path_, std::ios::binary) << bytes; }

  /// Both readers say the same of the file: of a grid of that name, as a surface and as a
  /// field, and of its list. The plain one must do without OpenVDB.
  void expect_same(const std::string& name = "") {
    const absl::StatusOr<File> file = open_grid_file(path_);
    ASSERT_TRUE(file.ok());
    const OpenGridFile opened{file->descriptor().number(),
                              static_cast<std::int64_t>(*file->size()), path_};
    const GridFileReader plain(opened, {}, no_openvdb);
    const std::string volume = told(plain.volume(name));
    EXPECT_TRUE(volume == told(load_volume(opened, name)));
    EXPECT_TRUE(told(plain.field(name, 0)) == told(load_field(opened, name, 0)));
    EXPECT_TRUE(told(plain.list()) == told(list_grids(opened)));
    EXPECT_THAT(volume, ::testing::Not(::testing::HasSubstr("not plain")));
  }

  void expect_same_of(const openvdb::GridCPtrVec& grids, const std::string& name = "") {
    for (std::size_t c = 0; c < kCompressions.size(); ++c) {
      const std::uint32_t compression = kCompressions[c];
      for (const bool offsets : {true, false}) {
        // A sanitizer sees each compression once: with masks and without, each with offsets and
        // without.
        if (test::kSanitized && offsets != ((c + c / 2) % 2 == 0)) continue;
        SCOPED_TRACE(testing::Message() << "compression " << compression << offsets);
        write(test::vdb_bytes(grids, {compression, offsets}));
        expect_same(name);
      }
    }
  }

  test::TestDirectory directory_;
  std::string path_ = directory_.file("test.vdb");
};

/// Voxels and tiles of every level, active and not, of few values and of many; `values` says
/// how many differ where they are not active.
template <class GridT>
typename GridT::Ptr random_grid(unsigned seed, double background, int values) {
  using ValueT = typename GridT::ValueType;
  std::mt19937 random(seed);
  const auto grid = GridT::create(static_cast<ValueT>(background));
  grid->setName("random");
  const auto inactive = [&] {
    const auto nth = static_cast<int>(random() % static_cast<unsigned>(values));
    return static_cast<ValueT>(nth == 0   ? background
                               : nth == 1 ? -background
                                          : static_cast<double>(nth));
  };
  auto& tree = grid->tree();
  tree.root().addTile(Coord(0, 0, 4096), ValueT(-1), true);
  tree.root().addTile(Coord(-4096, 0, 0), inactive(), false);
  for (int i = 0; i < 6; ++i) {
    const auto at = static_cast<int>(random() % 32U);
    tree.addTile(2, Coord(128 * at, 128, 0), inactive(), i % 2 == 0);
    tree.addTile(1, Coord(8 * at, 16, -64), inactive(), i % 2 == 0);
  }
  for (int leaf = 0; leaf < 12; ++leaf) {
    const Coord corner(static_cast<int>(random() % 40U) * 8 - 160,
                       static_cast<int>(random() % 3U) * 8,
                       static_cast<int>(random() % 3U) * 4096);
    const auto active = leaf == 0 ? 0 : leaf == 1 ? 100 : random() % 101;
    for (int v = 0; v < 512; ++v) {
      const Coord c = corner + Coord(v >> 6, v >> 3 & 7, v & 7);
      if (random() % 100U < active) {
        tree.setValueOn(
            c, static_cast<ValueT>(std::ldexp(static_cast<double>(random()), -20) - 2000));
      } else {
        tree.setValueOff(c, inactive());
      }
    }
  }
  return grid;
}

TEST_F(PlainGrid, IsReadAsOpenVdbReadsIt) {
  for (unsigned seed = 0; seed < 2; ++seed) {
    for (const int values : {1, 2, 3, 40}) {
      // A sanitizer sees each number of values once, and each seed.
      if (test::kSanitized && values % 2 == static_cast<int>(seed)) continue;
      SCOPED_TRACE(testing::Message() << "seed " << kSeed + seed << " values " << values);
      const auto grid = random_grid<FloatGrid>(kSeed + seed, seed % 2 == 0 ? 3 : -0.5, values);
      expect_same_of({grid});
      grid->setSaveFloatAsHalf(true);
      expect_same_of({grid});
    }
  }
}

TEST_F(PlainGrid, OfDoublesIsReadAsOpenVdbReadsIt) {
  for (const int values : test::few_of(std::vector{1, 2, 3, 40}, 2)) {
    const auto grid = random_grid<DoubleGrid>(kSeed, 3, values);
    expect_same_of({grid});
    grid->setSaveFloatAsHalf(true);
    expect_same_of({grid});
  }
}

TEST_F(PlainGrid, HasItsClassAndMetadata) {
  const FloatGrid::Ptr grid = test::ball(12);
  for (const char* const text : {"level set", " Fog Volume ", "staggered", "?"}) {
    grid->insertMeta("class", openvdb::StringMetadata(text));
    expect_same_of({grid});
  }
  grid->insertMeta("tetstream_surface", openvdb::StringMetadata("closed\nof 12 triangles"));
  grid->insertMeta("tetstream_surface_warning_1",
                   openvdb::StringMetadata(std::string(1500, 'w')));
  grid->insertMeta("tetstream_surface_warning_2", openvdb::Int32Metadata(3));
  expect_same_of({grid});
}

TEST_F(PlainGrid, LiesWhereItsMapSays) {
  const FloatGrid::Ptr grid = test::ball(5);
  const std::vector<openvdb::math::MapBase::Ptr> maps{
      std::make_shared<openvdb::math::UniformScaleMap>(0.1),
      std::make_shared<openvdb::math::UniformScaleMap>(-0.1),
      std::make_shared<openvdb::math::ScaleMap>(openvdb::Vec3d(0.1, -0.2, 0.4)),
      std::make_shared<openvdb::math::TranslationMap>(openvdb::Vec3d(0.1, -0.0, -7)),
      std::make_shared<openvdb::math::UniformScaleTranslateMap>(0.3, openvdb::Vec3d(1, -2, 0)),
      std::make_shared<openvdb::math::ScaleTranslateMap>(openvdb::Vec3d(-0.3, 0.7, 0.1),
                                                         openvdb::Vec3d(-0.0, 2, 1e9)),
      std::make_shared<openvdb::math::ScaleMap>(openvdb::Vec3d(1e-6, 1, 1e7))};
  for (const auto& map : maps) {
    SCOPED_TRACE(map->type());
    grid->setTransform(std::make_shared<Transform>(map));
    expect_same_of({grid});
  }
}

TEST_F(PlainGrid, IsRefusedAsOpenVdbRefusesIt) {
  expect_same_of({FloatGrid::create(1)});
  const FloatGrid::Ptr odd = test::ball(5);
  odd->tree().setValueOn(Coord(1, 2, 3), std::numeric_limits<float>::quiet_NaN());
  expect_same_of({odd});
  const FloatGrid::Ptr tile = FloatGrid::create(1);
  tile->tree().root().addTile(Coord(0, 0, 4096), 1, false);
  expect_same_of({tile});
}

/// Everything differs from NaN: all 4096 tiles of a node that stores none of them would.
TEST_F(PlainGrid, WithoutABackgroundIsRefusedBeforeItsTilesAreGathered) {
  const FloatGrid::Ptr grid = FloatGrid::create(std::numeric_limits<float>::quiet_NaN());
  grid->tree().setValueOn(Coord(1, 2, 3), 1);
  expect_same_of({grid});
  const std::string bytes = test::vdb_bytes({grid}, {COMPRESS_ACTIVE_MASK, true});
  const ByteSource source(std::as_bytes(std::span(bytes)));
  const absl::StatusOr<VdbOutline> outline = walk_vdb(source);
  ASSERT_TRUE(outline.ok());
  Volume volume;
  EXPECT_THAT(read_plain_tree(source, outline->grids[0], volume).status().message(),
              ::testing::HasSubstr("the background value is nan"));
  EXPECT_EQ(volume.cubes.capacity(), 0U);
}

TEST_F(PlainGrid, IsFoundByItsName) {
  const openvdb::GridCPtrVec grids{test::ball(4, "a"), test::ball(6, "b", {40, 0, 0}),
                                   test::ball(5, "b")};
  for (const char* const name : {"a", "b[0]", "b[1]"}) expect_same_of(grids, name);
}

TEST_F(PlainGrid, OfFixturesIsReadAsOpenVdbReadsIt) {
  for (const char* const kind :
       {"sphere", "torus", "gyroid", "cavity", "random-signs", "fog"}) {
    SCOPED_TRACE(kind);
    test::write_fixture(kind, 0.1, path_);
    expect_same();
  }
}

/// A byte of a tree is another one: either both say that it is broken, or they read the same;
/// but OpenVDB takes what zlib's own checksum is wrong of.
TEST_F(PlainGrid, OfBrokenBytesIsReadAsOpenVdbReadsIt) {
  std::mt19937 random(kSeed);
  int accepted = 0, refused = 0;
  for (const std::string& whole : test::small_files()) {
    const auto outline = test::walk_bytes(whole);
    ASSERT_TRUE(outline.ok());
    if (outline->grids.empty()) continue;
    const std::size_t begin = outline->grids.front().tree_at;
    for (int trial = 0; trial < 60; ++trial) {
      std::string mutant = whole;
      mutant[begin + random() % (mutant.size() - begin)] = static_cast<char>(random());
      write(mutant);
      const absl::StatusOr<Volume> expected = load_volume(path_, "");
      const absl::StatusOr<Volume> volume =
          with_grid_file(path_, [](const GridFileReader& file) { return file.volume(""); });
      if (expected.ok() && !volume.ok()) {
        ASSERT_THAT(volume.status().message(), ::testing::HasSubstr("zlib cannot unpack"));
        continue;
      }
      ASSERT_EQ(volume.status().code(), expected.status().code())
          << volume.status() << " instead of " << expected.status();
      if (volume.ok()) {
        ASSERT_TRUE(told(volume) == told(expected));
      }
      ++(volume.ok() ? accepted : refused);
    }
  }
  EXPECT_GT(accepted, 20);
  EXPECT_GT(refused, 20);
}

TEST(PlainChoice, LeavesToOpenVdbWhatIsNotPlain) {
  const auto rotated = Transform::createLinearTransform(0.5);
  rotated->postRotate(0.7, openvdb::math::X_AXIS);
  const FloatGrid::Ptr turned = test::ball(4);
  turned->setTransform(rotated);
  const auto bits = openvdb::BoolGrid::create();
  for (const GridBase::Ptr& grid : {GridBase::Ptr(turned), GridBase::Ptr(bits)}) {
    const auto outline = test::walk_bytes(test::vdb_bytes({grid}));
    ASSERT_TRUE(outline.ok());
    EXPECT_FALSE(find_plain_grid(*outline, "", GridUse::kSurface, 0));
    EXPECT_FALSE(are_plain_grids(*outline));
  }
  const auto outline = test::walk_bytes(test::vdb_bytes({test::ball(4), test::ball(5)}));
  ASSERT_TRUE(outline.ok());
  EXPECT_FALSE(find_plain_grid(*outline, "", GridUse::kSurface, 0));  // which one?
  EXPECT_FALSE(find_plain_grid(*outline, "none", GridUse::kSurface, 0));
  EXPECT_FALSE(find_plain_grid(*outline, "ball[1]", GridUse::kField, 1));
  EXPECT_FALSE(find_plain_grid(*outline, "ball[1]", GridUse::kLabels, 0));
  EXPECT_EQ(find_plain_grid(*outline, "ball[1]", GridUse::kSurface, 0), 1);
}

TEST(HalfToFloat, GivesEveryHalfFloatItsValue) {
  for (std::uint32_t i = 0; i < 0x10000; ++i) {
    openvdb::math::half half;
    half.setBits(static_cast<std::uint16_t>(i));
    const float expected = half, value = half_to_float(static_cast<std::uint16_t>(i));
    ASSERT_EQ(std::bit_cast<std::uint32_t>(value), std::bit_cast<std::uint32_t>(expected)) << i;
  }
}

}  // namespace
}  // namespace tet
