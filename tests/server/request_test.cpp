#include "server/request.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/wire/sha256.h"

namespace tet {
namespace {

using testing::HasSubstr;

v1::MeshRequest valid_request() {
  v1::MeshRequest request;
  request.set_name(name_of_grid(std::string(64, 'a')));
  return request;
}

std::string refusal(const v1::MeshRequest& request) {
  const auto order = parse_mesh_request(request);
  EXPECT_EQ(order.status().code(), absl::StatusCode::kInvalidArgument);
  return std::string(order.status().message());
}

TEST(Request, TakesTheMeshersDefaults) {
  const auto order = parse_mesh_request(valid_request());
  ASSERT_TRUE(order.ok());
  EXPECT_FALSE(order->request.spacing);
  EXPECT_FALSE(order->request.iso);
  EXPECT_EQ(order->request.levels, kMaxLevels);
}

TEST(Request, TellsZeroFromUnset) {
  v1::MeshRequest request = valid_request();
  request.set_iso(0);
  request.set_levels(0);
  const auto order = parse_mesh_request(request);
  ASSERT_TRUE(order.ok());
  EXPECT_EQ(order->request.iso, 0.0);
  EXPECT_EQ(order->request.levels, 0);
}

TEST(Request, NamesTheFieldAndItsValue) {
  v1::MeshRequest request = valid_request();
  request.set_spacing(0);
  EXPECT_THAT(refusal(request), HasSubstr("spacing 0 is not positive"));
  request = valid_request();
  request.set_spacing(std::numeric_limits<double>::infinity());
  EXPECT_THAT(refusal(request), HasSubstr("spacing inf"));
  request = valid_request();
  request.set_iso(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(refusal(request), HasSubstr("iso nan is not finite"));
  request = valid_request();
  request.set_levels(25);
  EXPECT_THAT(refusal(request), HasSubstr("levels 25 is not from 0 to 24"));
  request = valid_request();
  request.set_preset(static_cast<v1::Preset>(9));
  EXPECT_THAT(refusal(request), HasSubstr("preset 9"));
  request = valid_request();
  request.set_name("grids/ABC");
  EXPECT_THAT(refusal(request), HasSubstr("\"grids/ABC\""));
}

TEST(Request, RefusesARangeThatRunsBackwards) {
  v1::StreamMeshRequest request;
  *request.mutable_mesh() = valid_request();
  request.set_start_chunk(3);
  request.set_end_chunk(2);
  EXPECT_FALSE(parse_stream_request(request).ok());
  request.set_start_chunk(-1);
  request.set_end_chunk(0);
  EXPECT_FALSE(parse_stream_request(request).ok());
}

TEST(MeshId, IsTheSameForDefaultsSpelledOut) {
  Volume fog;
  fog.name = "density";
  fog.kind = VolumeKind::kFogVolume;
  fog.transform.voxel_size = 0.25;
  v1::MeshRequest spelled = valid_request();
  spelled.set_spacing(0.25);
  spelled.set_iso(0.5);
  spelled.set_levels(kMaxLevels);
  spelled.set_preset(v1::PRESET_DEFAULT);
  const auto id = [&](const v1::MeshRequest& request) {
    return mesh_id_of(canonical_request(*parse_mesh_request(request), fog, nullptr));
  };
  EXPECT_EQ(id(valid_request()), id(spelled));
  spelled.set_iso(0.25);
  EXPECT_NE(id(valid_request()), id(spelled));
  v1::MeshRequest improved = valid_request();
  improved.set_improve(true);
  EXPECT_NE(id(valid_request()), id(improved));
}

}  // namespace
}  // namespace tet
