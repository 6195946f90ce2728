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

/// How long it takes until the process does next to nothing for 40 ms.
std::chrono::milliseconds time_until_idle() {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  auto idle_since = start;
  for (auto used = processor_time(); Clock::now() - start < 10s;) {
    std::this_thread::sleep_for(20ms);
    const auto now_used = processor_time();
    if (now_used - used > 5ms) idle_since = Clock::now();
    used = now_used;
    if (Clock::now() - idle_since >= 40ms) break;
  }
  return std::chrono::duration_cast<std::chrono::milliseconds>(idle_since - start);
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
};

TEST_F(CancelTest, TheProcessorStandsStillSoonAfterwards) {
  const unsigned seed = std::random_device{}();
  std::cerr << "seed " << seed << "\n";
  std::mt19937 random(seed);
  const std::vector<v1::MeshRequest> requests = long_requests();
  std::chrono::milliseconds longest{0};
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
    const auto idle = time_until_idle();
    reader->Finish();
    std::cerr << "request " << round % 4 << " ended after " << after.count() << " ms: idle in "
              << idle.count() << " ms\n";
    longest = std::max(longest, idle);
  }
  EXPECT_LT(longest, 2s) << "generous: other processes may have the cores";
  EXPECT_TRUE(work_stops());
}

}  // namespace
}  // namespace tet::test
