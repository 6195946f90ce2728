#include "core/vdb/walk/walk_vdb.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <span>
#include <type_traits>

#include <absl/strings/str_format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/vdb/openvdb/load.h"
#include "core/vdb/openvdb/vdb_grids.h"
#include "core/vdb/walk/tree_type.h"
#include "tests/core/vdb/vdb_test_files.h"
#include "tests/support/vdb_bytes.h"
#include "tests/support/vdb_fixtures.h"

namespace tet {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using test::ball;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::uint32_t kAllFlags =
    openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK;

class WalkVdb : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { openvdb::initialize(); }

  test::TestDirectory directory_;
  std::string path_ = directory_.file("test.vdb");
};

VoxelBox box_of(const openvdb::CoordBBox& box) {
  if (box.empty()) return {};
  return {{box.min().x(), box.min().y(), box.min().z()},
          {box.max().x(), box.max().y(), box.max().z()}};
}

/// The outline says of the tree what OpenVDB says.
void expect_counts(const GridOutline& outline, const openvdb::GridBase& grid) {
  const openvdb::TreeBase& tree = grid.baseTree();
  const std::vector<openvdb::Index32> nodes = tree.nodeCount();  // leaves first
  EXPECT_EQ(outline.tree.leaves, nodes[0]);
  EXPECT_EQ(outline.tree.lowers, nodes[1]);
  EXPECT_EQ(outline.tree.uppers, nodes[2]);
  EXPECT_EQ(outline.tree.active_voxels, tree.activeVoxelCount());
  const TreeOutline& t = outline.tree;
  EXPECT_EQ(t.root_tiles.active + t.upper_tiles.active + t.lower_tiles.active,
            tree.activeTileCount());
  const VoxelBox box = box_of(grid.evalActiveVoxelBoundingBox());
  EXPECT_EQ(t.active_box.min, box.min);
  EXPECT_EQ(t.active_box.max, box.max);
  EXPECT_EQ(outline.tree_type, tree.type());
  EXPECT_EQ(outline.half_float, grid.saveFloatAsHalf());
}

template <class GridT>
typename GridT::Ptr scattered(const typename GridT::ValueType& value) {
  auto grid = GridT::create();
  grid->tree().addTile(2, Coord(128, 0, -256), value, /*active=*/true);  // 128 voxels wide
  grid->tree().addTile(1, Coord(64, 0, -8), value, /*active=*/true);     // 8 voxels wide
  for (int i = -9; i < 9; ++i) grid->tree().setValueOn({i * 700, i * i, 8 * i}, value);
  grid->setName("scattered");
  return grid;
}

/// A grid of every layout there is, but for points; other types differ in the size of a value.
openvdb::GridCPtrVec grids_of_all_layouts() {
  return {scattered<FloatGrid>(1),
          scattered<openvdb::DoubleGrid>(2),
          scattered<openvdb::Int32Grid>(3),
          scattered<openvdb::Vec3SGrid>({1, 2, 3}),
          scattered<openvdb::BoolGrid>(true),
          scattered<openvdb::MaskGrid>(true)};
}

TEST_F(WalkVdb, CountsAsOpenVdbDoes) {
  for (const std::string_view kind : test::fixture_kinds()) {
    SCOPED_TRACE(kind);
    test::write_fixture(kind, 0.1, path_);
    openvdb::io::File file(path_);
    file.open(/*delayLoad=*/false);
    const openvdb::GridBase::Ptr grid = file.readGrid(std::string(kind));
    const absl::StatusOr<VdbOutline> outline = walk_vdb(path_);
    ASSERT_TRUE(outline.ok()) << outline.status();
    ASSERT_EQ(outline->grids.size(), 1U);
    expect_counts(outline->grids[0], *grid);
    // A file may have no class, or say that it is unknown.
    const std::string& told = outline->grids[0].grid_class;
    EXPECT_EQ(told.empty() ? "unknown" : told,
              openvdb::GridBase::gridClassToString(grid->getGridClass()));
  }
}

