#include "server/status.h"

#include <string>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace tet {

namespace {

constexpr char kDomain[] = "tetstream";
constexpr char kErrorInfoUrl[] = "type.googleapis.com/google.rpc.ErrorInfo";
constexpr char kRetryInfoUrl[] = "type.googleapis.com/google.rpc.RetryInfo";
constexpr char kQuotaFailureUrl[] = "type.googleapis.com/google.rpc.QuotaFailure";

google::rpc::ErrorInfo error_info(std::string reason) {
  google::rpc::ErrorInfo info;
  info.set_reason(std::move(reason));
  info.set_domain(kDomain);
  return info;
}

void add_detail(google::rpc::Status& rpc, std::string url, const absl::Cord& bytes) {
  auto* detail = rpc.add_details();
  detail->set_type_url(std::move(url));
  detail->set_value(std::string(bytes));
}

}  // namespace

absl::Status with_reason(absl::Status status, std::string_view reason) {
  status.SetPayload(kErrorInfoUrl,
                    absl::Cord(error_info(std::string(reason)).SerializeAsString()));
  return status;
}

absl::Status invalid_field(const std::string& message) {
  return with_reason(absl::InvalidArgumentError(message), "INVALID_FIELD");
}

absl::Status with_retry(absl::Status status, absl::Duration delay) {
  google::rpc::RetryInfo retry;
  const std::int64_t seconds = absl::IDivDuration(delay, absl::Seconds(1), &delay);
  retry.mutable_retry_delay()->set_seconds(seconds);
  retry.mutable_retry_delay()->set_nanos(static_cast<int>(absl::ToInt64Nanoseconds(delay)));
  status.SetPayload(kRetryInfoUrl, absl::Cord(retry.SerializeAsString()));
  return status;
}

absl::Status over_limit(std::string_view what,
                        std::uint64_t value,
                        std::uint64_t limit,
                        std::string_view reason) {
  absl::Status status = absl::ResourceExhaustedError(
      absl::StrFormat("%s: %d is over the limit of %d", what, value, limit));
  google::rpc::ErrorInfo info = error_info(std::string(reason));
  (*info.mutable_metadata())["what"] = std::string(what);
  (*info.mutable_metadata())["value"] = absl::StrCat(value);
  (*info.mutable_metadata())["limit"] = absl::StrCat(limit);
  status.SetPayload(kErrorInfoUrl, absl::Cord(info.SerializeAsString()));
  return status;
}

absl::Status with_quota(absl::Status status,
                        const std::string& subject,
                        const std::string& description) {
  google::rpc::QuotaFailure failure;
  google::rpc::QuotaFailure::Violation& violation = *failure.add_violations();
  violation.set_subject(absl::StrCat("client:", subject));
  violation.set_description(description);
  status.SetPayload(kQuotaFailureUrl, absl::Cord(failure.SerializeAsString()));
  return status;
}

absl::Status over_quota(const std::string& client,
                        const std::string& what,
                        std::uint64_t value,
                        std::uint64_t limit) {
  const std::string of_one = absl::StrCat(what, " of one client");
  const absl::Status status = over_limit(of_one, value, limit, "QUOTA_EXCEEDED");
  return with_quota(status, client, std::string(status.message()));
}

grpc::Status to_grpc(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  google::rpc::Status rpc;
  rpc.set_code(static_cast<int>(status.code()));
  rpc.set_message(std::string(status.message()));
  if (!status.GetPayload(kErrorInfoUrl)) {
    const auto info = error_info(absl::StatusCodeToString(status.code()));
    add_detail(rpc, kErrorInfoUrl, absl::Cord(info.SerializeAsString()));
  }
  status.ForEachPayload([&](absl::string_view url, const absl::Cord& bytes) {
    add_detail(rpc, std::string(url), bytes);
  });
  return {static_cast<grpc::StatusCode>(status.code()), rpc.message(), rpc.SerializeAsString()};
}

}  // namespace tet
