// Points over a real connection: what a server says of them, and what it lets nobody do.
#include "core/plan/sample_points.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/vdb/openvdb/load.h"
#include "server/ops/memory.h"
#include "server/streams/call_charge.h"
#include "tests/client/cutting_proxy.h"
#include "tests/server/passing_time.h"
#include "tests/server/reason_of.h"
#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

using testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<WorldPoint> points_within(double reach, std::size_t count) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> place(-reach, reach);
  std::vector<WorldPoint> points(count);
  for (WorldPoint& p : points) p = {place(random), place(random), place(random)};
  return points;
}

v1::SamplePointsRequest start_of(const v1::MeshRequest& request) {
  v1::SamplePointsRequest message;
  *message.mutable_start() = request;
  return message;
}

v1::SamplePointsRequest points_of(const std::vector<double>& numbers) {
  v1::SamplePointsRequest message;
  message.mutable_points()->set_positions(numbers.data(), numbers.size() * sizeof(double));
  return message;
}

void expect_same_samples(const PointSamples& one, const PointSamples& other) {
  EXPECT_EQ(one.arrays, other.arrays);
  const auto same = [](const auto& a, const auto& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
  };
  EXPECT_TRUE(same(one.phi, other.phi));
  EXPECT_TRUE(same(one.slopes, other.slopes));
  EXPECT_TRUE(same(one.fields, other.fields));
}

class SamplePointsTest : public ServiceTest {
 protected:
  PointSamples sampled_here(const Shape& shape,
                            const MeshRequest& request,
                            const std::vector<WorldPoint>& points) {
    absl::StatusOr<PointSamples> samples = absl::UnknownError("not sampled");
    TaskPool(2).run([&] { samples = tet::sample_points(shape, request, points); });
    EXPECT_TRUE(samples.ok()) << samples.status();
    return samples.ok() ? *std::move(samples) : PointSamples{};
  }

  PointSamples sampled_there(const v1::MeshRequest& request,
                             const std::vector<WorldPoint>& points) {
    auto samples = client_->sample_points(request, points, {}, never_);
    EXPECT_TRUE(samples.ok()) << samples.status();
    return samples.ok() ? *std::move(samples) : PointSamples{};
  }

  /// How a call ends in which a client says this, and how many points it was told of.
  grpc::Status answer_to(const std::vector<v1::SamplePointsRequest>& messages) {
    grpc::ClientContext context;
    const auto stream = meshes_->SamplePoints(&context);
    for (const v1::SamplePointsRequest& message : messages) stream->Write(message);
    stream->WritesDone();
    answers_ = answered_ = 0;
    for (v1::SamplePointsResponse response; stream->Read(&response);) {
      ++answers_;
      answered_ += response.samples().point_count();
    }
    return stream->Finish();
  }

  v1::MeshRequest scene_of_a_ball() {
    v1::MeshRequest request;
    request.mutable_scene()->add_nodes()->mutable_sphere()->set_radius(1);
    return request;
  }

  std::int64_t answers_ = 0, answered_ = 0;
};