TEST_F(WalkVdb, AcceptsEveryLayoutInEveryCompression) {
  const openvdb::GridCPtrVec grids = grids_of_all_layouts();
  for (std::uint32_t flags = 0; flags <= kAllFlags; ++flags) {
    for (const bool half : {false, true}) {
      for (const auto& grid : grids) {
        std::const_pointer_cast<openvdb::GridBase>(grid)->setSaveFloatAsHalf(half);
      }
      for (const bool offsets : {false, true}) {
        SCOPED_TRACE(absl::StrFormat("flags %d, half %d, offsets %d", flags, half, offsets));
        const std::string bytes = test::vdb_bytes(grids, {flags, offsets});
        const absl::StatusOr<VdbOutline> outline = test::walk_bytes(bytes);
        ASSERT_TRUE(outline.ok()) << outline.status();
        ASSERT_EQ(outline->grids.size(), grids.size());
        for (std::size_t i = 0; i < grids.size(); ++i) {
          expect_counts(outline->grids[i], *grids[i]);
        }
      }
    }
  }
}

template <class GridT>
struct ExpectKnown {
  void operator()() const {
    EXPECT_TRUE(openvdb::GridBase::isRegistered(GridT::gridType()));
    const TreeType* type = find_tree_type(GridT::gridType());
    ASSERT_NE(type, nullptr) << GridT::gridType();
    if (!std::is_same_v<GridT, openvdb::MaskGrid>) {
      EXPECT_EQ(type->value_bytes, sizeof(typename GridT::ValueType)) << type->name;
    }
  }
};

TEST_F(WalkVdb, KnowsEveryTypeThatTheReaderBuilds) {
  openvdb::GridTypes::foreach<ExpectKnown>();
}

template <class... Types, class Visit>
void for_each_metadata(openvdb::TypeList<Types...> /*all*/, const Visit& visit) {
  (visit(Types()), ...);
}

TEST_F(WalkVdb, KnowsTheSizeOfEveryTypeOfMetadata) {
  openvdb::MetaMap every;
  for_each_metadata(openvdb::MetaTypes(), [&](const openvdb::Metadata& metadata) {
    every.insertMeta(metadata.typeName(), metadata);
  });
  const FloatGrid::Ptr grid = ball(4);
  grid->insertMeta(every);
  const std::string bytes = test::vdb_bytes({grid});
  EXPECT_TRUE(test::walk_bytes(bytes).ok()) << test::walk_bytes(bytes).status();
}

TEST_F(WalkVdb, LooksAtEveryByteOnce) {
  for (const std::string& bytes : test::small_files()) {
    std::vector<VdbField> fields;
    ASSERT_TRUE(test::walk_bytes(bytes, &fields).ok());
    std::uint64_t end = 0;
    for (const VdbField& field : fields) {
      ASSERT_EQ(field.offset, end) << field.what;
      end += field.bytes;
    }
    EXPECT_EQ(end, bytes.size());
  }
}

TEST_F(WalkVdb, RefusesEveryTruncation) {
  for (const std::string& bytes : test::small_files()) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const ByteSource part(std::as_bytes(std::span(bytes)).first(size));
      const absl::Status status = walk_vdb(part).status();
      ASSERT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << size << ' ' << status;
    }
  }
}

TEST_F(WalkVdb, RefusesWhatFollowsTheEnd) {
  for (const std::string& bytes : test::small_files()) {
    EXPECT_THAT(std::string(test::walk_bytes(bytes + '\0').status().message()),
                HasSubstr("1 bytes follow the last grid"));
  }
}

TEST_F(WalkVdb, TellsAFileAsItTellsMemory) {
  const FloatGrid::Ptr grid = ball(60);
  const std::string bytes = test::vdb_bytes({grid}, {openvdb::io::COMPRESS_NONE});
  ASSERT_GT(bytes.size(), 4U << 20) << "several windows";
  test::write_bytes(path_, bytes);
  const absl::StatusOr<VdbOutline> outline = walk_vdb(path_);
  ASSERT_TRUE(outline.ok()) << outline.status();
  EXPECT_EQ(outline->file_bytes, bytes.size());
  expect_counts(outline->grids.at(0), *grid);
  for (const std::size_t part : {1, 3, 5, 7}) {
    test::write_bytes(path_, bytes.substr(0, bytes.size() * part / 8));
    EXPECT_EQ(walk_vdb(path_).status().code(), absl::StatusCode::kInvalidArgument) << part;
  }
}

