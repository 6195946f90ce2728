#include "proto/convert/request.h"

#include <limits>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/scene.h"
#include "proto/wire/sha256.h"
#include "tests/proto/convert/requests.h"

namespace tet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

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
  EXPECT_EQ(order->request.levels, 1);
}

TEST(Request, TakesLabelsAndGivesThemBackAlike) {
  v1::MeshRequest request = valid_request();
  v1::Labels& labels = *request.mutable_labels();
  labels.add_only()->set_first(4);
  labels.mutable_only(0)->set_last(9);
  labels.add_merges()->add_ranges()->set_last(3);
  labels.set_background(-2);
  labels.set_mesh_background(true);
  labels.add_names()->set_value(5);
  labels.mutable_names(0)->set_name("bone");
  labels.set_kernel(v1::LABEL_KERNEL_GAUSS);
  labels.set_smooth(1.5);
  const auto order = parse_mesh_request(request);
  ASSERT_TRUE(order.ok()) << order.status();
  ASSERT_TRUE(order->request.labels);
  EXPECT_EQ(order->request.labels->smooth, 1.5);
  v1::MeshRequest again;
  to_proto(order->request, again);
  EXPECT_EQ(again.labels().SerializeAsString(), labels.SerializeAsString());
}

TEST(Request, RefusesImpossibleLabels) {
  const auto refused = [](const auto& change) {
    v1::MeshRequest request = valid_request();
    change(*request.mutable_labels());
    return refusal(request);
  };
  EXPECT_THAT(refused([](v1::Labels& l) { l.add_only()->set_first(1); }),
              HasSubstr("labels.only[0] is from 1 to 0"));
  EXPECT_THAT(refused([](v1::Labels& l) { l.add_merges(); }), HasSubstr("is empty"));
  EXPECT_THAT(refused([](v1::Labels& l) {
                for (int i = 0; i < 2; ++i) l.add_merges()->add_ranges()->set_last(3);
              }),
              HasSubstr("label 0 twice"));
  EXPECT_THAT(refused([](v1::Labels& l) { l.add_names()->set_name(std::string(129, 'a')); }),
              HasSubstr("128 bytes"));
  EXPECT_THAT(refused([](v1::Labels& l) { l.add_names()->set_name("a\nb"); }),
              HasSubstr("control"));
  EXPECT_THAT(refused([](v1::Labels& l) {
                for (int i = 0; i < 2; ++i) l.add_names()->set_name("a");
              }),
              HasSubstr("label 0 twice"));
  for (const double smooth : {0.0, -1.0, 4.5, std::nan("")}) {
    EXPECT_THAT(refused([&](v1::Labels& l) { l.set_smooth(smooth); }), HasSubstr("smooth"));
  }
  EXPECT_THAT(refused([](v1::Labels& l) { l.set_kernel(static_cast<v1::LabelKernel>(9)); }),
              HasSubstr("kernel 9"));
  EXPECT_THAT(refused([](v1::Labels& l) {
                l.set_kernel(v1::LABEL_KERNEL_TRILINEAR);
                l.set_smooth(1);
              }),
              HasSubstr("leave it unset"));
  EXPECT_THAT(refused([](v1::Labels& l) {
                for (int i = 0; i < 65536; ++i) l.add_only();
              }),
              HasSubstr("65536 ranges"));
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
  request.set_inside(static_cast<v1::Inside>(9));
  EXPECT_THAT(refusal(request), HasSubstr("inside 9"));
  request = valid_request();
  request.set_name("grids/ABC");
  EXPECT_THAT(refusal(request), HasSubstr("\"grids/ABC\""));
}

TEST(Request, TakesABoxAndAManifold) {
  v1::MeshRequest request = boxed_request();
  request.mutable_box()->mutable_min()->set_z(-2.5);
  request.set_manifold(true);
  const auto order = parse_mesh_request(request);
  ASSERT_TRUE(order.ok()) << order.status();
  EXPECT_TRUE(order->request.manifold);
  ASSERT_TRUE(order->request.box);
  EXPECT_EQ(order->request.box->min.z, -2.5);
  EXPECT_EQ(order->request.box->max.x, 1);
  const auto plain = parse_mesh_request(valid_request());
  EXPECT_FALSE(plain->request.manifold);
  EXPECT_FALSE(plain->request.box);
}

TEST(Request, RefusesABoxThatIsNone) {
  v1::MeshRequest request = boxed_request();
  request.mutable_box()->clear_max();
  EXPECT_THAT(refusal(request), HasSubstr("box must have both min and max"));
  request = boxed_request();
  request.mutable_box()->mutable_max()->set_y(0);
  EXPECT_THAT(refusal(request), HasSubstr("max (1, 0, 1) is empty"));
  for (const double wrong :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    request = boxed_request();
    request.mutable_box()->mutable_max()->set_y(wrong);
    EXPECT_THAT(refusal(request), HasSubstr("is not finite"));
  }
}

