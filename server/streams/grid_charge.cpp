#include "server/streams/grid_charge.h"

#include <absl/time/time.h>

#include "proto/convert/status.h"

namespace tet {

absl::Status GridCharge::add(std::uint64_t bytes) {
  constexpr char kWhat[] = "bytes of sessions' changed grids";
  if (bytes > limit_ || bytes_ > limit_ - bytes) {
    return over_limit(kWhat, bytes_ + bytes, limit_);
  }
  const std::uint64_t all = all_.fetch_add(bytes) + bytes;
  if (all <= limit_) {
    bytes_ += bytes;
    return absl::OkStatus();
  }
  all_.fetch_sub(bytes);
  return with_retry(over_limit(kWhat, all, limit_, "SERVER_BUSY"), absl::Seconds(1));
}

void GridCharge::shrink_to(std::uint64_t bytes) {
  if (bytes >= bytes_) return;
  all_.fetch_sub(bytes_ - bytes);
  bytes_ = bytes;
}

}  // namespace tet
