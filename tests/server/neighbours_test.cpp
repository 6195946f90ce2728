// Clients beside one whose requests cost little to send and much to answer.
#include <atomic>
#include <future>
#include <list>
#include <string>

#include <gtest/gtest.h>

#include "core/base/thread_time.h"
#include "tests/server/service_fixture.h"
#include "tests/server/token_book.h"

namespace tet::test {
namespace {

constexpr int kGreedyCalls = 10;

/// Estimates under way.
class Estimates {
 public:
  void ask(v1::MeshService::Stub& stub, const v1::MeshRequest& mesh, const std::string& token) {
    Call& call = calls_.emplace_back();
    call.context.AddMetadata("authorization", "Bearer " + token);
    *call.request.mutable_mesh() = mesh;
    stub.async()->EstimateMesh(
        &call.context, &call.request, &call.response,
        [&call](const grpc::Status& status) { call.end.set_value(status.error_code()); });
  }

  int ended() const {
    int count = 0;
    for (const Call& call : calls_) {
      count +=
          call.ended.wait_for(std::chrono::seconds(0)) == std::future_status::ready ? 1 : 0;
    }
    return count;
  }

  /// Returns once all have ended.
  void cancel() {
    for (Call& call : calls_) call.context.TryCancel();
    for (const Call& call : calls_) call.ended.wait();
  }

 private:
  struct Call {
    grpc::ClientContext context;
    v1::EstimateMeshRequest request;
    v1::MeshHeader response;
    std::promise<grpc::StatusCode> end;
    std::future<grpc::StatusCode> ended = end.get_future();
  };
  std::list<Call> calls_;
};

class NeighboursTest : public ServiceTest {
 protected:
  NeighboursTest() {
    config_.tokens = tokens_.file();
    for (const char* name : {"greedy", "modest"}) tokens_.add(name, kScopes, "shared");
    start();
    ChannelOptions options;
    options.token = "secret-of-modest";
    client_ = *MeshClient::connect(server_->address(), options);
  }

  /// While one client asks ten times for what takes minutes, the other gets its mesh.
  void expect_room_beside(const v1::MeshRequest& greedy) {
    const v1::MeshRequest modest = mesh_of(ball_file(8));
    Estimates estimates;
    for (int i = 0; i < kGreedyCalls; ++i) {
      v1::MeshRequest asked = greedy;
      asked.set_spacing(greedy.spacing() * (1 + 1e-6 * i));  // none is remembered
      estimates.ask(*meshes_, asked, "secret-of-greedy");
    }
    EXPECT_TRUE(eventually([&] { return server_->engine().planner.running() > 0; }));
    for (int i = 0; i < 3; ++i) {
      v1::MeshRequest mesh = modest;
      mesh.set_spacing(0.2 + 0.01 * i);
      const auto made = client_->stream_mesh(mesh, {}, never_);
      EXPECT_TRUE(made.ok()) << made.status();
    }
    EXPECT_LT(estimates.ended(), kGreedyCalls);
    estimates.cancel();
    EXPECT_TRUE(work_stops());
    EXPECT_TRUE(eventually([&] { return server_->engine().planner.running() == 0; }));
  }

  static constexpr char kScopes[] = "\"grids.read\", \"grids.write\", \"mesh\"";
  TokenBook tokens_{folder_};
};

TEST_F(NeighboursTest, OfAThousandRepeatedEllipsoids) {
  v1::MeshRequest request;
  v1::SceneNode& grain = *request.mutable_scene()->add_nodes();
  grain.set_name("grain");
  for (const double semi_axis : {1.0, 0.7, 0.5}) {
    grain.mutable_ellipsoid()->add_semi_axes(semi_axis);
  }
  v1::Repeat& grains = *request.mutable_scene()->add_nodes()->mutable_repeat();
  grains.set_of("grain");
  for (const int count : {16, 16, 8}) grains.add_count(count);
  for (const double step : {1.9, 1.3, 0.9}) grains.add_step(step);
  request.set_spacing(0.24);  // about a 128th of the whole: it looks cheap
  expect_room_beside(request);
}

TEST_F(NeighboursTest, OfASmallGridAtASmallPartOfItsVoxels) {
  v1::MeshRequest request = mesh_of(ball_file(8));
  request.set_spacing(1.0 / 8 / 20);
  expect_room_beside(request);
}

// What came before its plan waited for all tasks that were posted before, whosever they were.
TEST_F(NeighboursTest, OfThousandsOfShortTasksWaitsForAFewOfThem) {
  constexpr int kTasks = 100'000;  // more than are done while a thread stands still
  FairTasks& tasks = const_cast<MeshEngine&>(server_->engine()).short_tasks;
  std::atomic<int> done{0};
  std::atomic<bool> over{false};
  for (int i = 0; i < kTasks; ++i) {
    tasks.post("greedy", [&] {
      const auto begin = thread_time();
      while (!over && thread_time() - begin < 1ms) {
      }
      done.fetch_add(1);
    });
  }
  v1::MeshRequest request;
  request.mutable_scene()->add_nodes()->mutable_sphere()->set_radius(1);
  request.set_spacing(0.2);
  const auto made = client_->stream_mesh(request, {}, never_);
  const int before = done;
  over = true;
  EXPECT_TRUE(made.ok()) << made.status();
  EXPECT_LT(before, kTasks / 2);
  EXPECT_TRUE(eventually([&] { return done == kTasks; }));
}

}  // namespace
}  // namespace tet::test
