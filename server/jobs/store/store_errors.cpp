#include "server/jobs/store/store_errors.h"

#include <absl/strings/str_cat.h>

#include "google/rpc/status.pb.h"
#include "proto/convert/status.h"

namespace tet {

namespace {

constexpr int kLastCode = static_cast<int>(absl::StatusCode::kUnauthenticated);

}  // namespace

absl::Status store_unavailable(const std::string& message) {
  return with_retry(with_reason(absl::UnavailableError(message), "JOB_STORE_UNAVAILABLE"),
                    absl::Seconds(1));
}

absl::Status store_full(const std::string& message) {
  return with_reason(absl::ResourceExhaustedError(message), "JOB_STORE_FULL");
}

absl::Status store_broken(const std::string& message) {
  return with_reason(absl::InternalError(message), "JOB_STORE_BROKEN");
}

bool will_pass(const absl::Status& status) {
  const std::string reason = reason_of(status);
  return reason == "JOB_STORE_UNAVAILABLE" || reason == "JOB_STORE_FULL";
}

absl::Status job_not_found(const std::string& id) {
  return with_reason(absl::NotFoundError(absl::StrCat("there is no job ", id)),
                     "JOB_NOT_FOUND");
}

absl::Status lease_lost(const std::string& message) {
  return with_reason(absl::AbortedError(message), "LEASE_LOST");
}

std::string encode_status(const absl::Status& status) {
  return status.ok() ? std::string() : to_grpc(status).error_details();
}

absl::Status decode_status(const std::string& bytes) {
  google::rpc::Status rpc;
  if (!rpc.ParseFromString(bytes)) return store_broken("a stored error cannot be read");
  const bool known = rpc.code() >= 0 && rpc.code() <= kLastCode;
  absl::Status status(
      known ? static_cast<absl::StatusCode>(rpc.code()) : absl::StatusCode::kUnknown,
      std::string(rpc.message()));
  for (const auto& detail : rpc.details()) {
    status.SetPayload(detail.type_url(), absl::Cord(detail.value()));
  }
  return status;
}

}  // namespace tet
