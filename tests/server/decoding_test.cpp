// A server whose decoders crash, hang or are missing: what its callers see of it.
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/vdb/hanging_decoder.h"
#include "tests/server/reason_of.h"
#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// What a small file may take by the clock (docs/hostile_input.md).
constexpr std::chrono::seconds kTimeLimit{20};

/// TETSTREAM_TRIALS=1000 build/release/bin/slow_service_test --gtest_filter=Decoding* for a
/// longer run.
int trials() {
  const char* const wanted = std::getenv("TETSTREAM_TRIALS");
  return wanted == nullptr ? 60 : std::atoi(wanted);
}

class DecodingTest : public ServiceTest {
 protected:
  /// Decodes as it should but for grids named "crash" and "hang".
  void start_with_hostile_decoder() {
    config_.decoder = folder_.file("decoder.decode_but_for");
    std::filesystem::create_symlink(HOSTILE_DECODER_PATH, config_.decoder);
    start();
  }

  grpc::Status mesh(v1::MeshRequest request, const std::string& grid = "") {
    request.set_grid_name(grid);
    grpc::ClientContext context;
    const auto reader = meshes_->StreamMesh(&context, stream_of(request));
    for (v1::MeshEvent event; reader->Read(&event);) continue;
    return reader->Finish();
  }

  /// Whether a decode that hangs is ended with its call: before the limit does that.
  bool ends_with_its_call(const v1::MeshRequest& hang) {
    std::filesystem::remove(config_.decoder + kHangs);
    grpc::ClientContext context;
    const auto reader = meshes_->StreamMesh(&context, stream_of(hang));
    const pid_t hanging = hanging_decoder(config_.decoder);
    EXPECT_NE(hanging, 0);
    context.TryCancel();
    const auto start = std::chrono::steady_clock::now();
    const bool cancelled = reader->Finish().error_code() == grpc::StatusCode::CANCELLED;
    EXPECT_TRUE(eventually([&] { return has_ended(hanging); }));
    return cancelled && std::chrono::steady_clock::now() - start < kTimeLimit;
  }

  static grpc::Status expect_reason(const grpc::Status& status, const std::string& reason) {
    EXPECT_EQ(reason_of(status), "tetstream/" + reason) << status.error_message();
    EXPECT_THAT(status.error_message(), Not(HasSubstr("/store/")));
    return status;
  }
};

TEST_F(DecodingTest, CostsTheCrashedRequestAnErrorAndTheOthersNothing) {
  start_with_hostile_decoder();
  const v1::MeshRequest ball = mesh_of(ball_file(8));
  std::atomic<int> crashes{0}, healthy{0}, failed{0};
  std::thread hostile([&] {
    for (; crashes < trials(); ++crashes) expect_reason(mesh(ball, "crash"), "DECODER_CRASHED");
  });
  constexpr int kFiles = 32;  // small ones, each of which is decoded
  int turn = 0;
  do {
    const double voxel = 1 / (9 + 0.25 * (turn++ % kFiles));
    mesh(mesh_of(solid_file("sphere", voxel))).ok() ? ++healthy : ++failed;
  } while (crashes < trials());
  hostile.join();
  std::printf("%d crashes beside %d meshes\n", crashes.load(), healthy.load());
  EXPECT_GT(healthy, 0);
  EXPECT_EQ(failed, 0);
}

TEST_F(DecodingTest, EndsADecodeThatHangs) {
  config_.decode_seconds = 4;
  start_with_hostile_decoder();
  const v1::MeshRequest ball = mesh_of(ball_file(8));
  const grpc::Status status = expect_reason(mesh(ball, "hang"), "DECODER_TIMEOUT");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("longer than 4 s"));
  // On a busy machine that may be too short for a healthy file, too.
  grpc::Status healthy;
  EXPECT_TRUE(eventually([&] {
    healthy = mesh(ball);
    return reason_of(healthy) != "tetstream/DECODER_TIMEOUT";
  }));
  EXPECT_TRUE(healthy.ok()) << healthy.error_message();
}

TEST_F(DecodingTest, EndsADecodeThatNobodyWaitsFor) {
  config_.decoders = 1;
  start_with_hostile_decoder();
  v1::MeshRequest hang = mesh_of(ball_file(8));
  hang.set_grid_name("hang");
  // Where a thread stands still for as long as the limit, that ends it: once is enough.
  EXPECT_TRUE(eventually([&] { return ends_with_its_call(hang) || HasFailure(); }));
  EXPECT_TRUE(mesh(mesh_of(ball_file(9))).ok());  // by the same, only process
}

TEST_F(DecodingTest, MayDecodeAgainWhatTheSystemHasEndedForItsMemory) {
  config_.decoders = 1;
  start_with_hostile_decoder();
  const v1::MeshRequest ball = mesh_of(ball_file(8));
  grpc::Status status;
  std::thread client([&] { status = mesh(ball, "hang"); });
  const pid_t hanging = hanging_decoder(config_.decoder);
  EXPECT_NE(hanging, 0);
  if (hanging != 0) ::kill(hanging, SIGKILL);
  client.join();
  expect_reason(status, "DECODER_MEMORY");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_details(), HasSubstr("google.rpc.RetryInfo"));
  EXPECT_TRUE(mesh(ball).ok());
}

TEST_F(DecodingTest, IsUnavailableWithoutAProgram) {
  config_.decoder = folder_.file("nothing");
  start();
  const v1::MeshRequest ball = mesh_of(ball_file(8));
  const grpc::Status status = expect_reason(mesh(ball), "DECODER_UNAVAILABLE");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE);
  // Our client takes such a call up again, for twenty seconds unless it is told otherwise.
  const auto impatient = MeshClient::connect(
      server_->address(),
      RetryPolicy{.attempts = 2, .attempts_once_known = 2, .first_backoff_ms = 1});
  EXPECT_TRUE(absl::IsUnavailable(impatient->grid_info(ball.name(), never_).status()));
}

}  // namespace
}  // namespace tet::test
