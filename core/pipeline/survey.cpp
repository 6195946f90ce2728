#include "core/pipeline/survey.h"

#include <cstddef>
#include <memory>
#include <optional>

#include <absl/status/status.h>

#include "core/base/parallel.h"
#include "core/stuffing/cut_tet.h"

namespace tet {
namespace {

constexpr std::size_t kBricksPerRange = 8;

struct SurveyedBrick {
  StuffedBrick stuffed;
  BrickMask finest;
  FanMasks fans;
};

bool holds(const BrickBox& box, BrickCoord b) noexcept {
  return b.x >= box.min.x && b.x <= box.max.x && b.y >= box.min.y && b.y <= box.max.y &&
         b.z >= box.min.z && b.z <= box.max.z;
}

/// Cells of a brick and its halo that a domain holds.
HaloSet domain_cells(const BrickBox& domain, BrickCoord brick) noexcept {
  HaloSet cells;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (!holds(domain, {brick.x + x, brick.y + y, brick.z + z})) continue;
        add_brick(cells, BrickMask::all(), x, y, z);
      }
    }
  }
  return cells;
}

FanMasks fans_within(const BrickBox& domain,
                     BrickCoord brick,
                     const StuffingRules& rules,
                     const StuffedLattice& lattice) noexcept {
  const FinestNodes nodes{.plus = lattice.warped.plus,
                          .zero = lattice.warped.zero,
                          .leaf = domain_cells(domain, brick)};
  return find_fans(lattice, nodes, rules);
}

/// Nothing where the surface does not reach the brick.
std::optional<SurveyedBrick> survey_brick(PhiSampler& sampler,
                                          BrickCoord brick,
                                          const MeshedSpace& space,
                                          StuffingWorkspace& workspace) {
  const StuffingRules& rules = space.rules;
  if (!stuff_brick(sampler, brick, rules, workspace)) return std::nullopt;
  const WarpedLattice& warped = workspace.lattice.warped;
  if (!touches_surface(warped, rules)) return std::nullopt;
  SurveyedBrick found{
      keep_brick(warped, rules), with_siblings(stuffed_cells(warped, rules)), {}};
  if (space.domain) {
    // A brick beyond the domain may own corners on its faces, but has no cell in it.
    if (!holds(*space.domain, brick)) found.finest = {};
    found.fans = fans_within(*space.domain, brick, rules, workspace.lattice);
  }
  return found;
}

}  // namespace

bool stuff_brick(PhiSampler& sampler,
                 BrickCoord brick,
                 const StuffingRules& rules,
                 StuffingWorkspace& workspace) noexcept {
  StuffedLattice& lattice = workspace.lattice;
  sampler.sample(brick, workspace.samples);
  find_signs(workspace.samples, lattice.cuts.signs);
  if (lattice.cuts.signs.one_sided()) return false;
  find_cut_points(workspace.samples, sampler, brick, lattice.cuts);
  warp_lattice(lattice.cuts, rules.limits, lattice.warped);
  return true;
}

InsideTest Survey::inside_test() const {
  return [this, index = BrickIndex(bricks)](PhiSampler& sampler, std::int64_t x, std::int64_t y,
                                            std::int64_t z) {
    const auto down = [](std::int64_t v) { return static_cast<std::int32_t>(v >> 3); };
    const std::uint32_t at = index.find({down(x), down(y), down(z)});
    if (at == kNoBrick) return sampler.inside(x, y, z);
    return stuffed[at].plus[kCorner].test(static_cast<int>(x & 7), static_cast<int>(y & 7),
                                          static_cast<int>(z & 7));
  };
}

absl::Status check_cancelled(const Cancellation& cancellation) {
  if (cancellation.deadline_passed()) return absl::DeadlineExceededError("the deadline passed");
  if (cancellation.requested()) return absl::CancelledError("cancelled by the caller");
  return absl::OkStatus();
}

absl::StatusOr<Survey> survey_bricks(const PhiField& field,
                                     const std::vector<BrickCoord>& candidates,
                                     const MeshedSpace& space,
                                     const Cancellation& cancellation,
                                     MeshProgress* progress) {
  if (progress != nullptr) progress->total = candidates.size();
  std::vector<std::optional<SurveyedBrick>> found(candidates.size());
  for_each_range(candidates.size(), kBricksPerRange, [&](std::size_t begin, std::size_t end) {
    PhiSampler sampler(field);
    const auto workspace = std::make_unique_for_overwrite<StuffingWorkspace>();
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      found[i] = survey_brick(sampler, candidates[i], space, *workspace);
      if (progress != nullptr) progress->done.fetch_add(1, std::memory_order_relaxed);
    }
  });
  if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;

  Survey survey;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!found[i]) continue;
    survey.bricks.push_back(candidates[i]);
    survey.stuffed.push_back(found[i]->stuffed);
    survey.finest.push_back(found[i]->finest);
    if (space.rules.both_sides) survey.fans.push_back(found[i]->fans);
  }
  return survey;
}

}  // namespace tet
