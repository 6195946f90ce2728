#include "server/meshing/plan_cache.h"

#include <algorithm>
#include <cstddef>

#include <absl/time/time.h>

#include "proto/convert/status.h"

namespace tet {

namespace {

// Enough for the streams that are likely to come back; each may hold a volume in memory,
// and the positions of an improved mesh.
constexpr std::size_t kRecentPlans = 4;
constexpr absl::Duration kRetryDelay = absl::Seconds(1);
constexpr char kWhat[] = "bytes of counted meshes in memory";

}  // namespace

PlanCache::PlanCache(std::uint64_t budget_bytes)
    : budget_bytes_(budget_bytes), alive_(std::make_shared<std::atomic<std::uint64_t>>(0)) {}

PlanCache::Plan PlanCache::recall(const std::string& name) {
  const std::lock_guard lock(mutex_);
  return find(name);
}

absl::StatusOr<PlanCache::Plan> PlanCache::remember(const std::string& name, Plan plan) {
  const std::lock_guard lock(mutex_);
  if (Plan made = find(name)) return made;
  if (auto status = make_room(plan->bytes(), kRecentPlans - 1, kWhat); !status.ok())
    return status;
  recent_.emplace_front(name, counted(std::move(plan)));
  return recent_.front().second;
}

absl::StatusOr<PlanCache::Plan> PlanCache::admit(Plan plan) {
  const std::lock_guard lock(mutex_);
  if (auto status = make_room(plan->bytes(), kRecentPlans, kWhat); !status.ok()) return status;
  return counted(std::move(plan));
}

/// Lets go of what is held, until there is room and no more than so many are left.
absl::Status PlanCache::make_room(std::uint64_t bytes,
                                  std::size_t most_held,
                                  std::string_view what) {
  if (bytes > budget_bytes_) return over_limit(what, bytes, budget_bytes_);
  while (!recent_.empty() && (*alive_ + bytes > budget_bytes_ || recent_.size() > most_held)) {
    recent_.pop_back();
  }
  if (*alive_ + bytes <= budget_bytes_) return absl::OkStatus();
  refused_.note();
  return with_retry(over_limit(what, *alive_ + bytes, budget_bytes_, "SERVER_BUSY"),
                    kRetryDelay);
}

absl::StatusOr<std::shared_ptr<const void>> PlanCache::reserve(std::uint64_t bytes,
                                                               std::string_view what) {
  struct Reserved {
    std::uint64_t bytes;
    std::shared_ptr<std::atomic<std::uint64_t>> total;
    ~Reserved() { *total -= bytes; }
  };
  const std::lock_guard lock(mutex_);
  if (auto status = make_room(bytes, kRecentPlans, what); !status.ok()) return status;
  *alive_ += bytes;
  return std::shared_ptr<const void>(new Reserved{bytes, alive_},
                                     [](const Reserved* reserved) { delete reserved; });
}

void PlanCache::forget() {
  const std::lock_guard lock(mutex_);
  recent_.clear();
}

PlanCache::Plan PlanCache::find(const std::string& name) {
  const auto found = std::find_if(recent_.begin(), recent_.end(),
                                  [&](const NamedPlan& plan) { return plan.first == name; });
  if (found == recent_.end()) return nullptr;
  recent_.splice(recent_.begin(), recent_, found);
  return recent_.front().second;
}

/// The plan, whose bytes count for as long as anyone has it.
PlanCache::Plan PlanCache::counted(Plan plan) {
  struct Alive {
    Plan plan;
    std::uint64_t bytes;
    std::shared_ptr<std::atomic<std::uint64_t>> total;
    ~Alive() { *total -= bytes; }
  };
  const std::uint64_t bytes = plan->bytes();
  *alive_ += bytes;
  const MeshPlan* counted = plan.get();
  auto alive = std::shared_ptr<Alive>(new Alive{std::move(plan), bytes, alive_});
  return {std::move(alive), counted};
}

}  // namespace tet