TEST(Request, TakesABoxThatCutsTheInside) {
  v1::MeshRequest request = boxed_request();
  request.set_preset(v1::PRESET_MIN_ANGLE);
  const auto order = parse_mesh_request(request);
  ASSERT_TRUE(order.ok()) << order.status();
  EXPECT_TRUE(has_cut(order->request));
  request.set_manifold(true);
  EXPECT_THAT(refusal(request), HasSubstr("manifold does not go with a box"));
  request.clear_manifold();
  v1::StreamMeshRequest compact;
  *compact.mutable_mesh() = request;
  compact.set_encoding(v1::ENCODING_COMPACT);
  EXPECT_THAT(parse_stream_request(compact).status().message(),
              HasSubstr("ENCODING_COMPACT cannot carry a mesh that a box cuts"));
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

TEST(Request, HasAsManyLevelsAsASizingLeavesThatBoundsEveryLeaf) {
  const auto levels_with = [](const auto& set) {
    v1::MeshRequest request = valid_request();
    set(*request.mutable_sizing());
    const auto order = parse_mesh_request(request);
    return order.ok() ? order->request.levels : -1;
  };
  EXPECT_EQ(levels_with([](v1::Sizing& sizing) { sizing.set_coarsest(1); }), kMaxLevels);
  EXPECT_EQ(levels_with([](v1::Sizing& sizing) { sizing.set_growth(0.5); }), kMaxLevels);
  EXPECT_EQ(levels_with([](v1::Sizing& sizing) {
              auto& region = *sizing.add_regions();
              region.set_size(0.5);
              region.mutable_shell()->set_depth(1);
            }),
            1);
}

TEST(Request, BringsFaceRegionsBackAndAsksForFaces) {
  const v1::MeshRequest request = request_with_regions();
  const auto order = parse_mesh_request(request);
  ASSERT_TRUE(order.ok()) << order.status();
  EXPECT_TRUE(order->request.faces);
  const auto canonical = canonical_request(*order, std::make_shared<Volume>(), nullptr);
  EXPECT_TRUE(canonical.faces());
  v1::MeshRequest expected = request;
  for (int i = 0; i < 3; ++i) {  // its defaults
    expected.mutable_face_regions(0)->mutable_cylinder()->add_start(0);
  }
  EXPECT_EQ(canonical.face_regions(0).SerializeAsString(),
            expected.face_regions(0).SerializeAsString());
  EXPECT_EQ(order->request.face_regions.front().nearest.back().z, 6);
}

TEST(Request, RefusesFaceRegionsByTheirField) {
  const auto refused = [](auto&& spoil) {
    v1::MeshRequest request = request_with_regions();
    spoil(*request.mutable_face_regions(0));
    return refusal(request);
  };
  EXPECT_THAT(refused([](v1::FaceRegion& r) { r.mutable_nearest()->add_points(1); }),
              StartsWith("face_regions[0].nearest.points has 7 numbers"));
  EXPECT_THAT(refused([](v1::FaceRegion& r) { r.mutable_nearest()->clear_points(); }),
              StartsWith("face_regions[0].nearest.points has 0 numbers"));
  EXPECT_THAT(refused([](v1::FaceRegion& r) { r.mutable_box()->add_min(1); }),
              StartsWith("face_regions[0].box.min has 4 numbers"));
  EXPECT_THAT(refused([](v1::FaceRegion& r) { r.set_name("surface"); }),
              StartsWith("face_regions[0].name"));
  EXPECT_THAT(refused([](v1::FaceRegion& r) { r.mutable_creases()->set_angle_deg(0); }),
              StartsWith("face_regions[0].creases.angle_deg 0 is not from 1 to 180"));
  EXPECT_THAT(refused([](v1::FaceRegion& r) { r.mutable_ball()->set_radius(-1); }),
              StartsWith("face_regions[0].ball.radius"));
  v1::MeshRequest many = request_with_regions();
  for (int i = 0; i < 256; ++i) *many.add_face_regions() = many.face_regions(0);
  EXPECT_THAT(refusal(many), StartsWith("face_regions has 257 entries"));
}

TEST(Request, RefusesFacesOfNodesAndPatchesInCompactChunks) {
  v1::StreamMeshRequest stream;
  *stream.mutable_mesh() = request_with_regions();
  stream.set_encoding(v1::ENCODING_PACKED);
  EXPECT_TRUE(parse_stream_request(stream).ok());
  stream.set_encoding(v1::ENCODING_COMPACT);
  const auto refusal_of_stream = [&] {
    return std::string(parse_stream_request(stream).status().message());
  };
  EXPECT_THAT(refusal_of_stream(), HasSubstr("cannot carry face_regions[0].creases"));
  stream.mutable_mesh()->mutable_face_regions(0)->clear_creases();
  EXPECT_THAT(refusal_of_stream(), HasSubstr("cannot carry face_regions[0].node"));
  stream.mutable_mesh()->mutable_face_regions(0)->clear_node();
  EXPECT_EQ(refusal_of_stream(), "");
}

TEST(Request, TakesASceneInPlaceOfAGrid) {
  const auto order = parse_mesh_request(scene_request());
  ASSERT_TRUE(order.ok()) << order.status();
  ASSERT_NE(order->made_scene, nullptr);
  EXPECT_EQ(order->made_scene->extent.max.x, 2);
  EXPECT_EQ(order->digest, "");
}

TEST(Request, RefusesWhatScenesHaveNot) {
  v1::MeshRequest request = scene_request();
  request.set_name(valid_request().name());
  EXPECT_EQ(refusal(request), "name is set beside scene: mesh one or the other");
  request = scene_request();
  request.set_grid_name("density");
  EXPECT_EQ(refusal(request),
            "grid_name is set, but a scene has no grids: a scene names its grids itself, in "
            "its nodes");
  request = scene_request();
  request.set_iso(0);
  EXPECT_THAT(refusal(request), HasSubstr("iso 0 is for grids"));
  request = boxed_request();
  request.clear_name();
  request.mutable_scene()->add_nodes()->mutable_gyroid()->set_period(1);
  EXPECT_EQ(refusal(request), "spacing must be set where the scene has no end");
  request.set_spacing(0.1);
  EXPECT_TRUE(parse_mesh_request(request).ok());
  v1::StreamMeshRequest stream;
  *stream.mutable_mesh() = scene_request();
  stream.set_base_mesh_id("a");
  stream.set_base_name(valid_request().name());
  EXPECT_EQ(
      parse_stream_request(stream).status().message(),
      "base_name is for grids: a scene's mesh is sent whole; a session keeps parts of it");
}

TEST(Request, NamesTheFilesThatAMeshIsMadeOf) {
  const auto file = [](char digit) { return std::string(64, digit); };
  v1::MeshRequest request;
  for (const char digit : {'b', 'a', 'b'}) {
    v1::SceneNode& node = *request.mutable_scene()->add_nodes();
    node.set_name(std::to_string(request.scene().nodes_size()));
    node.mutable_grid()->set_name("grids/" + file(digit));
  }
  auto& all = *request.mutable_scene()->add_nodes()->mutable_union_();
  for (const char* name : {"1", "2", "3"}) all.add_of(name);
  request.mutable_sizing()->mutable_grid()->set_name("grids/" + file('c'));
  const auto order = parse_mesh_request(request);
  ASSERT_TRUE(order.ok()) << order.status();
  EXPECT_EQ(order->made_scene, nullptr) << "its grids are not loaded";
  EXPECT_THAT(files_of(*order), ElementsAre(file('a'), file('b'), file('c')));
  request.mutable_scene()->mutable_nodes(1)->mutable_grid()->set_name("b.vdb");
  EXPECT_THAT(refusal(request), StartsWith("nodes[1].grid.name \"b.vdb\" is not grids/"));
}

TEST(Request, TakesASizing) {
  v1::MeshRequest request = sized_request();
  request.mutable_sizing()->set_coarsest(2);
  const auto order = parse_mesh_request(request);
  ASSERT_TRUE(order.ok()) << order.status();
  EXPECT_EQ(order->request.sizing.coarsest, 2);
  EXPECT_EQ(order->request.sizing.growth, 1);
  ASSERT_EQ(order->request.sizing.regions.size(), 1U);
  EXPECT_EQ(order->request.sizing.regions[0].size, 0.5);
}

TEST(Request, NamesTheFieldOfASizing) {
  v1::MeshRequest request = sized_request();
  request.mutable_sizing()->mutable_regions(0)->mutable_ball()->add_centre(1);
  EXPECT_EQ(refusal(request), "regions[0].ball.centre has 1 numbers, not 3");
  request = sized_request();
  request.set_spacing(0.6);
  EXPECT_EQ(refusal(request),
            "regions[0].size 0.5 is below the spacing 0.6, the size of the smallest leaves: "
            "use a larger one");
  request = sized_request();
  request.mutable_sizing()->set_grade_surface(true);
  EXPECT_EQ(refusal(request),
            "coarsest must be set where grade_surface is: leaves at the surface are as long");
  request.mutable_sizing()->set_coarsest(2);
  request.set_manifold(true);
  EXPECT_EQ(refusal(request),
            "sizing.grade_surface does not go with manifold: set one of them");
}

TEST(Request, TakesFieldsAndTheFilesThatTheyAreIn) {
  v1::MeshRequest request = valid_request();
  request.mutable_sizing()->mutable_grid()->set_name(name_of_grid(std::string(64, 'b')));
  for (const char digit : {'c', 'b', 'c'}) {
    v1::Field& field = *request.add_fields();
    field.set_name(std::string(1, static_cast<char>('w' + request.fields_size())));
    field.set_grid(name_of_grid(std::string(64, digit)));
  }
  request.add_fields()->set_grid_name("heat");
  const auto order = parse_mesh_request(request);
  ASSERT_TRUE(order.ok()) << order.status();
  EXPECT_EQ(order->request.fields[3].grid, "heat");
  const std::vector<std::string> files{std::string(digest_of_name(request.name())),
                                       std::string(64, 'b'), std::string(64, 'c')};
  EXPECT_EQ(files_of(*order), files);
}

}  // namespace
}  // namespace tet
