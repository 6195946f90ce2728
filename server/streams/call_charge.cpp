#include "server/streams/call_charge.h"

#include <absl/time/time.h>

#include "proto/convert/status.h"

namespace tet {

absl::Status CallCharge::add(std::uint64_t bytes) {
  if (bytes > limit_ || bytes_ > limit_ - bytes) {
    return over_limit(what_, bytes_ + bytes, limit_);
  }
  const std::uint64_t all = all_.fetch_add(bytes) + bytes;
  if (all <= limit_) {
    bytes_ += bytes;
    return absl::OkStatus();
  }
  all_.fetch_sub(bytes);
  return with_retry(over_limit(what_, all, limit_, "SERVER_BUSY"), absl::Seconds(1));
}

void CallCharge::shrink_to(std::uint64_t bytes) {
  if (bytes >= bytes_) return;
  all_.fetch_sub(bytes_ - bytes);
  bytes_ = bytes;
}

}  // namespace tet
