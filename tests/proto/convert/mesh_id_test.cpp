// Requests that make the same bytes have the same name, and no others.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "proto/convert/request.h"
#include "tests/proto/convert/requests.h"

namespace tet {
namespace {

TEST(MeshId, IsTheSameForDefaultsSpelledOut) {
  const auto fog = std::make_shared<Volume>();
  fog->name = "density";
  fog->kind = VolumeKind::kFogVolume;
  fog->transform.voxel_size = 0.25;
  v1::MeshRequest spelled = valid_request();
  spelled.set_spacing(0.25);
  spelled.set_iso(0.5);
  spelled.set_levels(1);
  spelled.set_preset(v1::PRESET_DEFAULT);
  spelled.set_inside(v1::INSIDE_ABOVE);
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

TEST(MeshId, IsAnotherWithFaces) {
  const auto volume = std::make_shared<Volume>();
  v1::MeshRequest faces = valid_request();
  faces.set_faces(true);
  const auto canonical = [&](const v1::MeshRequest& request) {
    return canonical_request(*parse_mesh_request(request), volume, nullptr);
  };
  EXPECT_TRUE(canonical(faces).faces());
  EXPECT_NE(mesh_id_of(canonical(faces)), mesh_id_of(canonical(valid_request())));
  EXPECT_NE(name_of_request(faces), name_of_request(valid_request()));
}

TEST(MeshId, TellsEveryFaceRegionApart) {
  const auto volume = std::make_shared<Volume>();
  const auto id = [&](const v1::MeshRequest& request) {
    return mesh_id_of(canonical_request(*parse_mesh_request(request), volume, nullptr));
  };
  v1::MeshRequest request = request_with_regions();
  const std::string first = id(request);
  EXPECT_EQ(first, id(request_with_regions()));
  request.mutable_face_regions(0)->mutable_ball()->set_radius(std::nextafter(2, 3));
  EXPECT_NE(first, id(request));
  request = request_with_regions();
  request.mutable_face_regions(0)->mutable_creases()->set_angle_deg(36);
  EXPECT_NE(first, id(request));
  request.clear_face_regions();
  request.set_faces(true);
  EXPECT_NE(first, id(request));
}

TEST(MeshId, IsTheSameWithoutStatistics) {
  const auto volume = std::make_shared<Volume>();
  v1::MeshRequest only = valid_request();
  only.set_skip_statistics(true);
  const auto canonical = [&](const v1::MeshRequest& request) {
    return canonical_request(*parse_mesh_request(request), volume, nullptr);
  };
  EXPECT_EQ(mesh_id_of(canonical(only)), mesh_id_of(canonical(valid_request())));
  EXPECT_EQ(name_of_request(only), name_of_request(valid_request()));
  EXPECT_TRUE(canonical(only).skip_statistics());
  EXPECT_FALSE(canonical(valid_request()).skip_statistics());
}

TEST(MeshId, TellsTheSidesApart) {
  const auto volume = std::make_shared<Volume>();
  volume->background = 1;
  const auto canonical = [&](v1::Inside inside, const Shape& shape) {
    v1::MeshRequest request = valid_request();
    request.set_inside(inside);
    request.set_iso(0.25);
    return canonical_request(*parse_mesh_request(request), shape, nullptr);
  };
  for (const Shape& shape : {Shape(volume), Shape(GridList{volume})}) {
    EXPECT_NE(mesh_id_of(canonical(v1::INSIDE_ABOVE, shape)),
              mesh_id_of(canonical(v1::INSIDE_BELOW, shape)));
  }
  EXPECT_EQ(canonical(v1::INSIDE_UNSPECIFIED, volume).inside(), v1::INSIDE_BELOW);
  volume->kind = VolumeKind::kFogVolume;
  EXPECT_EQ(canonical(v1::INSIDE_UNSPECIFIED, volume).inside(), v1::INSIDE_ABOVE);
}

TEST(MeshId, TellsEveryBoxAndManifoldsApart) {
  const auto volume = std::make_shared<Volume>();
  volume->name = "sphere";
  const auto id = [&](const v1::MeshRequest& request) {
    return mesh_id_of(canonical_request(*parse_mesh_request(request), volume, nullptr));
  };
  const v1::MeshRequest boxed = boxed_request();
  EXPECT_EQ(id(boxed), id(boxed_request()));
  v1::MeshRequest other = boxed;
  other.clear_box();
  EXPECT_NE(id(other), id(boxed));
  other = boxed;
  other.mutable_box()->mutable_max()->set_z(std::nextafter(1.0, 2.0));
  EXPECT_NE(id(other), id(boxed));
  other = boxed;
  other.set_manifold(true);
  EXPECT_NE(id(other), id(boxed));
}

TEST(MeshId, TellsEverySizingApart) {
  const auto id = [](const v1::MeshRequest& request) {
    const auto order = parse_mesh_request(request);
    return mesh_id_of(canonical_request(*order, order->made_scene, nullptr));
  };
  const v1::MeshRequest sized = sized_request();
  EXPECT_NE(id(sized), id(scene_request()));
  v1::MeshRequest other = sized;
  other.mutable_sizing()->mutable_regions(0)->set_size(std::nextafter(0.5, 1.0));
  EXPECT_NE(id(other), id(sized));
  other = sized;
  other.mutable_sizing()->set_growth(1);
  EXPECT_EQ(id(other), id(sized)) << "its default";
  other.mutable_sizing()->set_coarsest(2);
  const std::string coarse = id(other);
  other.mutable_sizing()->set_grade_surface(true);
  EXPECT_NE(id(other), coarse);
  other = scene_request();
  other.mutable_sizing();
  EXPECT_EQ(id(other), id(scene_request())) << "one that asks for nothing";
}

TEST(MeshId, IsThatOfAScene) {
  const auto id_of = [](const v1::MeshRequest& request) {
    const auto order = parse_mesh_request(request);
    return mesh_id_of(canonical_request(*order, order->made_scene, nullptr));
  };
  v1::MeshRequest request = scene_request();
  const std::string id = id_of(request);
  request.set_spacing(4.0 / 128);
  EXPECT_EQ(id_of(request), id) << "its default";
  request.mutable_scene()->mutable_nodes(0)->mutable_sphere()->set_radius(2.5);
  EXPECT_NE(id_of(request), id);
}

}  // namespace
}  // namespace tet
