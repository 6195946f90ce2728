#include "server/jobs/work/quarantine.h"

#include <algorithm>

namespace tet {

namespace {

constexpr int kMostDoublings = 20;

}  // namespace

bool Quarantine::enter(const absl::Status& why) {
  const std::lock_guard lock(mutex_);
  const bool was_free = trouble_.ok();
  trouble_ = why;
  failures_ = std::min(failures_ + 1, kMostDoublings);
  if (was_free) ++count_;
  return was_free;
}

bool Quarantine::leave() {
  const std::lock_guard lock(mutex_);
  const bool was_in = !trouble_.ok();
  trouble_ = absl::OkStatus();
  return was_in;
}

void Quarantine::worked() {
  const std::lock_guard lock(mutex_);
  if (trouble_.ok()) failures_ = 0;
}

absl::Status Quarantine::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

absl::Duration Quarantine::pause() const {
  const std::lock_guard lock(mutex_);
  const int doublings = std::max(failures_ - 1, 0);
  return std::min(kFirstPause * (std::int64_t{1} << doublings), kLongestPause);
}

std::int64_t Quarantine::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

}  // namespace tet
