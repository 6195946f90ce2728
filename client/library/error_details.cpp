#include "client/library/error_details.h"

#include "google/rpc/error_details.pb.h"

namespace tet {

namespace {

template <class Detail>
std::string url_of() {
  return "type.googleapis.com/" + Detail::descriptor()->full_name();
}

template <class Detail>
std::optional<Detail> find_detail(const absl::Status& status) {
  Detail detail;
  const auto payload = status.GetPayload(url_of<Detail>());
  if (!payload || !detail.ParseFromString(std::string(*payload))) return std::nullopt;
  return detail;
}

void add_request_id(const grpc::ClientContext& context, absl::Status& status) {
  const auto& metadata = context.GetServerTrailingMetadata();
  const auto found = metadata.find("x-request-id");
  if (found == metadata.end()) return;
  google::rpc::RequestInfo info;
  info.set_request_id(std::string(found->second.data(), found->second.size()));
  status.SetPayload(url_of<google::rpc::RequestInfo>(), absl::Cord(info.SerializeAsString()));
}

template <class Message>
void add_details(const Message& from, absl::Status& status) {
  for (const auto& detail : from.details()) {
    status.SetPayload(detail.type_url(), absl::Cord(detail.value()));
  }
}

/// Reads a message that has the fields of a google.rpc.Status.
template <class Message>
absl::Status status_in(const Message& message) {
  absl::Status status(static_cast<absl::StatusCode>(message.code()), message.message());
  if (!status.ok()) add_details(message, status);
  return status;
}

}  // namespace

absl::Status to_absl(const google::rpc::Status& status) { return status_in(status); }

absl::Status to_absl(const tetstream::v1::FrameRefusal& refusal) { return status_in(refusal); }

absl::Status to_absl(const grpc::Status& status, const grpc::ClientContext& context) {
  absl::Status ours(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
  if (ours.ok()) return ours;
  google::rpc::Status details;
  if (details.ParseFromString(status.error_details())) add_details(details, ours);
  add_request_id(context, ours);
  return ours;
}

std::string reason_of_failure(const absl::Status& status) {
  const auto info = find_detail<google::rpc::ErrorInfo>(status);
  return info ? info->reason() : "";
}

std::optional<absl::Duration> retry_delay(const absl::Status& status) {
  const auto info = find_detail<google::rpc::RetryInfo>(status);
  if (!info) return std::nullopt;
  return absl::Seconds(info->retry_delay().seconds()) +
         absl::Nanoseconds(info->retry_delay().nanos());
}

std::string field_of_failure(const absl::Status& status) {
  const auto bad = find_detail<google::rpc::BadRequest>(status);
  return bad && !bad->field_violations().empty() ? bad->field_violations(0).field() : "";
}

std::string metadata_of(const absl::Status& status, const std::string& key) {
  const auto info = find_detail<google::rpc::ErrorInfo>(status);
  if (!info) return "";
  const auto found = info->metadata().find(key);
  return found == info->metadata().end() ? "" : found->second;
}

std::string request_id_of(const absl::Status& status) {
  const auto info = find_detail<google::rpc::RequestInfo>(status);
  return info ? info->request_id() : "";
}

}  // namespace tet