TEST_F(WalkVdb, EndsWhereverItIsCancelled) {
  test::write_bytes(path_, test::vdb_bytes({ball(60)}, {openvdb::io::COMPRESS_NONE}));
  int asked = 0, last = std::numeric_limits<int>::max();
  const auto walk = [&] {
    asked = 0;
    return walk_vdb(path_, {.cancelled = [&] { return ++asked >= last; }}).status();
  };
  ASSERT_EQ(walk(), absl::OkStatus());
  const int all = asked;
  ASSERT_GT(all, 10) << "several windows";
  for (last = 1; last <= all; ++last) {
    EXPECT_EQ(walk().code(), absl::StatusCode::kCancelled) << last;
    EXPECT_EQ(asked, last);
  }
}

TEST_F(WalkVdb, TellsInstancesByTheirParents) {
  const FloatGrid::Ptr first = ball(9, "first");
  const FloatGrid::Ptr second = first->copyWithNewTree();
  second->setTree(first->treePtr());
  second->setName("second");
  const absl::StatusOr<VdbOutline> outline = test::walk_bytes(test::vdb_bytes({first, second}));
  ASSERT_TRUE(outline.ok()) << outline.status();
  EXPECT_FALSE(outline->grids.at(0).instance);
  EXPECT_TRUE(outline->grids.at(1).instance);
  expect_counts(outline->grids[1], *second);
}

TEST_F(WalkVdb, TellsGridsOfOneNameApart) {
  const absl::StatusOr<VdbOutline> outline =
      test::walk_bytes(test::vdb_bytes({ball(4, "a"), ball(5, "a")}));
  ASSERT_TRUE(outline.ok()) << outline.status();
  EXPECT_EQ(outline->grids.at(0).name, "a[0]");
  EXPECT_EQ(outline->grids.at(1).name, "a[1]");
}

TEST_F(WalkVdb, AcceptsEveryTransformThatOpenVdbWrites) {
  using openvdb::math::Transform;
  openvdb::math::Transform turned;
  turned.postRotate(0.7, openvdb::math::X_AXIS);
  std::vector<Transform::Ptr> transforms{Transform::createLinearTransform(0.1), turned.copy()};
  const auto derived = [&](const std::function<void(Transform&)>& change) {
    transforms.push_back(Transform::createLinearTransform());
    change(*transforms.back());
  };
  derived([](Transform& t) { t.preScale(openvdb::Vec3d(0.1, 2, -3)); });
  derived([](Transform& t) { t.postTranslate({1, 2e9, -3e-9}); });
  derived([](Transform& t) {
    t.preScale(0.3);
    t.postTranslate({1, 2, 3});
  });
  derived([](Transform& t) {
    t.preScale(openvdb::Vec3d(0.1, 0.2, 0.3));
    t.postTranslate({1, 2, 3});
    t.preShear(0.5, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
  });
  transforms.push_back(
      Transform::createFrustumTransform(openvdb::BBoxd({-9, -9, -9}, {9, 9, 9}), 0.5, 20, 1));
  for (const Transform::Ptr& transform : transforms) {
    const FloatGrid::Ptr grid = ball(4);
    grid->setTransform(transform);
    const auto outline = test::walk_bytes(test::vdb_bytes({grid}));
    EXPECT_TRUE(outline.ok()) << transform->mapType() << ": " << outline.status();
  }
}

TEST_F(WalkVdb, TellsABombFromItsTiles) {
  const FloatGrid::Ptr grid = FloatGrid::create(1);
  grid->tree().root().addTile(Coord(0, 4096, -8192), -1, true);
  grid->tree().addTile(2, Coord(4096, 0, 0), -1, true);  // 128 voxels wide
  grid->tree().addTile(2, Coord(8064, 0, 0), -1, false);
  const absl::StatusOr<VdbOutline> outline = test::walk_bytes(test::vdb_bytes({grid}));
  ASSERT_TRUE(outline.ok()) << outline.status();
  const TreeOutline& tree = outline->grids.at(0).tree;
  EXPECT_EQ(tree.active_voxels, (1ULL << 36) + (1ULL << 21));
  EXPECT_EQ(tree.root_tiles.active, 1U);
  EXPECT_EQ(tree.upper_tiles.active, 1U);
  EXPECT_EQ(tree.upper_tiles.stored, 2U);
  EXPECT_EQ(tree.active_box.min, (VoxelCoord{0, 0, -8192}));
  EXPECT_EQ(tree.active_box.max, (VoxelCoord{4223, 8191, 127}));
  EXPECT_EQ(tree.stored_box.max, (VoxelCoord{8191, 8191, 127}));
}

TEST_F(WalkVdb, ChargesNoLessThanReadingTakes) {
  openvdb::GridCPtrVec grids = grids_of_all_layouts();
  grids.push_back(ball(40, "ball"));
  const absl::StatusOr<VdbOutline> outline = test::walk_bytes(test::vdb_bytes(grids));
  ASSERT_TRUE(outline.ok()) << outline.status();
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const TreeOutline& tree = outline->grids[i].tree;
    const std::uint64_t used = grids[i]->memUsage();
    EXPECT_GE(tree.topology_bytes + tree.value_bytes, used) << outline->grids[i].tree_type;
    EXPECT_LE(tree.topology_bytes + tree.value_bytes, used + used / 2);
  }
  test::write_vdb(path_, {grids.back()});
  const absl::StatusOr<Volume> volume = load_volume(path_, "");
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_GE(outline->grids.back().tree.volume_bytes, volume->size_bytes());
  EXPECT_LE(outline->grids.back().tree.volume_bytes, 2 * volume->size_bytes());
}

