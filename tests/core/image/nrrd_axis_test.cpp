#include "core/image/nrrd_axis.h"

#include <span>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/image/load_image.h"

namespace tet {
namespace {

using ::testing::HasSubstr;

/// An image of 4 x 5 x 6 bytes with these fields, in NRRD.
absl::StatusOr<Volume> nrrd_with(const std::string& fields) {
  std::string bytes =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 5 6\nencoding: raw\n" + fields + "\n";
  for (int i = 0; i < 4 * 5 * 6; ++i) bytes += static_cast<char>(i);
  return load_image(ByteSource(std::as_bytes(std::span(bytes))), "", ImageUse::kField);
}

/// An image of 512 x 2 x 2 bytes, whose first axis has these fields.
absl::StatusOr<Volume> long_nrrd_with(const std::string& spacing,
                                      const std::string& max,
                                      const std::string& centers) {
  std::string bytes =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 512 2 2\nencoding: raw\nspacings: " +
      spacing + " 1 1\naxis mins: 0 nan nan\naxis maxs: " + max +
      " nan nan\ncenters: " + centers + " ??? ???\n\n";
  for (int i = 0; i < 512 * 2 * 2; ++i) bytes += static_cast<char>(i / 3);
  return load_image(ByteSource(std::as_bytes(std::span(bytes))), "", ImageUse::kField);
}

/// Expects the first voxel and the last one at these places.
void expect_places(const std::string& fields, const WorldPoint& first, const WorldPoint& last) {
  const auto volume = nrrd_with(fields);
  ASSERT_TRUE(volume.ok()) << fields << volume.status();
  EXPECT_EQ(volume->transform.to_world({0, 0, 0}), first) << fields;
  EXPECT_EQ(volume->transform.to_world({3, 4, 5}), last) << fields;
}

TEST(NrrdAxes, LieBetweenTheirEndsAsTheirCentersSay) {
  const std::string ends = "axis mins: 10 20 30\naxis maxs: 14 25 36\n";
  expect_places(ends + "centers: cell cell cell\n", {10.5, 20.5, 30.5}, {13.5, 24.5, 35.5});
  expect_places("axis mins: 10 20 30\naxismaxs: 16 28 40\ncenterings: node node node\n",
                {10, 20, 30}, {16, 28, 40});
  expect_places("axis mins: 4 0 0\naxis maxs: 0 10 5\ncenters: cell cell node\n", {3.5, 1, 0},
                {0.5, 9, 5});
  expect_places("spacings: 2 2 2\naxis mins: 0 0 0\ncenters: cell node ???\n", {1, 0, 0},
                {7, 8, 10});
}

TEST(NrrdAxes, AreAsEverWhereNothingIsSaidOfTheirCenters) {
  expect_places("spacings: 2 2 2\naxis mins: 1 2 3\n", {1, 2, 3}, {7, 10, 13});
  expect_places("axis mins: 1 2 3\naxis maxs: nan nan nan\n", {1, 2, 3}, {4, 6, 8});
  // Both are as long as voxels of 1: as cells, or as nodes.
  expect_places("axis mins: 0 0 0\naxis maxs: 4 5 6\n", {0, 0, 0}, {3, 4, 5});
  expect_places("axis mins: 0 0 0\naxis maxs: 3 4 5\n", {0, 0, 0}, {3, 4, 5});
}

TEST(NrrdAxes, AgreeWithEndsFromWhichTheirSpacingsAreRounded) {
  // By 512 voxels of 0.4883 the axis ends at 250.0096.
  const auto volume = long_nrrd_with("0.4883", "250", "cell");
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_DOUBLE_EQ(volume->transform.to_world({511, 0, 0}).x, 511.5 * 0.4883);
  EXPECT_TRUE(long_nrrd_with("0.489", "250", "node").ok());
  // Cells that are taken for nodes are a whole voxel off.
  EXPECT_FALSE(long_nrrd_with("0.4883", "250", "node").ok());
  EXPECT_FALSE(long_nrrd_with("0.489", "250", "cell").ok());
}

TEST(NrrdAxes, AreRefusedWhereTheirEndsAreInfinite) {
  for (const char* max : {"inf", "-inf"}) {
    EXPECT_THAT(std::string(long_nrrd_with("2", max, "cell").status().message()),
                HasSubstr("no finite number"));
  }
}

TEST(NrrdAxes, AreRefusedWhereTheirEndsContradictTheirSpacings) {
  for (const char* fields :
       {"spacings: 2 2 2\naxis mins: 0 0 0\naxis maxs: 8 10 13\n",
        "spacings: 2 2 2\naxis mins: 0 0 0\naxis maxs: 8 10 10\ncenters: cell cell cell\n",
        "axis mins: 0 0 0\naxis maxs: 4 5 60\n"}) {
    const auto volume = nrrd_with(fields);
    EXPECT_THAT(std::string(volume.status().message()), HasSubstr("its axis 2 goes from 0 to"))
        << fields;
  }
}

}  // namespace
}  // namespace tet
