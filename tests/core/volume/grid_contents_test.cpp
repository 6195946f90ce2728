// What the values of grids tell, and that as bytes that anyone may have written.
#include "core/volume/grid_contents.h"

#include <array>
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume/flat_grid_contents.h"

namespace tet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Label 5 in a slab, -1 at one voxel and 0 elsewhere, in a box that ends at odd places.
LabelVolume slab() {
  constexpr std::array<std::int32_t, 3> kSize{17, 9, 5};
  std::vector<std::int64_t> values;
  for (int z = 0; z < kSize[2]; ++z) {
    for (int y = 0; y < kSize[1]; ++y) {
      for (int x = 0; x < kSize[0]; ++x) values.push_back(z == 2 ? 5 : 0);
    }
  }
  values[3] = -1;
  auto made = make_label_volume(
      {.name = "slab", .transform = {}, .size = kSize, .min = {-4, 1, 30}, .values = values});
  EXPECT_TRUE(made.ok()) << made.status();
  return *std::move(made);
}

/// A block at an address that columns have.
struct Block {
  std::vector<std::byte> bytes;
  alignas(64) std::array<std::byte, 4096> aligned{};

  std::span<const std::byte> span() {
    std::memcpy(aligned.data(), bytes.data(), bytes.size());
    return {aligned.data(), bytes.size()};
  }
};

Block block_of(const GridContents& contents) {
  Block block;
  EXPECT_TRUE(write_flat_contents(contents, [&](auto bytes) {
                block.bytes.insert(block.bytes.end(), bytes.begin(), bytes.end());
                return absl::OkStatus();
              }).ok());
  return block;
}

GridContents some_contents() {
  GridContents contents;
  contents.values = GridValues{{-1, 5}, 0, InsideSide::kAbove, KindSource::kNobody};
  set_labels_of(slab(), contents);
  return contents;
}

TEST(GridContents, HaveTheBoxOfEachLabelsVoxels) {
  GridContents contents;
  set_labels_of(slab(), contents);
  EXPECT_EQ(contents.label_count, 3U);
  EXPECT_THAT(contents.labels,
              ElementsAre(LabelExtent{-1, 1, {{-1, 1, 30}, {-1, 1, 30}}},
                          LabelExtent{0, 17 * 9 * 4 - 1, {{-4, 1, 30}, {12, 9, 34}}},
                          LabelExtent{5, 17 * 9, {{-4, 1, 32}, {12, 9, 32}}}));
}

TEST(FlatGridContents, AreReadAsTheyWereWritten) {
  const GridContents written = some_contents();
  Block block = block_of(written);
  const auto read = read_flat_contents(block.span());
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->values, written.values);
  EXPECT_EQ(read->label_count, written.label_count);
  EXPECT_EQ(read->labels, written.labels);
}

TEST(FlatGridContents, ThatAreCutOrSpoiltAreRefusedOrStillSound) {
  const Block whole = block_of(some_contents());
  for (std::size_t size = 0; size < whole.bytes.size(); ++size) {
    Block cut = whole;
    cut.bytes.resize(size);
    EXPECT_FALSE(read_flat_contents(cut.span()).ok()) << size;
  }
  for (std::size_t at = 0; at < whole.bytes.size(); ++at) {
    Block spoilt = whole;
    spoilt.bytes[at] ^= std::byte{0x80};
    const auto read = read_flat_contents(spoilt.span());
    if (!read.ok()) {
      EXPECT_THAT(std::string(read.status().message()), HasSubstr("is not valid"));
      continue;
    }
    for (std::size_t i = 1; i < read->labels.size(); ++i) {
      EXPECT_LT(read->labels[i - 1].value, read->labels[i].value);
    }
  }
}

}  // namespace
}  // namespace tet
