// Scenes of the public library, here and on a server.
#include <string>

#include <gtest/gtest.h>

#include "tests/client/library_fixture.h"

namespace tetstream {
namespace {

using test::BallSamples;
using test::collected;
using test::expect_same;
using SceneOnAServer = test::LibraryOnAServer;

constexpr char kLens[] = R"({"nodes": [
  {"name": "ball", "sphere": {"radius": 1}},
  {"name": "other", "transform": {"of": "ball", "translation": [0.5, 0, 0]}},
  {"intersection": {"of": ["ball", "other"], "smoothing": 0.1}}]})";
constexpr char kBored[] = R"({"nodes": [
  {"name": "scan", "grid": {"name": "ball"}},
  {"name": "bore", "cylinder": {"radius": 0.3, "height": 3}},
  {"difference": {"of": ["scan", "bore"]}}]})";

TEST(LibraryScene, IsMeshedHere) {
  const Scene lens = Scene::from_json(kLens).value();
  const Request request{.spacing = 0.1, .faces = true};
  const Mesh made = mesh(lens, request).value();
  EXPECT_NEAR(made.statistics().quality->volume, 2.6, 0.1);
  EXPECT_EQ(made.face_count(), made.statistics().boundary->triangles);
  EXPECT_EQ(estimate(lens, request)->tet_count, made.tet_count());
  expect_same(collected(stream(lens, request)), made);
}

TEST(LibraryScene, HoldsVolumes) {
  const Volume ball = BallSamples(16).volume();
  const Mesh bored = mesh(Scene::from_json(kBored, {{"ball", ball}}).value()).value();
  EXPECT_EQ(bored.statistics().boundary->euler_characteristic, 0);
}

TEST(LibraryScene, SaysWhatIsWrongWithIt) {
  const auto message = [](const std::string& json, const std::vector<SceneGrid>& grids = {}) {
    const Status status = Scene::from_json(json, grids).status();
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    return status.message();
  };
  EXPECT_NE(message("{}").find("nodes"), std::string::npos);
  EXPECT_EQ(message("7").substr(0, 8), "the text");
  EXPECT_EQ(message(R"({"nodes": [{"sphere": {"radius": -1}}]})").substr(0, 28),
            "scene.nodes[0].sphere.radius");
  EXPECT_EQ(message(kBored).substr(0, 40), "scene.nodes[0].grid.name \"ball\" is none ");
  const std::vector<float> values(8, 1);
  const Volume no_inside =
      Volume::from_samples({.values = values, .size = {2, 2, 2}, .kind = VolumeKind::kValues})
          .value();
  EXPECT_NE(message(kBored, {{"ball", no_inside}}).find("has no inside"), std::string::npos);
}

TEST(LibraryScene, OfStoredGridsIsForServers) {
  const std::string stored =
      R"({"nodes": [{"grid": {"name": "grids/)" + std::string(64, '0') + R"("}}]})";
  const Scene scene = Scene::from_json(stored).value();
  EXPECT_EQ(mesh(scene).status().code(), StatusCode::kFailedPrecondition);
}

TEST_F(SceneOnAServer, MakesTheMeshThatIsMadeHere) {
  const Scene bored = Scene::from_json(kBored, {{"ball", BallSamples(16).volume()}}).value();
  for (const Scene& scene : {Scene::from_json(kLens).value(), bored}) {
    const Request request{.spacing = 0.1};
    const Mesh here = mesh(scene, request).value();
    expect_same(client().mesh(scene, request).value(), here);
    expect_same(collected(client().stream(scene, request)), here);
    EXPECT_EQ(client().estimate(scene, request)->tet_count, here.tet_count());
  }
}

TEST_F(SceneOnAServer, TellsTheFieldAndTheLimitThatAreWrong) {
  const Scene lens = Scene::from_json(kLens).value();
  const Status spacing = client().mesh(lens, {.spacing = -1}).status();
  EXPECT_EQ(spacing.details().field, "mesh.spacing");
  EXPECT_FALSE(spacing.details().request_id.empty());
  config_.store_bytes = 1000;
  restart();
  const Client anew = Client::connect(server_->address()).value();
  const Status large = anew.upload(BallSamples(16).volume()).status();
  EXPECT_EQ(large.code(), StatusCode::kResourceExhausted);
  EXPECT_EQ(large.details().what, "grid file, bytes");
  EXPECT_EQ(large.details().limit, 1000U);
  EXPECT_GT(large.details().value.value_or(0), 1000U);
}

}  // namespace
}  // namespace tetstream
