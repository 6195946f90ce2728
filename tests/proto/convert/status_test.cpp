#include "proto/convert/status.h"

#include <gtest/gtest.h>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace tet {
namespace {

google::rpc::Status details_of(const absl::Status& status) {
  google::rpc::Status rpc;
  EXPECT_TRUE(rpc.ParseFromString(to_grpc(status).error_details()));
  return rpc;
}

template <class Detail>
Detail find_detail(const absl::Status& status) {
  Detail found;
  const google::rpc::Status rpc = details_of(status);
  for (const auto& detail : rpc.details()) {
    if (detail.Is<Detail>()) detail.UnpackTo(&found);
  }
  return found;
}

TEST(Status, KeepsCodeAndMessage) {
  const grpc::Status status = to_grpc(absl::NotFoundError("no such grid"));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(status.error_message(), "no such grid");
}

TEST(Status, AlwaysSaysAReason) {
  const auto info = find_detail<google::rpc::ErrorInfo>(absl::NotFoundError("no such grid"));
  EXPECT_EQ(info.reason(), "NOT_FOUND");
  EXPECT_EQ(info.domain(), "tetstream");
}

TEST(Status, SaysWhoseQuotaWasUsedUp) {
  const absl::Status status = over_quota("10.0.0.7", "uploads at once", 3, 2);
  const auto failure = find_detail<google::rpc::QuotaFailure>(status);
  ASSERT_EQ(failure.violations_size(), 1);
  EXPECT_EQ(failure.violations(0).subject(), "client:10.0.0.7");
  EXPECT_EQ(failure.violations(0).description(),
            "uploads at once of one client: 3 is over the limit of 2");
  EXPECT_EQ(find_detail<google::rpc::ErrorInfo>(status).reason(), "QUOTA_EXCEEDED");
}

TEST(Status, SaysValueAndLimit) {
  const auto info = find_detail<google::rpc::ErrorInfo>(over_limit("tets of one mesh", 12, 10));
  EXPECT_EQ(info.reason(), "LIMIT_EXCEEDED");
  EXPECT_EQ(info.metadata().at("value"), "12");
  EXPECT_EQ(info.metadata().at("limit"), "10");
}

TEST(Status, NamesTheFieldAndWhereItIs) {
  const auto status = within_field("mesh", invalid_field("spacing 0 is not positive"));
  const auto bad = find_detail<google::rpc::BadRequest>(status);
  ASSERT_EQ(bad.field_violations_size(), 1);
  EXPECT_EQ(bad.field_violations(0).field(), "mesh.spacing");
  EXPECT_EQ(reason_of(status), "INVALID_FIELD");
}

TEST(Status, TakesAKilobyteAtMostAndNothingThatIsNotPrintable) {
  const auto status =
      with_retry(over_limit(std::string(5000, 'w') + "\n\x1b[31m\xff", 2, 1), absl::Seconds(1));
  const grpc::Status told = to_grpc(status);
  EXPECT_LE(told.error_details().size(), kMaxStatusBytes);
  EXPECT_EQ(find_detail<google::rpc::ErrorInfo>(status).reason(), "LIMIT_EXCEEDED");
  EXPECT_EQ(find_detail<google::rpc::RetryInfo>(status).retry_delay().seconds(), 1);
  const grpc::Status odd = to_grpc(absl::InternalError("a\nb\x1b[31m\xff"));
  EXPECT_EQ(odd.error_message(), "a?b?[31m?");
}

TEST(Status, SaysWhenToRetry) {
  const auto status = with_retry(absl::AbortedError("busy"), absl::Milliseconds(1500));
  const auto retry = find_detail<google::rpc::RetryInfo>(status);
  EXPECT_EQ(retry.retry_delay().seconds(), 1);
  EXPECT_EQ(retry.retry_delay().nanos(), 500'000'000);
  EXPECT_EQ(details_of(status).details_size(), 2);
}

}  // namespace
}  // namespace tet
