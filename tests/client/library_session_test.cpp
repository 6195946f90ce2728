// Sessions of the public library, here and on a server.
#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "client/library/api/changed_leaves.h"
#include "client/library/api/session_impl.h"
#include "client/library/api/volume_impl.h"
#include "tests/client/library_fixture.h"

namespace tetstream {
namespace {

using test::BallSamples;
using test::expect_same;
using test::lens;
using SessionOnAServer = test::LibraryOnAServer;

/// A ball of radius 1 with a small one that has moved along its surface.
Volume frame(int number, float background = 1) {
  BallSamples ball(20);
  const std::size_t centre = ball.edge / 2;
  const double low = -ball.spacing * static_cast<double>(centre);
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

/// A ball of 120 voxels in 256 along each axis, `shift` voxels off the middle; distances are
/// cut off at three voxels, as in level sets.
Volume large_ball(double shift) {
  constexpr std::size_t kEdge = 256;
  constexpr double kMiddle = (kEdge - 1) / 2.0, kRadius = 120, kBand = 3;
  const auto squared = [](double v) { return v * v; };
  const auto from_middle = [&](std::size_t index) {
    return static_cast<double>(index) - kMiddle;
  };
  std::vector<float> values;
  values.reserve(kEdge * kEdge * kEdge);
  for (std::size_t x = 0; x < kEdge; ++x) {
    for (std::size_t y = 0; y < kEdge; ++y) {
      const double across = squared(from_middle(x) - shift) + squared(from_middle(y));
      for (std::size_t z = 0; z < kEdge; ++z) {
        const double square = across + squared(from_middle(z));
        // Roots are for the few that are near.
        values.push_back(static_cast<float>(square >= squared(kRadius + kBand) ? kBand
                                            : square <= squared(kRadius - kBand)
                                                ? -kBand
                                                : std::sqrt(square) - kRadius));
      }
    }
  }
  return Volume::from_samples(
             {.values = values, .size = {kEdge, kEdge, kEdge}, .background = 3})
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

TEST_F(SessionOnAServer, FollowsABallWhoseMoveIsMoreThanAMessageMayHold) {
  const Volume before = large_ball(0), after = large_ball(3);
  const auto leaves =
      changed_leaves(*before.impl().components.front(), *after.impl().components.front(), {});
  ASSERT_TRUE(leaves.ok()) << leaves.status();
  std::size_t bytes = 0;
  for (const v1::LeafUpdate& leaf : *leaves) bytes += leaf.ByteSizeLong();
  EXPECT_GT(leaves->size(), 4000U);
  EXPECT_GT(bytes, config_.max_request_bytes);
  const Request request{.spacing = 8.0};
  Session here = begin_session(before, request).value();  // which makes each mesh anew
  Session there = client().begin_session(before, request).value();
  ASSERT_TRUE(here.update(after).ok());
  const Status status = there.update(after);
  ASSERT_TRUE(status.ok()) << status.to_string();
  expect_same(there.mesh(), here.mesh());
}

TEST_F(SessionOnAServer, OutlivesAFrameThatIsRefused) {
  for (const bool served : {false, true}) {
    const Request request{.spacing = 0.1};
    Session session = served ? client().begin_session(lens(0.5), request).value()
                             : begin_session(lens(0.5), request).value();
    const std::uint64_t tets = session.mesh().tet_count();
    const Status apart = session.update(lens(3));  // nothing is within both balls
    EXPECT_FALSE(apart.ok());
    EXPECT_FALSE(session.is_over());
    EXPECT_EQ(session.mesh().tet_count(), tets);
    const Status next = session.update(lens(0.6));
    ASSERT_TRUE(next.ok()) << next.to_string();
    EXPECT_LT(session.mesh().tet_count(), tets);
    EXPECT_TRUE(session.end().ok());
    EXPECT_TRUE(session.is_over());
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

/// Has memory for a frame, and none to hand it over.
class FullFrames final : public FrameMaker<FrameMesh> {
 public:
  explicit FullFrames(bool follows) : follows_(follows) {}
  Result<FrameMesh> make(const Volume&, const Volume&, const ReplacedBoxes&) override {
    throw std::bad_alloc();
  }
  Result<FrameMesh> make(const Scene&) override { throw std::bad_alloc(); }
  bool is_over() const override { return false; }
  bool follows() const override { return follows_; }
  Status end() override { return {}; }

 private:
  const bool follows_;
};

// The next update would send what differs from a frame that the server no longer has.
TEST(LibrarySession, IsOverWhereItsMakerMayBeAheadOfWhatIsShown) {
  for (const bool follows : {true, false}) {
    FollowedShape<FrameMesh> of_volume{WorkOptions()}, of_scene{WorkOptions()};
    of_volume.volume = frame(0);
    of_volume.maker = std::make_unique<FullFrames>(follows);
    of_scene.maker = std::make_unique<FullFrames>(follows);
    EXPECT_EQ(of_volume.update(frame(1)).code(), StatusCode::kResourceExhausted);
    EXPECT_EQ(of_scene.update(lens(0.5)).code(), StatusCode::kResourceExhausted);
    EXPECT_EQ(of_volume.over, follows);
    EXPECT_EQ(of_scene.over, follows);
  }
}

TEST(LibrarySession, ComparesVolumesNoLongerThanAnybodyWaits) {
  const Volume before = frame(0), after = frame(1);
  const auto compare = [&](const tet::Cancellation& cancellation) {
    return changed_leaves(*before.impl().components.front(), *after.impl().components.front(),
                          cancellation)
        .status();
  };
  EXPECT_EQ(compare({}), absl::OkStatus());
  EXPECT_TRUE(
      absl::IsDeadlineExceeded(compare(tet::Cancellation(tet::Cancellation::Clock::now()))));
  tet::Cancellation cancelled;
  cancelled.cancel();
  EXPECT_TRUE(absl::IsCancelled(compare(cancelled)));
}

TEST(LibrarySession, SaysWhyThereIsNone) {
  EXPECT_EQ(begin_session(frame(0), {.spacing = -1}).status().code(),
            StatusCode::kInvalidArgument);
  Session scenes = begin_session(lens(0.5), {.spacing = 0.2}).value();
  EXPECT_EQ(scenes.update(frame(0)).code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace tetstream
