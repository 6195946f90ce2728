#include "server/meshing/plan_turns.h"

#include <algorithm>
#include <utility>

#include "server/rpc/background.h"

namespace tet {

namespace {

/// Bricks that a core looks at within a short turn, and within a longer one: a tenth of a
/// second, and a second or two.
constexpr std::array<double, PlanTurns::kKinds - 1> kBricksOfTurn{4096, 65'536};

/// A job has a deadline of its own, and gives way to everybody meanwhile.
constexpr std::chrono::hours kOfJobs{24 * 365};

}  // namespace

void PlanTurns::post(const std::string& client, double bricks, Work work) {
  const auto* const found = std::ranges::lower_bound(kBricksOfTurn, bricks);
  take(client, static_cast<std::size_t>(found - kBricksOfTurn.begin()),
       std::make_shared<const Work>(std::move(work)));
}

PlanTurn PlanTurns::allowance(const std::string& client, std::size_t kind) const {
  PlanTurn turn = kinds_[kind];
  if (turn.is_last && is_background(client)) turn.time = kOfJobs;
  return turn;
}

void PlanTurns::take(const std::string& client,
                     std::size_t kind,
                     std::shared_ptr<const Work> work) {
  auto turn = [this, client, kind, work = std::move(work)] {
    if ((*work)(allowance(client, kind))) return;
    cut_short_.fetch_add(1);
    take(client, std::min(kind + 1, kKinds - 1), work);
  };
  if (kind == 0) return threads_.shortest.post(client, std::move(turn));
  (kind == 1 ? threads_.longer : threads_.longest).post(client, std::move(turn));
}

}  // namespace tet
