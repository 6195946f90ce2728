#include "core/plan/brick/survey.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include <absl/status/status.h>

#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"
#include "core/field/brick_sides.h"
#include "core/plan/brick/manifold.h"
#include "core/plan/brick/survey_findings.h"
#include "core/plan/budget.h"
#include "core/stuffing/cut_tet.h"
#include "core/stuffing/topology/surface_walk.h"

namespace tet {
namespace {

constexpr std::size_t kSurveyedPerRange = 8;
/// Candidates whose findings lie around by themselves until they are gathered: a few MB, and
/// enough for many threads.
constexpr std::size_t kSurveyedAtATime = 8192;

struct SurveyWorkspace {
  StuffingWorkspace stuffing;
  SurfaceWorkspace surface;
};

/// Where the lattice is too coarse for a brick's walls; empty for nearly every brick.
ThinSpots find_thin_spots(PhiSampler& sampler,
                          BrickCoord brick,
                          bool stuffed,
                          const StuffingWorkspace& workspace) {
  ThinSpots spots;
  if (stuffed) find_thin_nodes(workspace.samples, workspace.lattice.cuts, spots);
  // Between nodes of a finer lattice the field has no more to say than at them.
  if (sampler.field().coarser_than_voxels()) {
    find_thin_edges(workspace.samples, sampler, brick, spots);
  }
  return spots;
}

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

/// Cells of a brick of the domain that lie at one of its faces.
BrickMask outermost_cells(const BrickBox& domain, BrickCoord b) noexcept {
  BrickMask cells;
  for_each_bit(BrickMask::all(), [&](int x, int y, int z) {
    const auto outermost = [](std::int32_t brick, int i, std::int32_t min, std::int32_t max) {
      return (brick == min && i == 0) || (brick == max && i == kBrickEdge - 1);
    };
    if (outermost(b.x, x, domain.min.x, domain.max.x) ||
        outermost(b.y, y, domain.min.y, domain.max.y) ||
        outermost(b.z, z, domain.min.z, domain.max.z)) {
      cells.set(x, y, z);
    }
  });
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

std::uint64_t count_fans(const FanMasks& fans) noexcept {
  std::uint64_t count = 0;
  for (const BrickMask& mask : fans) count += mask.count();
  return count;
}

/// True where every node that was inside has moved onto the surface. The samples alone would
/// then take some of the brick for inside.
bool lost_its_inside(const StuffedLattice& lattice) noexcept {
  const WarpedLattice& warped = lattice.warped;
  return !warped.plus[kCorner].any() && !warped.plus[kCentre].any() &&
         brick_part(lattice.cuts.signs.inside[kCorner]).any();
}

/// The regions on either side of the surface; `plain_sides` as of its sheet.
SurfaceRegions regions_of(const SignedNodes& signs, bool plain_sides) {
  if (plain_sides) {
    const StarSigns star(signs.plus, signs.zero);
    const auto inner = find_inner_zeros(star, lone_zeros(star), signs);
    if (inner) return {star, *inner};
  }
  return SurfaceRegions(signs);
}

/// Finds the parts of a surface that is not plainly one sheet.
void survey_parts(const WarpedLattice& lattice,
                  SurfaceWorkspace& workspace,
                  SurveyedBrick& found) {
  SurfaceSheet& sheet = found.surface.sheet;
  const SurfaceRegions regions =
      regions_of({lattice.plus, lattice.zero}, sheet.has_plain_sides);
  if (regions.have_one_sheet()) {
    sheet = sheet_between(regions);
    return;
  }
  std::optional<SurfaceParts> parts = parts_between_regions(regions);
  if (!parts) parts = walk_surface(lattice, workspace);
  found.parts = std::make_shared<const SurfaceParts>(*std::move(parts));
}

void survey_topology(const WarpedLattice& lattice,
                     SurfaceWorkspace& workspace,
                     SurveyedBrick& found) {
  found.surface = survey_surface(lattice, found.stuffed);
  if (found.surface.sheet.any && !found.surface.sheet.one) {
    survey_parts(lattice, workspace, found);
  }
}

/// Returns null where the surface does not reach the brick.
std::unique_ptr<SurveyedBrick> survey_brick(PhiSampler& sampler,
                                            BrickCoord brick,
                                            const MeshedSpace& space,
                                            const RestoredNodes* restored,
                                            SurveyWorkspace& workspace,
                                            ThinSpots& spots) {
  const StuffingRules& rules = space.rules;
  const bool stuffed = stuff_brick(sampler, brick, rules, restored, workspace.stuffing);
  spots = find_thin_spots(sampler, brick, stuffed, workspace.stuffing);
  if (!stuffed) return nullptr;
  const StuffedLattice& lattice = workspace.stuffing.lattice;
  if (!touches_surface(lattice.warped, rules) && !lost_its_inside(lattice)) return nullptr;
  auto found = std::make_unique<SurveyedBrick>();
  const PlusAround plus(lattice.warped);
  found->stuffed = keep_brick(lattice.warped, plus, rules);
  // A brick beyond the domain may own corners on its faces, but has no cell in it.
  if (space.domain && !holds(*space.domain, brick)) return found;
  const BrickMask cells = stuffed_cells(lattice.warped, plus, rules);
  found->finest = with_siblings(cells);
  if (!space.skip_topology) survey_topology(lattice.warped, workspace.surface, *found);
  if (!space.domain) return found;
  found->fans = std::make_unique<FanMasks>(fans_within(*space.domain, brick, rules, lattice));
  found->surface.counts.add_fans(count_fans(*found->fans));
  found->at_domain_face = (cells & outermost_cells(*space.domain, brick)).any();
  return found;
}

/// Looks bricks up in an earlier survey. Not thread-safe: one per task.
class EarlierBricks {
 public:
  explicit EarlierBricks(const EarlierSurvey& earlier)
      : survey_(earlier.survey), asker_(earlier.difference) {}

  bool still_holds(BrickCoord brick) { return asker_.same_around(brick); }

  /// Finds a brick's place in the earlier survey, kNotKnown where the surface did not reach it.
  /// Bricks are asked for in ascending order.
  std::uint32_t find(BrickCoord brick) {
    const std::vector<BrickCoord>& bricks = survey_.bricks;
    // Nearly always it is the next one, or beyond it by few.
    std::size_t step = started_ ? 1 : bricks.size();
    started_ = true;
    while (at_ + step < bricks.size() && bricks[at_ + step - 1] < brick) {
      at_ += step;
      step *= 2;
    }
    const auto begin = bricks.begin() + static_cast<std::ptrdiff_t>(at_);
    const auto end =
        bricks.begin() + static_cast<std::ptrdiff_t>(std::min(at_ + step, bricks.size()));
    at_ = static_cast<std::size_t>(std::lower_bound(begin, end, brick) - bricks.begin());
    const bool known = at_ < bricks.size() && bricks[at_] == brick;
    return known ? static_cast<std::uint32_t>(at_) : kNotKnown;
  }

  ThinSpots thin_spots(BrickCoord brick) const {
    const auto thin = std::ranges::lower_bound(survey_.thin, brick, {}, &ThinBrick::brick);
    const bool any = thin != survey_.thin.end() && thin->brick == brick;
    return any ? thin->spots : ThinSpots{};
  }

 private:
  const Survey& survey_;
  FieldDifference::Asker asker_;
  bool started_ = false;
  std::size_t at_ = 0;
};

/// What is surveyed, and how.
struct SurveyTask {
  const PhiField& field;
  const MeshedSpace& space;
  const EarlierSurvey* earlier;
  const Cancellation& cancellation;
  MeshProgress* progress;
};

/// Surveys candidates, some at a time.
class Surveyor {
 public:
  Surveyor(const SurveyTask& task, Survey& survey)
      : task_(task),
        survey_(survey),
        room_(static_cast<std::int64_t>(task.space.kept_geometry_bytes)) {
    // Beside an earlier survey few bricks are looked at, and the table is of all.
    if (task.field.at_voxels() && task.earlier == nullptr) sides_.emplace(task.field);
    if (task.earlier == nullptr) return;
    const KeptGeometry& before = task.earlier->survey.geometry;
    shares_ = can_share(before, task.space.kept_geometry_bytes);
    if (!shares_) return;
    survey.geometry.blocks = before.blocks;
    room_ -= static_cast<std::int64_t>(before.block_bytes);
  }

  /// Appends what is found of `candidates`, which follow those before; `still_to_come` follow
  /// them. Errors: kResourceExhausted (more than may be kept), kCancelled, kDeadlineExceeded.
  absl::Status add(std::span<const BrickCoord> candidates, std::size_t still_to_come) {
    Findings findings(candidates.size());
    std::vector<std::shared_ptr<const std::byte[]>> blocks(
        candidates.size());  // of ranges, where they begin
    for_each_range(candidates.size(), kSurveyedPerRange,
                   [&](std::size_t begin, std::size_t end) {
                     GeometryKeeper keeper(room_, findings.geometry);
                     find_range(candidates, begin, end, findings, keeper);
                     blocks[begin] = keeper.take();
                   });
    if (auto status = check_cancelled(task_.cancellation); !status.ok()) return status;
    std::erase(blocks, nullptr);
    std::ranges::move(blocks, std::back_inserter(survey_.geometry.blocks));
    add_findings(candidates, std::move(findings), task_.earlier, task_.space.rules.both_sides,
                 {still_to_come, task_.space.most_bricks}, survey_);
    return check_survey_budget(survey_.bricks.size(), rare_.bytes_of(survey_), task_.space);
  }

  /// To be called once everything is added.
  void finish() {
    KeptGeometry& kept = survey_.geometry;
    kept.block_bytes = task_.space.kept_geometry_bytes -
                       static_cast<std::uint64_t>(std::max<std::int64_t>(room_, 0));
    if (!shares_) return;
    const KeptGeometry& before = task_.earlier->survey.geometry;
    std::uint64_t still = 0;
    for (std::size_t i = 0; i < survey_.known.size(); ++i) {
      still += survey_.known[i] != kNotKnown && kept.of_brick[i] != nullptr;
    }
    kept.gone = before.gone + count_kept(before) - still;
  }

 private:
  void find_range(std::span<const BrickCoord> candidates,
                  std::size_t begin,
                  std::size_t end,
                  Findings& findings,
                  GeometryKeeper& keeper) {
    const EarlierSurvey* const earlier = task_.earlier;
    std::optional<PhiSampler> sampler;
    std::optional<ScratchPool<SurveyWorkspace>::Turn> workspace;
    std::optional<EarlierBricks> before;
    if (earlier != nullptr) before.emplace(*earlier);
    for (std::size_t i = begin; i < end && !task_.cancellation.requested(); ++i) {
      ThinSpots spots;
      if (before && before->still_holds(candidates[i])) {
        const std::uint32_t at = findings.known[i] = before->find(candidates[i]);
        spots = before->thin_spots(candidates[i]);
        if (at != kNotKnown && shares_) {
          findings.geometry[i] = earlier->survey.geometry.of_brick[at];
        } else if (at != kNotKnown) {
          keeper.keep_again(i, earlier->survey.stuffed[at],
                            earlier->survey.geometry.of_brick[at]);
        }
      } else {
        if (!workspace) {
          workspace.emplace(workspaces_);
          sampler.emplace(task_.field).stop_when(task_.cancellation);
          if (sides_) sampler->remember_in(*sides_);
        }
        auto found = survey_brick(*sampler, candidates[i], task_.space, survey_.restored.get(),
                                  **workspace, spots);
        if (found) {
          keeper.keep(i, found->stuffed, (*workspace)->stuffing.lattice);
          findings.surveyed[i] = std::move(found);
        }
      }
      if (spots.any()) findings.thin[i] = std::make_unique<ThinSpots>(spots);
      if (task_.progress != nullptr) {
        task_.progress->done.fetch_add(1, std::memory_order_relaxed);
      }
    }
  }

  const SurveyTask task_;
  Survey& survey_;
  std::atomic<std::int64_t> room_;
  bool shares_ = false;  ///< the earlier survey's blocks
  RareFindings rare_;
  std::optional<BrickSides> sides_;
  ScratchPool<SurveyWorkspace> workspaces_;
};

/// True where no edge of the nodes that a brick knows is cut, and none of them is zero: they
/// are all on one side then, and no node moves. That is every fifth brick whose samples,
/// which reach further, are on both sides.
bool misses_surface(const CutPoints& cuts) noexcept {
  const auto has_zero = [&](NodeKind kind) {
    return (kKnownNodes - cuts.signs.inside[kind] - cuts.signs.outside[kind]).any();
  };
  return std::ranges::none_of(cuts.edges.run,
                              [](const CutEdges::Run& run) { return run.count != 0; }) &&
         !has_zero(kCorner) && !has_zero(kCentre);
}

}  // namespace

bool stuff_brick(PhiSampler& sampler,
                 BrickCoord brick,
                 const StuffingRules& rules,
                 const RestoredNodes* restored,
                 StuffingWorkspace& workspace) noexcept {
  StuffedLattice& lattice = workspace.lattice;
  if (sampler.one_sided(brick)) return false;
  sampler.sample(brick, workspace.samples);
  find_signs(workspace.samples, lattice.cuts.signs);
  if (lattice.cuts.signs.one_sided()) return false;
  find_cut_points(workspace.samples, sampler, brick, lattice.cuts);
  if (misses_surface(lattice.cuts)) return false;
  warp_lattice(lattice.cuts, rules.limits, lattice.warped);
  if (restored != nullptr) restore_nodes(restored->around(brick), rules.limits, lattice);
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

std::uint64_t Survey::bytes() const noexcept {
  std::uint64_t of_parts = 0;
  for (const PartsOfBrick& brick : parts) of_parts += brick.parts->bytes();
  return of_parts +
         all_heap_bytes(bricks, stuffed, finest, fans, geometry.of_brick, geometry.blocks, thin,
                        counts, sheets, parts) +
         geometry.block_bytes;
}

bool can_reuse(const Survey& earlier, const MeshedSpace& space) noexcept {
  return earlier.restored == nullptr && !space.manifold && !space.domain &&
         (earlier.has_topology || space.skip_topology);
}

absl::StatusOr<Survey> survey_bricks(const PhiField& field,
                                     const std::vector<BrickCoord>& candidates,
                                     const MeshedSpace& space,
                                     const Cancellation& cancellation,
                                     MeshProgress* progress,
                                     const EarlierSurvey* earlier) {
  if (progress != nullptr) progress->expect(candidates.size());
  Survey survey;
  survey.has_topology = !space.skip_topology;
  if (space.manifold) {
    auto nodes = find_nodes_to_restore(field, candidates, space.rules, cancellation);
    if (!nodes.ok()) return nodes.status();
    survey.restored = *std::move(nodes);
  }
  Surveyor surveyor({field, space, earlier, cancellation, progress}, survey);
  for (std::size_t first = 0; first < candidates.size(); first += kSurveyedAtATime) {
    const std::span rest = std::span(candidates).subspan(first);
    const std::span now = rest.first(std::min(kSurveyedAtATime, rest.size()));
    if (auto status = surveyor.add(now, rest.size() - now.size()); !status.ok()) return status;
  }
  surveyor.finish();
  return survey;
}

}  // namespace tet
