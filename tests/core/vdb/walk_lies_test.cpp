// One field at a time says something else than the rest of the file, and is refused for it.
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/vdb/openvdb/vdb_grids.h"
#include "core/vdb/walk/walk_vdb.h"
#include "tests/core/vdb/vdb_test_files.h"
#include "tests/support/vdb_bytes.h"

namespace tet {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kMinus1 = ~std::uint64_t{0};

enum class LieFile : std::uint8_t { kBlosc, kZip, kStream, kTiles, kBits, kInstance };

struct Lie {
  LieFile file;
  const char* field;
  std::size_t nth;
  std::uint64_t value;
  const char* refusal;
};

void PrintTo(const Lie& lie, std::ostream* out) { *out << lie.field << " = " << lie.value; }

/// Two lower nodes and several leaves, each of them partly active.
openvdb::FloatGrid::Ptr lie_ball() {
  const openvdb::FloatGrid::Ptr grid = test::ball(6, "ball", {60, 60, 120});
  grid->setSaveFloatAsHalf(false);  // which the metadata then says
  return grid;
}

/// The grid has no class, as OpenVDB does not use zlib for level sets.
openvdb::FloatGrid::Ptr unknown_ball() {
  const openvdb::FloatGrid::Ptr grid = lie_ball();
  grid->setGridClass(openvdb::GRID_UNKNOWN);
  return grid;
}

openvdb::GridCPtrVec tiles() {
  const openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(1);
  grid->tree().root().addTile({0, 0, 4096}, -1, true);
  grid->tree().root().addTile({0, 4096, 0}, -1, true);
  grid->tree().addTile(2, {0, 0, 0}, -1, true);
  return {grid};
}

openvdb::GridCPtrVec bits() {
  const openvdb::BoolGrid::Ptr grid = openvdb::BoolGrid::create();
  grid->tree().setValueOn({1, 2, 3}, true);
  return {grid};
}

openvdb::GridCPtrVec instances() {
  const openvdb::FloatGrid::Ptr first = test::ball(3, "first");
  const openvdb::FloatGrid::Ptr second = first->copyWithNewTree();
  second->setTree(first->treePtr());
  second->setName("second");
  return {first, second};
}

std::string true_file(LieFile file) {
  constexpr std::uint32_t kMask = openvdb::io::COMPRESS_ACTIVE_MASK;
  switch (file) {
    case LieFile::kBlosc:
      return test::vdb_bytes({lie_ball()});
    case LieFile::kZip:
      return test::vdb_bytes({unknown_ball()}, {openvdb::io::COMPRESS_ZIP});
    case LieFile::kStream:
      return test::vdb_bytes({lie_ball()}, {kMask, false});
    case LieFile::kTiles:
      return test::vdb_bytes(tiles());
    case LieFile::kBits:
      return test::vdb_bytes(bits());
    default:
      return test::vdb_bytes(instances());
  }
}

/// Each of them alone makes its file be refused, in these words.
void expect_told(const std::vector<Lie>& lies) {
  openvdb::initialize();
  for (const Lie& lie : lies) {
    SCOPED_TRACE(::testing::PrintToString(lie));
    const std::string bytes =
        test::with_lie(true_file(lie.file), lie.field, lie.nth, lie.value);
    const absl::Status status = test::walk_bytes(bytes).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(lie.refusal));
    EXPECT_LE(status.message().size(), 300U);
  }
}

constexpr auto kBlosc = LieFile::kBlosc;
constexpr auto kZip = LieFile::kZip;

TEST(WalkLies, InTheHeaderAreTold) {
  expect_told({Lie{kBlosc, "magic number", 0, 1, "no VDB file"},
               Lie{kBlosc, "format", 0, 221, "only 222 to 224"},
               Lie{kBlosc, "format", 0, 225, "only 222 to 224"},
               Lie{kBlosc, "library major version", 0, 100, "OpenVDB 100.0"},
               Lie{kBlosc, "offsets flag", 0, 2, "flag for offsets is 2"},
               Lie{kBlosc, "offsets flag", 0, 0, "in a file that has none"},
               Lie{kBlosc, "uuid", 0, 'g', "uuid"},
               Lie{kBlosc, "grid count", 0, 0, "bytes follow the last grid"},
               Lie{kBlosc, "grid count", 0, kMinus1, "-1 grids do not fit"},
               Lie{kBlosc, "grid count", 0, 1U << 30, "grids do not fit"}});
}

TEST(WalkLies, InMetadataAreTold) {
  expect_told({Lie{kBlosc, "metadata count", 1, kMinus1, "do not fit"},
               Lie{kBlosc, "metadata name", 0, 2000, "2000 characters; the limit is 1024"},
               Lie{kBlosc, "metadata type", 0, 65, "65 characters; the limit is 64"},
               Lie{kBlosc, "metadata size", 0, kMinus1, "claims 4294967295 bytes"},
               Lie{kBlosc, "places count", 0, 3, "places of leaves"},
               Lie{kBlosc, "places length", 0, 1U << 31, "places of leaves claim"},
               Lie{kBlosc, "metadata flag", 0, 1, "disagree whether"},
               Lie{kBlosc, "metadata flag", 0, 2, "flag is 2"}});
}

