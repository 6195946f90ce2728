#include <chrono>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "client/library/client_call.h"
#include "client/library/connection.h"
#include "client/library/job_client.h"
#include "client/library/remesh_session.h"
#include "google/rpc/error_details.pb.h"
#include "proto/convert/status.h"
#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

constexpr RetryPolicy kQuick{
    .attempts = 3, .attempts_once_known = 5, .first_backoff_ms = 1, .max_backoff_ms = 2};

absl::Status with_delay(absl::Status status, std::int64_t milliseconds) {
  google::rpc::RetryInfo info;
  info.mutable_retry_delay()->set_seconds(milliseconds / 1000);
  info.mutable_retry_delay()->set_nanos(static_cast<int>(milliseconds % 1000) * 1'000'000);
  status.SetPayload("type.googleapis.com/google.rpc.RetryInfo",
                    absl::Cord(info.SerializeAsString()));
  return status;
}

/// As long as any server may ask for.
constexpr std::chrono::seconds kLongWait{30};

absl::Status busy_for_long() {
  return with_delay(absl::UnavailableError("busy"),
                    std::chrono::milliseconds(kLongWait).count());
}

class RetriesTest : public testing::Test {
 protected:
  int attempts(const absl::Status& status, RetryHint hint) {
    Retries retries(kQuick, never_);
    int attempts = 1;
    while (retries.again(status, 0, nowhere_, hint).ok()) ++attempts;
    return attempts;
  }

  std::chrono::steady_clock::duration first_wait(const absl::Status& status,
                                                 const Cancellation& cancellation,
                                                 RetryHint hint) {
    Retries retries(kQuick, cancellation);
    const auto start = std::chrono::steady_clock::now();
    retries.again(status, 0, nowhere_, hint).IgnoreError();
    return std::chrono::steady_clock::now() - start;
  }

  const ServerChannel nowhere_ = open_channel("127.0.0.1:1");
  Cancellation never_;
};

TEST_F(RetriesTest, TakeUpWhatBrokeAndWhatTheServerAsksTo) {
  EXPECT_EQ(attempts(absl::UnavailableError("gone"), {}), 3);
  EXPECT_EQ(attempts(absl::ResourceExhaustedError("too large"), {}), 1);
  EXPECT_EQ(attempts(with_delay(absl::ResourceExhaustedError("busy"), 1), {}), 3);
}

/// What a broken call had sent was still being taken when the server was asked how far it came.
TEST_F(RetriesTest, TakeUpAnUploadThatGoesOnElsewhereThanTheServerSaid) {
  const absl::Status elsewhere = absl::OutOfRangeError("offset 1 is not the committed size 2");
  EXPECT_EQ(attempts(with_reason(elsewhere, "WRONG_OFFSET"), {}), 3);
  EXPECT_EQ(attempts(with_reason(elsewhere, "CHUNK_RANGE"), {}), 1);
}

TEST_F(RetriesTest, AreMorePatientWithAServerThatAnsweredBefore) {
  EXPECT_EQ(attempts(absl::UnavailableError("gone"), {.known = true}), 5);
}

TEST_F(RetriesTest, WaitAsLongAsTheServerAsksUnlessItIsAnothersTurn) {
  EXPECT_GE(first_wait(with_delay(absl::UnavailableError("busy"), 200), never_, {}), 200ms);
  EXPECT_LT(first_wait(busy_for_long(), never_, {.elsewhere = true}), kLongWait);
}

TEST_F(RetriesTest, EndWithTheDeadline) {
  const Cancellation soon(std::chrono::system_clock::now() + 50ms);
  EXPECT_LT(first_wait(busy_for_long(), soon, {}), kLongWait);
}

TEST_F(RetriesTest, SayThatTheDeadlinePassedOrTheCallWasCancelledWhileTheyWaited) {
  const Cancellation soon(std::chrono::system_clock::now() + 50ms);
  Retries late(kQuick, soon);
  EXPECT_TRUE(absl::IsDeadlineExceeded(late.again(busy_for_long(), 0, nowhere_, {})));
  Cancellation stopped;
  stopped.cancel();
  Retries given_up(kQuick, stopped);
  EXPECT_TRUE(absl::IsCancelled(given_up.again(busy_for_long(), 0, nowhere_, {})));
  Retries refused(kQuick, stopped);
  EXPECT_TRUE(
      absl::IsNotFound(refused.again(absl::NotFoundError("no such job"), 0, nowhere_, {})));
}

/// An attempt at a server that nobody has started fails at once, so that the deadline comes
/// between two of them.
TEST_F(RetriesTest, TellOfTheDeadlineWhateverIsCalled) {
  const RetryPolicy slow{.attempts = 1000,
                         .attempts_once_known = 1000,
                         .first_backoff_ms = 60'000,
                         .max_backoff_ms = 60'000};
  const auto connection = *Connection::open("127.0.0.1:1", {}, slow);
  MeshClient meshes(connection);
  JobClient jobs(connection);
  const std::vector<WorldPoint> points(1);
  const std::vector<std::function<absl::Status(const Cancellation&)>> calls{
      [&](const Cancellation& soon) { return meshes.capabilities(soon).status(); },
      [&](const Cancellation& soon) { return meshes.stream_mesh({}, {}, soon).status(); },
      [&](const Cancellation& soon) {
        return meshes.sample_points({}, points, {}, soon).status();
      },
      [&](const Cancellation& soon) {
        return meshes.begin_session({}, soon, SessionIds::kInOrder).status();
      },
      [&](const Cancellation& soon) {
        return jobs.watch(
            "", 0, [](const v1::JobEvent&) { return true; }, soon);
      }};
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const Cancellation soon(std::chrono::system_clock::now() + 100ms);
    const absl::Status status = calls[i](soon);
    EXPECT_TRUE(absl::IsDeadlineExceeded(status)) << i << ": " << status;
  }
}

TEST_F(ServiceTest, AClientOfSeveralServersUsesOneThatIsThere) {
  start();
  const auto client = MeshClient::connect("127.0.0.1:1," + server_->address(), kQuick);
  const auto answer = client->capabilities(never_);
  EXPECT_TRUE(answer.ok()) << answer.status();
}

}  // namespace
}  // namespace tet::test
