// Sessions of stable ids in the public library, here and on a server.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/client/library_fixture.h"

namespace tetstream::stable_session_test {
namespace {

using test::BallSamples;
using test::expect_same;
using test::lens;
using StableSessionOnAServer = test::LibraryOnAServer;

/// A ball of radius 1 with a small one that has moved along its surface.
Volume with_bump_at(double y) {
  BallSamples ball(20);
  const std::size_t half = ball.edge / 2;
  const double low = -ball.spacing * static_cast<double>(half);
  for (std::size_t i = 0; i < ball.values.size(); ++i) {
    const auto coordinate = [&](std::size_t index) {
      return low + ball.spacing * static_cast<double>(index % ball.edge);
    };
    const double bump = std::hypot(coordinate(i / ball.edge / ball.edge) - 1,
                                   coordinate(i / ball.edge) - y, coordinate(i)) -
                        0.15;
    ball.values[i] = std::min(ball.values[i], static_cast<float>(bump));
  }
  return Volume::from_samples(ball.array()).value();
}

/// What a reader has that looks at the changed slots alone.
struct Follower {
  std::vector<float> points;
  std::vector<std::uint32_t> tets;

  void read(const StableMesh& mesh) {
    points.resize(mesh.columns.points32.size());
    tets.resize(mesh.columns.tets32.size());
    copy(mesh.changed_vertices, mesh.columns.points32, 3, points);
    copy(mesh.changed_tets, mesh.columns.tets32, 4, tets);
  }
  template <class T>
  static void copy(const std::vector<SlotRange>& ranges,
                   std::span<const T> from,
                   std::size_t width,
                   std::vector<T>& to) {
    for (const SlotRange& range : ranges) {
      ASSERT_LE(range.end * width, from.size());
      std::copy(from.data() + range.begin * width, from.data() + range.end * width,
                to.data() + range.begin * width);
    }
  }
};

std::uint64_t slots_in(const std::vector<SlotRange>& ranges) {
  std::uint64_t count = 0;
  for (const SlotRange& range : ranges) count += range.end - range.begin;
  return count;
}

void expect_same_slots(const StableMesh& a, const StableMesh& b) {
  EXPECT_TRUE(std::ranges::equal(a.columns.points32, b.columns.points32));
  EXPECT_TRUE(std::ranges::equal(a.columns.tets32, b.columns.tets32));
  EXPECT_EQ(a.empty_vertices, b.empty_vertices);
  EXPECT_EQ(a.empty_tets, b.empty_tets);
  EXPECT_EQ(a.changed_vertices, b.changed_vertices);
  EXPECT_EQ(a.changed_tets, b.changed_tets);
  EXPECT_EQ(a.renumbered, b.renumbered);
}

/// The tets that are there have positive volumes together; the empty ones are four times 0.
void expect_counted(const StableMesh& mesh) {
  EXPECT_EQ(mesh.columns.tet_count(), mesh.header.tet_count + slots_in(mesh.empty_tets));
  EXPECT_EQ(mesh.columns.vertex_count(),
            mesh.header.vertex_count + slots_in(mesh.empty_vertices));
  std::uint64_t empty = 0;
  for (std::size_t i = 0; i < mesh.columns.tet_count(); ++i) {
    const auto corners = mesh.columns.tet(i);
    empty += std::ranges::count(corners, corners.front()) == 4 ? 1 : 0;
  }
  EXPECT_EQ(empty, slots_in(mesh.empty_tets));
}

TEST_F(StableSessionOnAServer, IsTheMeshOfASessionInOrderHereAndThere) {
  Session whole = begin_session(with_bump_at(0)).value();
  StableSession here = begin_stable_session(with_bump_at(0)).value();
  StableSession there = client().begin_stable_session(with_bump_at(0)).value();
  Follower follower;
  EXPECT_TRUE(here.mesh().renumbered);
  bool kept_ids = false;
  for (int i = 1; i < 8; ++i) {
    SCOPED_TRACE(i);
    follower.read(there.mesh());
    EXPECT_TRUE(std::ranges::equal(follower.points, there.mesh().columns.points32));
    EXPECT_TRUE(std::ranges::equal(follower.tets, there.mesh().columns.tets32));
    expect_same(here.in_order().value(), whole.mesh());
    expect_same(there.in_order().value(), whole.mesh());
    expect_same_slots(there.mesh(), here.mesh());
    expect_counted(here.mesh());
    EXPECT_EQ(here.tets_sent(), there.tets_sent());
    const Volume next = with_bump_at(0.05 * ((i * 3) % 7));
    ASSERT_TRUE(whole.update(next).ok());
    ASSERT_TRUE(here.update(next).ok());
    const Status status = there.update(next);
    ASSERT_TRUE(status.ok()) << status.to_string();
    if (!here.mesh().renumbered) {
      kept_ids = true;
      EXPECT_LT(slots_in(here.mesh().changed_tets), here.mesh().header.tet_count / 2);
      EXPECT_LT(here.tets_sent(), here.mesh().header.tet_count / 2);
    }
  }
  EXPECT_TRUE(kept_ids);
  EXPECT_TRUE(there.end().ok());
  EXPECT_EQ(there.update(with_bump_at(0)).code(), StatusCode::kFailedPrecondition);
  expect_same(there.in_order().value(), whole.mesh());  // it stays
}

TEST_F(StableSessionOnAServer, FollowsScenes) {
  Session whole = begin_session(lens(0.5), {.spacing = 0.1}).value();
  StableSession here = begin_stable_session(lens(0.5), {.spacing = 0.1}).value();
  StableSession there = client().begin_stable_session(lens(0.5), {.spacing = 0.1}).value();
  for (const double offset : {0.5, 0.52, 0.9}) {
    for (StableSession* session : {&here, &there}) {
      ASSERT_TRUE(session->update(lens(offset)).ok());
    }
    ASSERT_TRUE(whole.update(lens(offset)).ok());
    expect_same(here.in_order().value(), whole.mesh());
    expect_same_slots(there.mesh(), here.mesh());
  }
  EXPECT_EQ(here.update(with_bump_at(0)).code(), StatusCode::kInvalidArgument);
}

TEST_F(StableSessionOnAServer, HasAllColumnsOfMeshesThatComeWhole) {
  Request request{.preset = Preset::kBothSides, .faces = true};
  request.fields = {{"distance", with_bump_at(0)}};
  Session whole = begin_session(with_bump_at(0), request).value();
  StableSession here = begin_stable_session(with_bump_at(0), request).value();
  StableSession there = client().begin_stable_session(with_bump_at(0), request).value();
  for (const double y : {0.1, 0.3}) {
    for (StableSession* session : {&here, &there}) {
      ASSERT_TRUE(session->update(with_bump_at(y)).ok());
      EXPECT_TRUE(session->mesh().renumbered);
    }
    ASSERT_TRUE(whole.update(with_bump_at(y)).ok());
    for (StableSession* session : {&here, &there}) {
      expect_same(session->in_order().value(), whole.mesh());
      const MeshColumns& columns = session->mesh().columns;
      EXPECT_TRUE(std::ranges::equal(columns.fields, whole.mesh().columns().fields));
      EXPECT_TRUE(std::ranges::equal(columns.faces32, whole.mesh().columns().faces32));
    }
    EXPECT_FALSE(whole.mesh().columns().fields.empty());
    EXPECT_FALSE(whole.mesh().columns().faces32.empty());
  }
}

TEST_F(StableSessionOnAServer, StaysAsItIsWhereAFrameIsRefused) {
  for (const bool served : {false, true}) {
    const Request request{.spacing = 0.1};
    StableSession session = served ? client().begin_stable_session(lens(0.5), request).value()
                                   : begin_stable_session(lens(0.5), request).value();
    const Mesh before = session.in_order().value();
    const Status apart = session.update(lens(3));  // nothing is within both balls
    EXPECT_FALSE(apart.ok());
    EXPECT_FALSE(session.is_over());
    expect_same(session.in_order().value(), before);
    EXPECT_TRUE(session.update(lens(0.6)).ok());
    EXPECT_LT(session.mesh().header.tet_count, before.tet_count());
  }
}

TEST_F(StableSessionOnAServer, HasNoMeshOnceAFailureHasEndedIt) {
  for (const bool served : {false, true}) {
    std::stop_source stop;
    WorkOptions options;
    options.stop = stop.get_token();
    StableSession session =
        served ? client().begin_stable_session(lens(0.5), {.spacing = 0.1}, options).value()
               : begin_stable_session(lens(0.5), {.spacing = 0.1}, options).value();
    const std::shared_ptr<const void> memory = session.mesh().memory;
    const std::span<const float> points = session.mesh().columns.points32;
    const std::vector<float> copy(points.begin(), points.end());
    stop.request_stop();
    EXPECT_EQ(session.update(lens(0.6)).code(), StatusCode::kCancelled);
    EXPECT_TRUE(session.is_over());
    EXPECT_EQ(session.mesh().columns.tet_count(), 0U);
    EXPECT_EQ(session.mesh().memory, nullptr);
    EXPECT_EQ(session.in_order().status().code(), StatusCode::kFailedPrecondition);
    EXPECT_TRUE(std::ranges::equal(points, copy));  // held, and nothing was patched
  }
}

TEST(StableSessionHere, ColumnsStayReadableForAsLongAsTheirMemoryIsHeld) {
  std::vector<StableMesh> views;
  {
    StableSession session = begin_stable_session(lens(1.5), {.spacing = 0.1}).value();
    views.push_back(session.mesh());
    for (const double offset : {1.2, 0.5, 0.1, 1.7, 0.2}) {  // grows, and shrinks
      ASSERT_TRUE(session.update(lens(offset)).ok());
      views.push_back(session.mesh());
    }
  }
  for (const StableMesh& view : views) {  // with the session gone: for the address sanitizer
    float sum = 0;
    for (const float coordinate : view.columns.points32) sum += coordinate;
    EXPECT_TRUE(std::isfinite(sum));
    std::uint64_t most = 0;
    for (const std::uint32_t id : view.columns.tets32) most = std::max<std::uint64_t>(most, id);
    EXPECT_GT(most, 0U);
  }
}

/// The box around the bumps at two places, in samples.
SampleBox around_bumps(double a, double b) {
  const BallSamples ball(20);
  const auto at = [&](double coordinate) {
    return static_cast<std::int32_t>(coordinate / ball.spacing) +
           static_cast<std::int32_t>(ball.edge / 2);
  };
  return {{at(0.5), at(std::min(a, b) - 0.9), at(-0.9)},
          {static_cast<std::int32_t>(ball.edge), at(std::max(a, b) + 0.9), at(0.9)}};
}

TEST_F(StableSessionOnAServer, MakesTheSameMeshWhereWhatWasReplacedIsNamed) {
  Session whole = begin_session(with_bump_at(0)).value();
  StableSession here = begin_stable_session(with_bump_at(0)).value();
  StableSession there = client().begin_stable_session(with_bump_at(0)).value();
  double before = 0;
  for (const double y : {0.05, 0.3, -0.2}) {
    const Volume next = with_bump_at(y);
    const std::vector<SampleBox> all{{{0, 0, 0}, {1 << 20, 1 << 20, 1 << 20}}};
    const std::vector<SampleBox> replaced =
        y < 0 ? all : std::vector{around_bumps(before, y), SampleBox{}};
    ASSERT_TRUE(whole.update(next).ok());
    for (StableSession* session : {&here, &there}) {
      const Status status = session->update(next, replaced);
      ASSERT_TRUE(status.ok()) << status.to_string();
      expect_same(session->in_order().value(), whole.mesh());
    }
    expect_same_slots(there.mesh(), here.mesh());
    before = y;
  }
}

TEST_F(StableSessionOnAServer, RefusesAListThatLeavesOutWhatHasChanged) {
  for (const bool served : {false, true}) {
    StableSession session = served ? client().begin_stable_session(with_bump_at(0)).value()
                                   : begin_stable_session(with_bump_at(0)).value();
    const Mesh before = session.in_order().value();
    const std::vector<std::vector<SampleBox>> lists{{},
                                                    {{{0, 0, 0}, {8, 8, 8}}},
                                                    {around_bumps(2, 2)},
                                                    {{{5, 0, 0}, {4, 9, 9}}},
                                                    {{{0, 0, 0}, {1 << 30, 1, 1}}}};
    for (const std::vector<SampleBox>& list : lists) {
      const Status status = session.update(with_bump_at(0.3), list);
      EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
      EXPECT_NE(status.message().find("replaced"), std::string::npos) << status.to_string();
      EXPECT_FALSE(session.is_over());
    }
    expect_same(session.in_order().value(), before);
    EXPECT_TRUE(session.update(with_bump_at(0.3)).ok());
  }
}

TEST(StableSessionHere, SaysWhyThereIsNone) {
  EXPECT_EQ(begin_stable_session(lens(0.5), {.spacing = -1}).status().code(),
            StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace tetstream::stable_session_test