TEST(WalkLies, OfAGridAreTold) {
  expect_told({Lie{kBlosc, "grid name", 0, 1U << 31, "characters; the limit is 1024"},
               Lie{kBlosc, "grid type", 0, 65, "characters; the limit is 64"},
               Lie{kBlosc, "instance parent", 0, 1025, "characters; the limit is 1024"},
               Lie{kBlosc, "grid offset", 0, 0, "start offset is 0 instead of"},
               Lie{kBlosc, "block offset", 0, kMinus1, "block offset is -1 instead of"},
               Lie{kBlosc, "end offset", 0, 1U << 30, "end offset is 1073741824 instead of"},
               Lie{LieFile::kStream, "end offset", 0, 9, "in a file that has none"},
               Lie{kBlosc, "compression", 0, 8, "compression 0x8 is not known"},
               Lie{kBlosc, "scale", 0, 0x7ff0000000000000, "the scale is inf"},
               Lie{kBlosc, "scale", 0, 0, "uniform scale"},
               Lie{kBlosc, "inverse scale", 1, 0, "where its scale gives"},
               Lie{LieFile::kInstance, "instance parent text", 1, 0x7473726967,
                   "shares the tree of 'girst'"}});
}

TEST(WalkLies, InATreeAreTold) {
  expect_told(
      {Lie{kBlosc, "buffer count", 0, 2, "2 buffers"},
       Lie{kBlosc, "root tile count", 0, 1U << 28, "claims 268435456 tiles"},
       Lie{kBlosc, "root child count", 0, kMinus1, "claims 0 tiles and 4294967295 children"},
       Lie{kBlosc, "root origin", 0, 8, "must be a multiple of 4096"},
       Lie{kBlosc, "root origin", 0, 1U << 31, "within 1073741824 of the origin"},
       Lie{LieFile::kTiles, "root origin", 1, 0, "two entries at (0, 0, 0)"},
       Lie{LieFile::kTiles, "root tile state", 0, 2, "state 2"},
       Lie{LieFile::kTiles, "child mask", 0, kMinus1, "1 children of a node are active"},
       Lie{kBlosc, "leaf mask", 0, 0x123456789abcdef, "another mask"},
       Lie{kBlosc, "leaf mask again", 1, 0x123456789abcdef, "another mask"},
       Lie{LieFile::kBits, "leaf origin", 0, 8, "a leaf says that it lies at"}});
}

TEST(WalkLies, OfValuesAreTold) {
  expect_told(
      {Lie{kBlosc, "inactive code", 2, 7, "code 7; there are 0 to 6"},
       Lie{kBlosc, "inactive code", 2, 255, "code 255"},
       Lie{kZip, "inactive code", 0, 0, "a grid that stores them all"},
       Lie{kBlosc, "chunk length", 3, kMinus1, "has the length -1"},
       Lie{kBlosc, "chunk length", 3, 1ULL << 63, "has the length -9223372036854775808"},
       Lie{kBlosc, "chunk length", 3, 1ULL << 40, "claims 1099511627776 bytes"},
       Lie{kBlosc, "chunk length", 3, 15, "cannot have made 15 bytes"},
       Lie{kZip, "chunk length", 3, 7, "zlib cannot have made 7 bytes of"},
       Lie{kZip, "zlib method", 3, 0x79, "begins no zlib stream"}});
}

TEST(WalkLies, WithinBloscAreTold) {
  expect_told({Lie{kBlosc, "blosc format", 5, 3, "blosc format 3"},
               Lie{kBlosc, "blosc flags", 5, 0x48, "blosc format 2 with flags 0x48"},
               Lie{kBlosc, "blosc flags", 5, 0x61, "blosc codec 3"},
               Lie{kBlosc, "blosc value size", 5, 0, "values of 0 bytes"},
               Lie{kBlosc, "blosc size", 5, 1U << 30, "says that it holds 1073741824"},
               Lie{kBlosc, "blosc size", 5, kMinus1, "says that it holds -1"},
               Lie{kBlosc, "blosc block size", 5, 0, "blocks of 0 bytes"},
               Lie{kBlosc, "blosc block size", 5, 1U << 30, "do not fit"},
               Lie{kBlosc, "blosc length", 5, 17, "says that it is 17 bytes long"},
               Lie{kBlosc, "blosc block start", 5, 0, "a blosc block begins at"},
               Lie{kBlosc, "blosc stream length", 5, kMinus1, "a blosc stream of"},
               Lie{kBlosc, "blosc stream length", 5, 0, "a blosc stream of"}});
}

}  // namespace
}  // namespace tet
