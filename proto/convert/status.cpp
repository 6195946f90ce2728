#include "proto/convert/status.h"

#include <algorithm>
#include <string>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/failure_name.h"
#include "core/base/printable.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace tet {

namespace {

constexpr char kDomain[] = "tetstream";
constexpr char kErrorInfoUrl[] = "type.googleapis.com/google.rpc.ErrorInfo";
constexpr char kRetryInfoUrl[] = "type.googleapis.com/google.rpc.RetryInfo";
constexpr char kQuotaFailureUrl[] = "type.googleapis.com/google.rpc.QuotaFailure";
constexpr char kBadRequestUrl[] = "type.googleapis.com/google.rpc.BadRequest";

constexpr std::size_t kMaxMessage = 600;
constexpr std::size_t kMaxField = 120;

google::rpc::ErrorInfo error_info(std::string reason) {
  google::rpc::ErrorInfo info;
  info.set_reason(std::move(reason));
  info.set_domain(kDomain);
  return info;
}

void add_detail(google::rpc::Status& rpc, std::string url, std::string bytes) {
  auto* detail = rpc.add_details();
  detail->set_type_url(std::move(url));
  detail->set_value(std::move(bytes));
}

void set_violation(const std::string& field, const std::string& message, absl::Status& status) {
  google::rpc::BadRequest bad;
  bad.add_field_violations()->set_field(printable(field, kMaxField));
  bad.mutable_field_violations(0)->set_description(printable(message, kMaxField));
  status.SetPayload(kBadRequestUrl, absl::Cord(bad.SerializeAsString()));
}

/// Within the limit whatever the details are: the first one, the ErrorInfo, always stays.
void fit(google::rpc::Status& rpc) {
  while (rpc.ByteSizeLong() > kMaxStatusBytes && rpc.details_size() > 1) {
    rpc.mutable_details()->RemoveLast();
  }
  if (rpc.ByteSizeLong() <= kMaxStatusBytes) return;
  const std::size_t excess = rpc.ByteSizeLong() - kMaxStatusBytes;
  rpc.mutable_message()->resize(rpc.message().size() - std::min(rpc.message().size(), excess));
}

}  // namespace

absl::Status with_reason(absl::Status status, std::string_view reason) {
  status.SetPayload(kErrorInfoUrl,
                    absl::Cord(error_info(std::string(reason)).SerializeAsString()));
  return status;
}

bool has_reason(const absl::Status& status) {
  return status.GetPayload(kErrorInfoUrl).has_value() || !failure_name(status).empty();
}

std::string reason_of(const absl::Status& status) {
  if (status.ok()) return "";
  google::rpc::ErrorInfo info;
  const auto payload = status.GetPayload(kErrorInfoUrl);
  if (payload && info.ParseFromString(std::string(*payload))) return info.reason();
  if (std::string name = failure_name(status); !name.empty()) return name;
  return absl::StatusCodeToString(status.code());
}

absl::Status invalid_field(const std::string& message) {
  absl::Status status = with_reason(absl::InvalidArgumentError(message), "INVALID_FIELD");
  set_violation(message.substr(0, message.find(' ')), message, status);
  return status;
}

absl::Status with_field(absl::Status status, const std::string& field) {
  set_violation(field, std::string(status.message()), status);
  return status;
}

absl::Status within_field(std::string_view outer, const absl::Status& status) {
  google::rpc::BadRequest bad;
  const auto payload = status.GetPayload(kBadRequestUrl);
  if (!payload || !bad.ParseFromString(std::string(*payload))) return status;
  absl::Status inner = status;
  const auto& violation = bad.field_violations(0);
  set_violation(std::string(outer) + "." + violation.field(), violation.description(), inner);
  return inner;
}

absl::Status with_retry(absl::Status status, absl::Duration delay) {
  google::rpc::RetryInfo retry;
  const std::int64_t seconds = absl::IDivDuration(delay, absl::Seconds(1), &delay);
  retry.mutable_retry_delay()->set_seconds(seconds);
  retry.mutable_retry_delay()->set_nanos(static_cast<int>(absl::ToInt64Nanoseconds(delay)));
  status.SetPayload(kRetryInfoUrl, absl::Cord(retry.SerializeAsString()));
  return status;
}

bool has_retry(const absl::Status& status) {
  return status.GetPayload(kRetryInfoUrl).has_value();
}

absl::Status over_limit(std::string_view what,
                        std::uint64_t value,
                        std::uint64_t limit,
                        std::string_view reason) {
  absl::Status status = absl::ResourceExhaustedError(
      absl::StrFormat("%s: %d is over the limit of %d", what, value, limit));
  google::rpc::ErrorInfo info = error_info(std::string(reason));
  (*info.mutable_metadata())["what"] = printable(what, kMaxField);
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
  violation.set_subject(subject);
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
  return with_quota(status, absl::StrCat("client:", client), std::string(status.message()));
}

absl::Status over_space_quota(const std::string& space,
                              const std::string& what,
                              std::uint64_t value,
                              std::uint64_t limit) {
  const std::string of_one = absl::StrCat(what, " of one namespace");
  const absl::Status status = over_limit(of_one, value, limit, "QUOTA_EXCEEDED");
  return with_quota(status, absl::StrCat("namespace:", space), std::string(status.message()));
}

grpc::Status to_grpc(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  google::rpc::Status rpc;
  rpc.set_code(static_cast<int>(status.code()));
  rpc.set_message(printable(std::string(status.message()), kMaxMessage));
  const auto info = status.GetPayload(kErrorInfoUrl);
  add_detail(rpc, kErrorInfoUrl,
             info ? std::string(*info) : error_info(reason_of(status)).SerializeAsString());
  status.ForEachPayload([&](absl::string_view url, const absl::Cord& bytes) {
    if (url == kErrorInfoUrl || url == kFailureNameUrl) return;
    add_detail(rpc, std::string(url), std::string(bytes));
  });
  fit(rpc);
  return {static_cast<grpc::StatusCode>(status.code()), rpc.message(), rpc.SerializeAsString()};
}

}  // namespace tet
