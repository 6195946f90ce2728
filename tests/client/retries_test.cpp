#include <chrono>

#include <gtest/gtest.h>

#include "client/library/client_call.h"
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
    while (retries.again(status, 0, nowhere_, hint)) ++attempts;
    return attempts;
  }

  std::chrono::steady_clock::duration first_wait(const absl::Status& status,
                                                 const Cancellation& cancellation,
                                                 RetryHint hint) {
    Retries retries(kQuick, cancellation);
    const auto start = std::chrono::steady_clock::now();
    retries.again(status, 0, nowhere_, hint);
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

TEST_F(ServiceTest, AClientOfSeveralServersUsesOneThatIsThere) {
  start();
  const auto client = MeshClient::connect("127.0.0.1:1," + server_->address(), kQuick);
  const auto answer = client->capabilities(never_);
  EXPECT_TRUE(answer.ok()) << answer.status();
}

}  // namespace
}  // namespace tet::test
