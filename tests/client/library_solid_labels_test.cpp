// Level sets and scenes as labels by the public library, here and beside a real server.
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/client/library_fixture.h"

namespace tetstream {
namespace {

using test::BallSamples;
using test::collected;
using test::expect_same;
using test::LibraryOnAServer;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kShells = R"({"nodes": [
    {"name": "core", "sphere": {"radius": 0.5}},
    {"name": "mantle", "sphere": {"radius": 1}},
    {"name": "both", "union": {"of": ["core", "mantle"]}}]})";

/// A ball of radius 1 around (x, 0, 0).
Volume ball_at(double x) {
  const BallSamples samples(12);
  SampleArray array = samples.array();
  array.origin[0] += x;
  return Volume::from_samples(array).value();
}

TEST(LibrarySolidLabels, OfLevelSetsAreOneMesh) {
  const Labels drops = Labels::from_level_sets({ball_at(0), ball_at(1.5)}).value();
  Request request{.faces = true};
  request.labels = {.names = {{1, "water"}, {2, "oil"}}};
  const Mesh made = mesh(drops, request).value();
  EXPECT_THAT(made.header().labels, testing::SizeIs(2));
  std::vector<std::string> faces;
  for (const FaceLabel& label : made.header().face_labels) faces.push_back(label.name);
  EXPECT_THAT(faces, testing::Contains("water_oil"));
  EXPECT_EQ(estimate(drops, request).value().tet_count, made.tet_count());
  expect_same(collected(stream(drops, request)), made);
  EXPECT_EQ(drops.counts().size(), 2U);
}

TEST(LibrarySolidLabels, AreRefusedWithWhatToDo) {
  EXPECT_THAT(Labels::from_level_sets({}).status().message(), HasSubstr("0 level sets"));
  const Labels drops = Labels::from_level_sets({ball_at(0)}).value();
  EXPECT_EQ(drops.write_nrrd("drops.nrrd").code(), StatusCode::kFailedPrecondition);
}

TEST(LibrarySolidLabels, HaveSizesOfTheirOwn) {
  const Scene scene = Scene::from_json(kShells).value();
  Request request{.spacing = 0.05};
  request.labels.emplace();
  request.labels->sizes = {{{1, 1}, 0.4}, {{2, 2}, 0.05}};
  const Estimate sized = estimate(scene, request).value();
  request.labels->sizes.clear();
  EXPECT_GT(sized.tet_count, estimate(scene, request).value().tet_count);
}

class ServedSolidLabels : public LibraryOnAServer {};

TEST_F(ServedSolidLabels, HaveTheSameBytesHereAndThere) {
  const std::string path = solid_file("parts", 0.1);
  const StoredVolume stored = client().upload_file(path).value();
  const Labels parts =
      Labels::from_level_sets({Volume::from_vdb(path, {.grid = "ring"}).value(),
                               Volume::from_vdb(path, {.grid = "ball"}).value()})
          .value();
  Request request{.levels = 2};
  request.labels = {.mesh_background = true, .sizes = {{{0, 0}, 0.2}}};
  const Mesh here = mesh(parts, request).value();
  const auto there = client().mesh({stored.name, {}, {"ring", "ball"}}, request);
  ASSERT_TRUE(there.ok()) << there.status().to_string();
  expect_same(*there, here);
  EXPECT_THAT(client().upload(parts).status().message(), HasSubstr("StoredVolume::grids"));
  EXPECT_THAT(client().mesh({stored.name, {}, {"ring"}}, Request()).status().message(),
              HasSubstr("labels"));

  const Scene scene = Scene::from_json(kShells).value();
  Request shells{.spacing = 0.1};
  shells.labels.emplace();
  expect_same(client().mesh(scene, shells).value(), mesh(scene, shells).value());
}

}  // namespace
}  // namespace tetstream
