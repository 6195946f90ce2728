// Limits as clients meet them.
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "tests/server/held_place.h"
#include "tests/server/held_plan.h"
#include "tests/server/held_stream.h"
#include "tests/server/open_upload.h"
#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

using testing::HasSubstr;

template <class Detail>
bool has_detail(const grpc::Status& status) {
  google::rpc::Status rpc;
  EXPECT_TRUE(rpc.ParseFromString(status.error_details()));
  return std::any_of(rpc.details().begin(), rpc.details().end(),
                     [](const auto& detail) { return detail.template Is<Detail>(); });
}

class AdmissionServiceTest : public ServiceTest {
 protected:
  AdmissionServiceTest() {
    config_.max_streams = 1;
    config_.queue_seconds = 3600;  // nobody waits for longer than a test's threads stand still
    start();
  }

  const Admission& admission() const { return server_->engine().calls.admission(); }

  bool queue_holds(std::uint64_t meshes) const {
    return eventually([&] { return admission().queued_meshes() == meshes; });
  }

  bool is_running(std::uint64_t meshes) const {
    return eventually([&] { return admission().running_meshes() == meshes; });
  }

  grpc::Status estimate(const v1::MeshRequest& mesh, grpc::ClientContext& context) {
    v1::EstimateMeshRequest request;
    *request.mutable_mesh() = mesh;
    v1::MeshHeader header;
    return meshes_->EstimateMesh(&context, request, &header);
  }
};

TEST_F(AdmissionServiceTest, AMeshWaitsForItsTurn) {
  const v1::MeshRequest ball = uniform_ball(28);
  HeldPlace first(*server_);
  grpc::Status status;
  std::jthread second([&] {
    grpc::ClientContext context;
    status = estimate(ball, context);
  });
  EXPECT_TRUE(queue_holds(1));
  first.let_go();
  second.join();
  EXPECT_TRUE(status.ok()) << status.error_message();
}

TEST_F(AdmissionServiceTest, ADeadlineInTheQueueIsKept) {
  const v1::MeshRequest ball = uniform_ball(28);
  HeldPlace first(*server_);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + 200ms);
  EXPECT_EQ(estimate(ball, context).error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  EXPECT_TRUE(queue_holds(0));
  first.let_go();
  EXPECT_TRUE(work_stops());
}

