// Regions of the surface that cannot be.
#include "core/plan/check_face_regions.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/plan/some_face_regions.h"

namespace tet::check_face_regions_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string refusal_of(const FaceRegion& region) {
  return std::string(check_face_regions(std::vector{region}).message());
}

TEST(CheckFaceRegions, RefusesWithTheFieldThatIsWrong) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal_of(FaceRegion{"bore"}), StartsWith("face_regions[0] has no condition"));
  for (const std::string name : {"", "a/b", "a\nb", "\xff", "\"", ".", "surface", "cut_x_min",
                                 "interface", "box_z_max"}) {
    EXPECT_THAT(refusal_of(of_node(name, "1")), StartsWith("face_regions[0].name \"")) << name;
  }
  EXPECT_THAT(refusal_of(of_node(std::string(101, 'a'), "1")), HasSubstr("1 to 100 bytes"));
  EXPECT_THAT(refusal_of(in_box("b", {0, 0, 0}, {1, 0, 1})), HasSubstr("box from min"));
  EXPECT_THAT(refusal_of(in_box("b", {0, 0, 0}, {1, inf, 1})), HasSubstr("box.max"));
  FaceRegion region{"b"};
  region.ball = {{0, 0, 0}, std::nan("")};
  EXPECT_THAT(refusal_of(region), StartsWith("face_regions[0].ball.radius nan is not from"));
  region = {"b"};
  region.cylinder = {{1, 1, 1}, {1, 1, 1}, 1};
  EXPECT_THAT(refusal_of(region), HasSubstr("cylinder from start (1, 1, 1)"));
  region = {"b"};
  region.half_space = {{0, 0, 0}, 1};
  EXPECT_THAT(refusal_of(region), HasSubstr("half_space.normal (0, 0, 0) is no direction"));
  region.half_space = {{0, 0, 1}, inf};
  EXPECT_THAT(refusal_of(region), HasSubstr("half_space.offset inf"));
  region = {"b"};
  region.facing = {{0, 0, 1}, 181};
  EXPECT_THAT(refusal_of(region), HasSubstr("facing.angle_deg 181 is not from 0 to 180"));
  for (const double angle : {0.5, 181.0, std::nan("")}) {
    EXPECT_THAT(refusal_of(divided("b", angle)), HasSubstr("is not from 1 to 180"));
  }
  region = {"b"};
  region.nearest = {{0, 0, 0}, {0, -inf, 0}};
  EXPECT_THAT(refusal_of(region), HasSubstr("nearest.points[3]"));
  region.nearest.assign(1025, {});
  EXPECT_THAT(refusal_of(region), HasSubstr("1025 points of all regions; the limit is 1024"));
  const std::vector<FaceRegion> many(257, of_node("b", "1"));
  EXPECT_THAT(std::string(check_face_regions(many).message()),
              HasSubstr("257 entries; the limit is 256"));
}

TEST(CheckFaceRegions, RefusesNamesThatPatchesMayHaveAndCreasesThatAreNotAlike) {
  const auto refusal = [](const std::vector<FaceRegion>& regions) {
    return std::string(check_face_regions(regions).message());
  };
  EXPECT_THAT(refusal({divided("rim", 30), of_node("rim.7", "1")}),
              StartsWith("face_regions[1].name \"rim.7\" may be that of a patch of "
                         "face_regions[0]"));
  EXPECT_THAT(refusal({of_node("rim.7", "1"), divided("rim", 30)}),
              StartsWith("face_regions[0].name \"rim.7\" may be"));
  EXPECT_EQ(refusal({divided("rim", 30), of_node("rim.x", "1"), of_node("rim.", "1")}), "");
  EXPECT_THAT(refusal({divided("rim", 30), divided("rim", 31)}),
              StartsWith("face_regions[0].creases are not those of face_regions[1]"));
  EXPECT_THAT(refusal({of_node("rim", "1"), divided("rim", 31)}), HasSubstr("same name"));
  EXPECT_EQ(refusal({divided("rim", 30), divided("rim", 30)}), "");
}

}  // namespace
}  // namespace tet::check_face_regions_test
