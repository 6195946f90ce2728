// Sessions of the public library, here and on a server.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/client/library_fixture.h"

namespace tetstream {
namespace {

using test::BallSamples;
using test::expect_same;
using SessionOnAServer = test::LibraryOnAServer;

/// A ball of radius 1 with a small one that has moved along its surface.
Volume frame(int number, float background = 1) {
  BallSamples ball(20);
  const double low = -ball.spacing * static_cast<double>(ball.edge / 2);
  for (std::size_t i = 0; i < ball.values.size(); ++i) {
    const auto coordinate = [&](std::size_t index) {
      return low + ball.spacing * static_cast<double>(index % ball.edge);
    };
    const double x = coordinate(i / ball.edge / ball.edge), y = coordinate(i / ball.edge),
                 z = coordinate(i);
    const double bump = std::hypot(x - 1, y - 0.05 * number, z) - 0.15;
    ball.values[i] = std::min(ball.values[i], static_cast<float>(bump));
  }
  SampleArray array = ball.array();
  array.background = background;
  return Volume::from_samples(array).value();
}

Scene lens(double offset) {
  return Scene::from_json(R"({"nodes": [{"name": "ball", "sphere": {"radius": 1}},
    {"name": "other", "transform": {"of": "ball", "translation": [)" +
                          std::to_string(offset) + R"(, 0, 0]}},
    {"intersection": {"of": ["ball", "other"]}}]})")
      .value();
}

TEST_F(SessionOnAServer, MakesTheBytesThatAreMadeHereOfVolumes) {
  Session here = begin_session(frame(0)).value();
  Session there = client().begin_session(frame(0)).value();
  expect_same(there.mesh(), here.mesh());
  EXPECT_EQ(there.tets_sent(), there.mesh().tet_count());
  for (int i = 1; i < 4; ++i) {
    ASSERT_TRUE(here.update(frame(i)).ok());
    const Status status = there.update(frame(i));
    ASSERT_TRUE(status.ok()) << status.to_string();
    expect_same(there.mesh(), here.mesh());
    EXPECT_LT(there.tets_sent(), there.mesh().tet_count() / 2);
  }
  EXPECT_TRUE(there.end().ok());
  EXPECT_EQ(there.update(frame(0)).code(), StatusCode::kFailedPrecondition);
}

TEST_F(SessionOnAServer, MakesTheBytesThatAreMadeHereOfScenes) {
  Session here = begin_session(lens(0.5), {.spacing = 0.1}).value();
  Session there = client().begin_session(lens(0.5), {.spacing = 0.1}).value();
  for (const double offset : {0.52, 0.6}) {
    ASSERT_TRUE(here.update(lens(offset)).ok() && there.update(lens(offset)).ok());
    expect_same(there.mesh(), here.mesh());
  }
}

TEST_F(SessionOnAServer, KeepsTheMeshThatSomebodyHas) {
  Session session = client().begin_session(frame(0)).value();
  const Mesh first = session.mesh();
  const std::vector<float> points(first.columns().points32.begin(),
                                  first.columns().points32.end());
  ASSERT_TRUE(session.update(frame(3)).ok());
  EXPECT_TRUE(std::ranges::equal(points, first.columns().points32));
}

TEST_F(SessionOnAServer, SaysWhatItCannotFollow) {
  Session session = client().begin_session(frame(0)).value();
  EXPECT_EQ(session.update(lens(0.5)).code(), StatusCode::kInvalidArgument);
  const Status other = session.update(frame(0, 2));
  EXPECT_EQ(
      other.message(),
      "the background is another than that of the session's volume: begin another session");
}

TEST(LibrarySession, SaysWhyThereIsNone) {
  EXPECT_EQ(begin_session(frame(0), {.spacing = -1}).status().code(),
            StatusCode::kInvalidArgument);
  Session scenes = begin_session(lens(0.5), {.spacing = 0.2}).value();
  EXPECT_EQ(scenes.update(frame(0)).code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace tetstream
