// Plans of many clients, made in turns: short ones, and longer ones for what takes longer.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/meshing/large_plans.h"
#include "server/rpc/fair_tasks.h"

namespace tet {

/// What a plan may take before it has to make room for others.
struct PlanTurn {
  std::chrono::milliseconds time{0};
  std::uint64_t bytes = 0;  ///< see MeshLimits::max_plan_bytes
  bool is_last = false;     ///< what takes more than this is not made at all
};

/// Where turns are taken, by their length.
struct TurnThreads {
  FairTasks& shortest;  ///< beside chunks
  LargePlans& longer;
  LargePlans& longest;
};

/// What a plan takes is known when it is made, and not before: a request of a hundred bytes may
/// look cheap and take minutes. So each begins with a turn as long as it looks to need, and
/// what does not end in time, or asks for more memory, is stopped and begun anew in a turn that
/// is many times as long, on other threads: at most a part of the work is done twice. Clients
/// alternate in every kind of turn, so that one who has little to do never waits for more than
/// a short turn of each of the others.
///
/// Thread safety: any thread may call any member. All that was posted must have ended before
/// the threads end.
class PlanTurns {
 public:
  static constexpr std::size_t kKinds = 3;
  using Kinds = std::array<PlanTurn, kKinds>;
  /// Makes a plan within what the turn allows. False: that was not enough.
  using Work = std::function<bool(const PlanTurn&)>;

  PlanTurns(const TurnThreads& threads, const Kinds& kinds)
      : threads_(threads), kinds_(kinds) {}

  /// `bricks` is what the plan looks to take: see estimate_bricks_to_plan.
  void post(const std::string& client, double bricks, Work work);

  /// Turns that were not enough, so far.
  std::int64_t cut_short() const noexcept { return cut_short_.load(); }

 private:
  void take(const std::string& client, std::size_t kind, std::shared_ptr<const Work> work);
  PlanTurn allowance(const std::string& client, std::size_t kind) const;

  const TurnThreads threads_;
  const Kinds kinds_;
  std::atomic<std::int64_t> cut_short_{0};
};

}  // namespace tet
