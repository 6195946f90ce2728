#include "core/volume/inside.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume/volume_builder.h"

namespace tet {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// One brick of a value, as a file's grid would have it.
Volume grid(float background, float value, VolumeKind kind, KindSource source) {
  VolumeBuilder builder(kind, background);
  builder.add_constant_brick({0, 0, 0}, value);
  Volume volume = *std::move(builder).build();
  volume.kind_source = source;
  return volume;
}

TEST(Inside, HasTheRangeOfEveryValueAndOfTheBackground) {
  const Volume volume = grid(0.25F, 2, VolumeKind::kFogVolume, KindSource::kClass);
  EXPECT_EQ(value_range(volume).min, 0.25F);
  EXPECT_EQ(value_range(volume).max, 2);
}

TEST(Inside, IsWhatTheRequestSaysBeforeTheClass) {
  const Volume level_set = grid(3, -3, VolumeKind::kLevelSet, KindSource::kClass);
  const Volume fog = grid(0, 1, VolumeKind::kFogVolume, KindSource::kClass);
  EXPECT_EQ(inside_side(level_set, {}), InsideSide::kBelow);
  EXPECT_EQ(inside_side(fog, {}), InsideSide::kAbove);
  EXPECT_EQ(inside_side(level_set, InsideSide::kAbove), InsideSide::kAbove);
  EXPECT_EQ(inside_side(fog, InsideSide::kBelow), InsideSide::kBelow);
}

TEST(Inside, HasADefaultIsoValueThatSeparatesItFromTheBackground) {
  const Volume fog = grid(0, 1, VolumeKind::kFogVolume, KindSource::kClass);
  EXPECT_EQ(default_iso(fog, {}), 0.5);
  EXPECT_EQ(default_iso(fog, InsideSide::kAbove), 0.5);
  EXPECT_EQ(default_iso(fog, InsideSide::kBelow), 0);
  const Volume inverted = grid(-3, 3, VolumeKind::kLevelSet, KindSource::kClass);
  EXPECT_EQ(default_iso(inverted, {}), 0);
  EXPECT_EQ(default_iso(inverted, InsideSide::kAbove), 0);
  const Volume wrong_class = grid(0, 1, VolumeKind::kLevelSet, KindSource::kClass);
  EXPECT_EQ(default_iso(wrong_class, InsideSide::kAbove), 0.5);
}

TEST(Inside, MustBeSaidWhereNobodyTells) {
  const Volume scan = grid(-1024, 900, VolumeKind::kLevelSet, KindSource::kNobody);
  const absl::Status status = check_side(scan, {});
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()),
              AllOf(StartsWith("inside must be set"), HasSubstr("-1024 to 900"),
                    HasSubstr("--inside")));
  EXPECT_TRUE(check_side(scan, InsideSide::kAbove).ok());
  EXPECT_TRUE(check_side(grid(3, -3, VolumeKind::kLevelSet, KindSource::kValues), {}).ok());
}

TEST(Inside, MustBeSaidWhereTheBackgroundWouldBeInside) {
  const Volume inverted = grid(-3, 3, VolumeKind::kLevelSet, KindSource::kClass);
  const absl::Status status = check_background(inverted, {}, 0);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()),
              AllOf(StartsWith("inside must be set"), HasSubstr("the level set is inverted")));
  EXPECT_TRUE(check_background(inverted, InsideSide::kBelow, 0).ok());
  const Volume wrong_class = grid(3, -3, VolumeKind::kFogVolume, KindSource::kClass);
  EXPECT_THAT(std::string(check_background(wrong_class, {}, 0.5).message()),
              HasSubstr("looks like the other"));
  // Who makes a volume in memory says what it is.
  EXPECT_TRUE(
      check_background(grid(-3, 3, VolumeKind::kLevelSet, KindSource::kMaker), {}, 0).ok());
}

TEST(Inside, IsDescribedWhereItIsGuessed) {
  const Volume density = grid(0, 1, VolumeKind::kFogVolume, KindSource::kValues);
  EXPECT_THAT(describe_guess(density, {}, 0.5),
              AllOf(HasSubstr("no class"), HasSubstr("from 0 to 1"), HasSubstr("density"),
                    HasSubstr("above 0.5")));
  EXPECT_EQ(describe_guess(density, InsideSide::kAbove, 0.5), "");
  EXPECT_EQ(describe_guess(grid(0, 1, VolumeKind::kFogVolume, KindSource::kClass), {}, 0.5),
            "");
}

}  // namespace
}  // namespace tet