TEST_F(AdmissionServiceTest, WhoeverGivesUpInTheQueueLeavesItAtOnce) {
  const v1::MeshRequest ball = uniform_ball(28);
  HeldPlace first(*server_);
  grpc::ClientContext stream_context, estimate_context;
  const auto second = meshes_->StreamMesh(&stream_context, stream_of(ball));
  std::jthread third([&] { estimate(ball, estimate_context); });
  EXPECT_TRUE(queue_holds(2));
  stream_context.TryCancel();
  estimate_context.TryCancel();
  EXPECT_EQ(second->Finish().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_TRUE(queue_holds(0));
  first.let_go();
}

TEST_F(AdmissionServiceTest, ADrainRefusesTheQueueAndLetsRunWhatRuns) {
  const v1::MeshRequest ball = uniform_ball(28);
  HeldStream running(*meshes_, stream_of(ball));
  HeldPlace first(*server_);
  grpc::ClientContext context;
  const auto second = meshes_->StreamMesh(&context, stream_of(ball));
  EXPECT_TRUE(queue_holds(1));
  std::jthread stopper([&] { server_->stop(kGenerousEnd); });
  const grpc::Status refused = second->Finish();
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_TRUE(has_detail<google::rpc::RetryInfo>(refused));
  EXPECT_EQ(activity().meshes, 1);
  running.let_go();
  first.let_go();
}

// A stream that nobody reads comes back again and again, until as much of it is under way as
// there is room for: where nobody may wait, whoever comes meanwhile is refused.
TEST_F(AdmissionServiceTest, AStreamThatWaitsForItsReaderLeavesItsPlaceToOthers) {
  config_.max_queued = 0;
  restart();
  const v1::MeshRequest ball = uniform_ball(28);
  HeldStream held(*meshes_, stream_of(ball));
  ASSERT_TRUE(eventually([&] { return admission().paused_meshes() == 1; }))
      << "nothing is made for it";
  grpc::Status beside;
  EXPECT_TRUE(eventually([&] {
    grpc::ClientContext context;
    beside = estimate(ball, context);
    return beside.ok();
  })) << beside.error_message();
  EXPECT_TRUE(held.read_on()) << "and it comes back without asking";
  EXPECT_TRUE(work_stops());
  EXPECT_EQ(admission().paused_meshes(), 0U);
  EXPECT_EQ(admission().running_meshes(), 0U);
}

TEST_F(AdmissionServiceTest, APlanThatTakesLongLeavesItsPlaceToOthers) {
  config_.max_queued = 0;
  restart();
  HeldPlan held(*meshes_);
  ASSERT_TRUE(eventually([&] { return admission().paused_meshes() == 1; }));
  grpc::ClientContext context;
  const grpc::Status beside = estimate(uniform_ball(8), context);
  EXPECT_TRUE(beside.ok()) << beside.error_message();
  EXPECT_EQ(held.let_go(), grpc::StatusCode::CANCELLED);
  EXPECT_TRUE(work_stops());
  EXPECT_EQ(admission().paused_meshes(), 0U);
  EXPECT_EQ(admission().running_meshes(), 0U);
}

TEST_F(AdmissionServiceTest, StreamsThatWaitForTheirReadersAreTheirClientsAffair) {
  config_.max_queued = 0;
  config_.max_client_streams = 2;
  restart();
  const v1::MeshRequest ball = uniform_ball(28);
  HeldStream first(*meshes_, stream_of(ball));
  std::optional<HeldStream> second;
  ASSERT_TRUE(eventually([&] {
    second.emplace(*meshes_, stream_of(ball));
    if (!second->has_chunk()) second->let_go();
    return second->has_chunk();
  }));
  grpc::Status third;
  EXPECT_TRUE(eventually([&] {
    grpc::ClientContext context;
    third = estimate(ball, context);
    EXPECT_FALSE(third.ok());
    return has_detail<google::rpc::QuotaFailure>(third);
  })) << third.error_message();
  first.let_go();
  EXPECT_TRUE(eventually([&] { return admission().paused_meshes() == 1; }));
  EXPECT_TRUE(eventually([&] {
    grpc::ClientContext context;
    return estimate(ball, context).ok();
  }));
  second->let_go();
}

TEST_F(AdmissionServiceTest, AClientOverItsOwnQuotaIsToldSo) {
  config_.max_client_uploads = 1;
  config_.max_client_upload_bytes = 1000;
  restart();
  OpenUpload first(*grids_, grid_name_of("first"), 600);
  EXPECT_TRUE(upload_begins(grid_name_of("first")));
  const grpc::Status one_too_many = OpenUpload(*grids_, grid_name_of("second"), 600).wait();
  EXPECT_EQ(one_too_many.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(has_detail<google::rpc::QuotaFailure>(one_too_many));
  EXPECT_THAT(one_too_many.error_message(), HasSubstr("2 is over the limit of 1"));
  first.send(std::string(100, 'a'));
  EXPECT_TRUE(first.finish().ok());

  // What is left of an upload goes on counting.
  const grpc::Status too_large = OpenUpload(*grids_, grid_name_of("third"), 901).wait();
  EXPECT_TRUE(has_detail<google::rpc::QuotaFailure>(too_large));
  EXPECT_THAT(too_large.error_message(), HasSubstr("1001 is over the limit of 1000"));
  const std::string rest(900, 'd');
  EXPECT_TRUE(upload_text(*grids_, grid_name_of(rest), rest, 900).response.complete());
}

}  // namespace
}  // namespace tet::test