TEST_F(WalkVdb, ChargesForAVolumeOfHardlyAnything) {
  for (const std::size_t letters : {1, 15, 16, 29, 31, 200}) {
    const FloatGrid::Ptr tile = FloatGrid::create(1);
    tile->setName(std::string(letters, 'n'));
    tile->tree().addTile(3, openvdb::Coord(0, 0, 0), -1, true);
    test::write_vdb(path_, {tile});
    const absl::StatusOr<VdbOutline> outline = walk_vdb(path_);
    ASSERT_TRUE(outline.ok()) << outline.status();
    const absl::StatusOr<Volume> volume = load_volume(path_, "");
    ASSERT_TRUE(volume.ok()) << volume.status();
    EXPECT_GE(loading_charge(*outline, "").volume, volume->size_bytes()) << letters;
  }
}

TEST_F(WalkVdb, HoldsToItsLimits) {
  const std::string bytes = test::vdb_bytes({ball(4, "a"), ball(4, "b")});
  const auto source = ByteSource(std::as_bytes(std::span(bytes)));
  const absl::Status grids = walk_vdb(source, {.grids = 1}).status();
  EXPECT_EQ(grids.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(grids.message()), HasSubstr("2 grids and the limit is 1"));
  const absl::Status entries = walk_vdb(source, {.metadata = {.entries = 2}}).status();
  EXPECT_EQ(entries.code(), absl::StatusCode::kResourceExhausted);
  const absl::Status metadata = walk_vdb(source, {.metadata = {.bytes = 16}}).status();
  EXPECT_EQ(metadata.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(metadata.message()), HasSubstr("limit of 16 bytes"));
}

TEST_F(WalkVdb, TellsNamesEscapedAndCut) {
  const FloatGrid::Ptr grid = ball(4);
  grid->insertMeta(std::string(500, '\x1b'), openvdb::FloatMetadata(1));
  const std::string lie = test::with_lie(test::vdb_bytes({grid}), "metadata size", 0, 5);
  const std::string message(test::walk_bytes(lie).status().message());
  EXPECT_THAT(message, HasSubstr("\\x1b\\x1b"));
  EXPECT_LE(message.size(), 300U);
  EXPECT_TRUE(std::all_of(message.begin(), message.end(), [](char c) {
    return c >= ' ' && c <= '~';
  })) << message;
}

}  // namespace
}  // namespace tet
