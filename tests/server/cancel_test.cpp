// Whoever gives up stops the processor: at whatever moment, in whatever stage.
#include <ctime>
#include <iostream>
#include <random>

#include <gtest/gtest.h>

#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

std::chrono::nanoseconds processor_time() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

class CancelTest : public ServiceTest {
 protected:
  CancelTest() { start(); }

  std::vector<v1::MeshRequest> long_requests() {
    v1::MeshRequest graded = mesh_of(ball_file(28));
    graded.set_spacing(1.0 / 400);
    v1::MeshRequest uniform = graded;
    uniform.set_spacing(1.0 / 160);
    uniform.set_levels(0);
    v1::MeshRequest improved = graded;
    improved.set_spacing(1.0 / 80);
    improved.set_improve(true);
    v1::MeshRequest manifold = graded;
    manifold.set_manifold(true);
    return {graded, uniform, improved, manifold};
  }

  /// What the processors do until nothing of any mesh is left to do: other processes may have
  /// them for as long as they like.
  std::chrono::milliseconds work_until_idle() {
    const std::chrono::nanoseconds before = processor_time();
    EXPECT_TRUE(work_stops());
    EXPECT_TRUE(eventually([&] { return server_->engine().planner.running() == 0; }));
    return std::chrono::duration_cast<std::chrono::milliseconds>(processor_time() - before);
  }
};

TEST_F(CancelTest, TheProcessorHasLittleLeftToDo) {
  const unsigned seed = std::random_device{}();
  std::cerr << "seed " << seed << "\n";
  std::mt19937 random(seed);
  const std::vector<v1::MeshRequest> requests = long_requests();
  std::chrono::milliseconds most{0};
  for (int round = 0; round < 12; ++round) {
    v1::MeshRequest mesh = requests[static_cast<std::size_t>(round) % requests.size()];
    mesh.set_spacing(mesh.spacing() * (1 + 1e-9 * round));  // not remembered
    const std::chrono::milliseconds after(random() % 1500);
    grpc::ClientContext context;
    const bool by_deadline = round % 3 == 2;
    if (by_deadline) context.set_deadline(std::chrono::system_clock::now() + after);
    const auto reader = meshes_->StreamMesh(&context, stream_of(mesh));
    std::this_thread::sleep_for(after);
    if (!by_deadline) context.TryCancel();
    const auto rest = work_until_idle();
    reader->Finish();
    std::cerr << "request " << round % 4 << " ended after " << after.count() << " ms: another "
              << rest.count() << " ms of processors' time\n";
    most = std::max(most, rest);
  }
  EXPECT_LT(most, 2s);
}

}  // namespace
}  // namespace tet::test
