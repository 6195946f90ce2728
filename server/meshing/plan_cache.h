// Counted meshes in memory: all that are in use, and the last few that were.
#pragma once

#include <atomic>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include <absl/status/statusor.h>

#include "core/plan/mesh_plan.h"
#include "server/ops/last_time.h"

namespace tet {

/// Holds the last few plans, so that a stream that comes back starts at once, and keeps all
/// plans together, held or in use by streams, within a budget.
///
/// Thread safety: any thread may call any member. Plans may outlive the cache.
class PlanCache {
 public:
  using Plan = std::shared_ptr<const MeshPlan>;

  explicit PlanCache(std::uint64_t budget_bytes);

  /// Null when it is not held.
  Plan recall(const std::string& name);

  /// Holds a plan, and lets go of others where room is short. Where somebody else has made the
  /// same plan meanwhile, that one is returned.
  /// Errors: kResourceExhausted (SERVER_BUSY: no room beside the plans in use; LIMIT_EXCEEDED:
  /// not even alone).
  absl::StatusOr<Plan> remember(const std::string& name, Plan plan);

  /// Counts a plan that nobody else will ask for, and does not hold it. Errors: as above.
  absl::StatusOr<Plan> admit(Plan plan);

  /// Counts memory that work on a plan takes, for as long as somebody has what is returned: to
  /// be asked before it is taken. Errors: as above, about `what`.
  absl::StatusOr<std::shared_ptr<const void>> reserve(std::uint64_t bytes,
                                                      std::string_view what);

  void forget();

  std::uint64_t budget_bytes() const noexcept { return budget_bytes_; }
  /// Whether a plan was refused since `then`, as others in use left no room for it.
  bool has_refused_since(LastTime::Clock::time_point then) const noexcept {
    return refused_.is_since(then);
  }
  /// Bytes of all plans that are alive.
  std::uint64_t bytes() const noexcept { return *alive_; }

 private:
  using NamedPlan = std::pair<std::string, Plan>;

  Plan find(const std::string& name);
  absl::Status make_room(std::uint64_t bytes, std::size_t most_held, std::string_view what);
  Plan counted(Plan plan);

  const std::uint64_t budget_bytes_;
  const std::shared_ptr<std::atomic<std::uint64_t>> alive_;  ///< bytes
  LastTime refused_;
  std::mutex mutex_;
  std::list<NamedPlan> recent_;  ///< most recently used first
};

}  // namespace tet