TEST_F(SamplePointsTest, SaysOfAGridWhatIsSaidInProcess) {
  start();
  const std::string path = solid_file("torus", 0.1);
  const auto points = points_within(1.5, 20'000);
  const Shape shape = std::make_shared<const Volume>(load_volume(path, "").value());
  expect_same_samples(sampled_there(mesh_of(path), points), sampled_here(shape, {}, points));
}

TEST_F(SamplePointsTest, SaysValuesOfFieldsToo) {
  start();
  const std::string path = solid_file("fields", 0.1);
  const auto points = points_within(1.5, 9'000);
  const Shape shape = std::make_shared<const Volume>(load_volume(path, "sphere").value());
  MeshRequest request;
  VertexField heat{.name = "T", .grid = "heat"};
  heat.components = {std::make_shared<const Volume>(load_field(path, "heat", 0).value())};
  request.fields.push_back(heat);
  v1::MeshRequest message = mesh_of(path);
  message.set_grid_name("sphere");
  message.add_fields()->set_name("T");
  message.mutable_fields(0)->set_grid_name("heat");
  const PointSamples there = sampled_there(message, points);
  EXPECT_EQ(there.width, 1U);
  expect_same_samples(there, sampled_here(shape, request, points));
}

TEST_F(SamplePointsTest, SaysTheDistanceFromASceneAndItsSlope) {
  start();
  const auto points = points_within(2, 3'000);
  const PointSamples samples = sampled_there(scene_of_a_ball(), points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [x, y, z] = points[i];
    const double radius = std::sqrt(x * x + y * y + z * z);
    ASSERT_NEAR(samples.phi[i], radius - 1, 1e-9);
    ASSERT_NEAR(samples.slopes[3 * i], x / radius, 1e-4 / radius);
  }
}

TEST_F(SamplePointsTest, SaysOfAPointOutsideThatNothingChangesThere) {
  start();
  const std::string path = ball_file(8);
  const double background = load_volume(path, "").value().background;
  for (const double far : {50.0, 1e30}) {
    const PointSamples samples = sampled_there(mesh_of(path), {{far, -far, 0}});
    EXPECT_EQ(samples.phi, std::vector<double>{background});
    EXPECT_EQ(samples.slopes, std::vector<double>(3, 0));
  }
}

TEST_F(SamplePointsTest, NeedsNoPoints) {
  start();
  EXPECT_TRUE(sampled_there(scene_of_a_ball(), {}).phi.empty());
  EXPECT_TRUE(answer_to({start_of(scene_of_a_ball()), points_of({}), points_of({1, 0, 0}),
                         points_of({}), points_of({0, 0, 0})})
                  .ok());
  EXPECT_EQ(answered_, 2);
}

TEST_F(SamplePointsTest, AnswersAMillionPointsInFewBlocks) {
  start();
  const auto points = points_within(1.5, 1'000'000);
  std::uint64_t calls = 0, most_bytes = 0;
  const auto watch = [&](std::uint64_t, std::uint64_t) {
    ++calls;
    most_bytes = std::max(most_bytes, server_->engine().send_budget.used_bytes());
  };
  const auto samples = client_->sample_points(scene_of_a_ball(), points, watch, never_);
  ASSERT_TRUE(samples.ok()) << samples.status();
  EXPECT_GT(calls, 100U);
  EXPECT_LT(most_bytes, 8U << 20) << "all answers together have 32 MB";
  double most_off = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [x, y, z] = points[i];
    most_off =
        std::max(most_off, std::abs(samples->phi[i] + 1 - std::sqrt(x * x + y * y + z * z)));
  }
  EXPECT_LT(most_off, 1e-9) << "every point has its own answer";
}

TEST_F(SamplePointsTest, StopsSoonAfterACancellation) {
  start();
  const auto points = points_within(1.5, 300'000);
  Cancellation stop;
  std::uint64_t done = 0;
  const auto stop_midway = [&](std::uint64_t answered, std::uint64_t) {
    done = answered;
    stop.cancel();
  };
  const auto samples = client_->sample_points(scene_of_a_ball(), points, stop_midway, stop);
  EXPECT_EQ(samples.status().code(), absl::StatusCode::kCancelled) << samples.status();
  EXPECT_LT(done, points.size());
  EXPECT_TRUE(work_stops());
  EXPECT_TRUE(eventually([&] { return server_->running_calls() == 0; }));
}

TEST_F(SamplePointsTest, GoesOnWhereAConnectionBroke) {
  start();
  const auto points = points_within(1.5, 150'000);
  CuttingProxy proxy(server_->port(), std::uint64_t{1} << 40, 2'000'000);
  const auto client =
      MeshClient::connect(proxy.address(), {.attempts = 6, .first_backoff_ms = 10});
  const auto samples = client->sample_points(scene_of_a_ball(), points, {}, never_);
  ASSERT_TRUE(samples.ok()) << samples.status();
  EXPECT_GT(proxy.cuts(), 0);
  expect_same_samples(*samples, sampled_there(scene_of_a_ball(), points));
}

TEST_F(SamplePointsTest, TakesNoTurnFromMeshesWhileItWaits) {
  config_.max_streams = 1;
  start();
  grpc::ClientContext context;
  const auto stream = meshes_->SamplePoints(&context);
  stream->Write(start_of(scene_of_a_ball()));
  v1::SamplePointsResponse header;
  ASSERT_TRUE(stream->Read(&header));
  EXPECT_TRUE(client_->stream_mesh(uniform_ball(8), {}, never_).ok());
  stream->Write(points_of({0, 0, 2}));
  v1::SamplePointsResponse answer;
  ASSERT_TRUE(stream->Read(&answer));
  EXPECT_EQ(answer.samples().point_count(), 1);
  stream->WritesDone();
  EXPECT_TRUE(stream->Finish().ok());
}

TEST_F(SamplePointsTest, HoldsPointsOnlyUntilTheyAreAnswered) {
  start();
  grpc::ClientContext context;
  const auto stream = meshes_->SamplePoints(&context);
  stream->Write(start_of(scene_of_a_ball()));
  v1::SamplePointsResponse response;
  ASSERT_TRUE(stream->Read(&response));
  // Nobody reads the answers, which are more than a connection holds.
  constexpr std::int64_t kMany = 100'000;
  ASSERT_TRUE(stream->Write(points_of(std::vector<double>(3 * kMany, 0.5))));
  EXPECT_TRUE(eventually([&] { return activity().point_bytes == kMany * sizeof(WorldPoint); }));
  for (std::int64_t answered = 0; answered < kMany;) {
    ASSERT_TRUE(stream->Read(&response));
    answered += response.samples().point_count();
  }
  EXPECT_TRUE(eventually([&] { return activity().point_bytes == 0; }));
  ASSERT_TRUE(stream->Write(points_of({0, 0, 2})));
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_EQ(response.samples().first_point(), kMany);
  stream->WritesDone();
  EXPECT_TRUE(stream->Finish().ok());
}

TEST_F(SamplePointsTest, RefusesPointsThatOthersLeaveNoRoomFor) {
  start();
  const std::uint64_t limit = point_bytes(config_);
  CallCharge others("others' points", const_cast<Activity&>(activity()).point_bytes, limit);
  ASSERT_EQ(others.add(limit - 2 * sizeof(WorldPoint)), absl::OkStatus());
  const v1::SamplePointsRequest begin = start_of(scene_of_a_ball());
  const v1::SamplePointsRequest fits = points_of(std::vector<double>(6, 0.5));
  const v1::SamplePointsRequest more = points_of(std::vector<double>(9, 0.5));
  EXPECT_TRUE(answer_to({begin, fits, fits}).ok());
  const grpc::Status refused = answer_to({begin, more});
  EXPECT_EQ(reason_of(refused), "tetstream/SERVER_BUSY") << refused.error_message();
  EXPECT_THAT(refused.error_message(), HasSubstr("bytes of points that are sampled"));
  others.shrink_to(0);
  EXPECT_TRUE(answer_to({begin, more}).ok());
}

TEST_F(SamplePointsTest, EndsACallWhoseClientSendsNothing) {
  config_.stall_seconds = 2 * config_.session_idle_seconds;
  start();
  grpc::ClientContext context;
  const auto stream = meshes_->SamplePoints(&context);
  stream->Write(start_of(scene_of_a_ball()));
  v1::SamplePointsResponse response;
  ASSERT_TRUE(stream->Read(&response));
  const PassingTime passing(*server_, config_.session_idle_seconds);
  EXPECT_FALSE(stream->Read(&response));
  const grpc::Status status = stream->Finish();
  EXPECT_EQ(reason_of(status), "tetstream/CLIENT_STALLED");
  EXPECT_THAT(status.error_message(), HasSubstr("sent no points for"));
}

// Its grid stays in memory while the call lives, however idle it is, and is nobody's share.
TEST_F(SamplePointsTest, EndsAnIdleCallWhoseGridLeavesNoRoomForAnothers) {
  const std::string held = solid_file("sphere", 0.04), wanted = solid_file("cavity", 0.04);
  config_.resident_bytes =
      load_volume(held, "")->size_bytes() + load_volume(wanted, "")->size_bytes() - 1;
  start();
  constexpr std::uint64_t kAWhile = 40;  // less than a session may be idle otherwise
  ASSERT_LT(2 * kAWhile, config_.session_idle_seconds);
  ASSERT_LE(kAWhile, config_.stall_seconds);
  const v1::MeshRequest other = mesh_of(wanted);
  grpc::ClientContext context;
  const auto stream = meshes_->SamplePoints(&context);
  stream->Write(start_of(mesh_of(held)));
  v1::SamplePointsResponse response;
  ASSERT_TRUE(stream->Read(&response));
  const auto ask = [&] { return answer_to({start_of(other), points_of({0, 0, 0})}); };
  {
    const PassingTime passing(*server_, kAWhile);
    stream->Write(points_of({0, 0, 0}));
    ASSERT_TRUE(stream->Read(&response)) << "nobody lacks its room";
  }
  EXPECT_EQ(ask().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  {
    const PassingTime passing(*server_, kAWhile);
    EXPECT_TRUE(eventually([&] {
      ask();
      return server_->running_calls() == 0;
    }));
  }
  EXPECT_FALSE(stream->Read(&response));
  EXPECT_EQ(reason_of(stream->Finish()), "tetstream/CLIENT_STALLED");
  EXPECT_TRUE(eventually([&] { return ask().ok(); }));
}

TEST_F(SamplePointsTest, EndsACallWhoseClientReadsNothing) {
  config_.stall_seconds = 1;
  start();
  grpc::ClientContext context;
  const auto stream = meshes_->SamplePoints(&context);
  ASSERT_TRUE(stream->Write(start_of(scene_of_a_ball())));
  const v1::SamplePointsRequest batch = points_of(std::vector<double>(3 * 10'000, 0.5));
  while (stream->Write(batch)) {  // until the server does not read, and then gives it up
  }
  for (v1::SamplePointsResponse response; stream->Read(&response);) {
  }
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::ABORTED);
  EXPECT_TRUE(work_stops());
}

TEST_F(SamplePointsTest, EndsWithTheServer) {
  start();
  grpc::ClientContext context;
  const auto stream = meshes_->SamplePoints(&context);
  stream->Write(start_of(scene_of_a_ball()));
  v1::SamplePointsResponse header;
  ASSERT_TRUE(stream->Read(&header));
  server_->stop(0s);
  EXPECT_FALSE(stream->Read(&header));
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::UNAVAILABLE);
}

TEST_F(SamplePointsTest, RefusesWhatMakesNoSense) {
  start();
  const v1::SamplePointsRequest begin = start_of(scene_of_a_ball()), nothing;
  v1::SamplePointsRequest torn;
  torn.mutable_points()->set_positions("a few bytes");
  v1::MeshRequest several = mesh_of(ball_file(8));
  several.add_grid_names("sphere");
  v1::MeshRequest labels = mesh_of(ball_file(8));
  labels.mutable_labels();
  v1::MeshRequest unknown;
  unknown.set_name("grids/" + std::string(64, 'a'));
  const std::vector<double> fine(3 * 20'000, 0.5);
  std::vector<double> spoilt = fine;
  spoilt[3 * 19'999 + 1] = kInfinity;
  struct Case {
    std::vector<v1::SamplePointsRequest> messages;
    std::string reason, message;
  };
  const Case cases[] = {
      {{}, "MESSAGE_ORDER", "it ended before `start`"},
      {{points_of({0, 0, 0})}, "MESSAGE_ORDER", "points before `start`"},
      {{begin, begin}, "MESSAGE_ORDER", "a second `start`"},
      {{begin, nothing}, "MESSAGE_ORDER", "a message with neither `start` nor `points`"},
      {{begin, torn}, "INVALID_FIELD", "positions has 11 bytes; a point has 24"},
      {{begin, points_of({0, std::nan(""), 0})}, "INVALID_FIELD", "point 0 (0 nan 0) is not"},
      {{begin, points_of(fine), points_of(spoilt)}, "INVALID_FIELD", "point 39999 (0.5 inf"},
      {{begin, points_of({0, 0, 1e300})}, "INVALID_FIELD", "farther than 1e+30"},
      {{start_of(several)}, "INVALID_FIELD", "several grids have no phi in common"},
      {{start_of(labels)}, "INVALID_FIELD", "labels have no phi"},
      {{start_of(unknown)}, "GRID_NOT_FOUND", "aaaa"},
  };
  for (const Case& c : cases) {
    const grpc::Status status = answer_to(c.messages);
    EXPECT_EQ(reason_of(status), "tetstream/" + c.reason) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr(c.message));
  }
}

}  // namespace
}  // namespace tet::test
