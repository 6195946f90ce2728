#include "core/pipeline/survey.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <absl/status/status.h>

#include "core/base/parallel.h"
#include "core/pipeline/manifold.h"
#include "core/stuffing/cut_tet.h"

namespace tet {
namespace {

constexpr std::size_t kBricksPerRange = 8;

struct SurveyedBrick {
  StuffedBrick stuffed;
  BrickMask finest;
  std::unique_ptr<FanMasks> fans;  ///< where both sides are meshed
  SurveyedSurface surface;
  std::unique_ptr<SurfaceParts> parts;  ///< where the surface is not known to be one sheet
  const std::byte* geometry = nullptr;  ///< where it is kept
  bool at_domain_face = false;          ///< some tet near a face of the domain is cut or moved
};

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
  constexpr HaloSet kOwn = halo_cube(0, 7);
  const WarpedLattice& warped = lattice.warped;
  return !warped.plus[kCorner].any() && !warped.plus[kCentre].any() &&
         (lattice.cuts.signs.inside[kCorner] & kOwn).any();
}

/// Nothing where the surface does not reach the brick.
std::optional<SurveyedBrick> survey_brick(PhiSampler& sampler,
                                          BrickCoord brick,
                                          const MeshedSpace& space,
                                          const RestoredNodes* restored,
                                          SurveyWorkspace& workspace,
                                          ThinSpots& spots) {
  const StuffingRules& rules = space.rules;
  const bool stuffed = stuff_brick(sampler, brick, rules, restored, workspace.stuffing);
  spots = find_thin_spots(sampler, brick, stuffed, workspace.stuffing);
  if (!stuffed) return std::nullopt;
  const StuffedLattice& lattice = workspace.stuffing.lattice;
  if (!touches_surface(lattice.warped, rules) && !lost_its_inside(lattice)) return std::nullopt;
  SurveyedBrick found;
  found.stuffed = keep_brick(lattice.warped, rules);
  // A brick beyond the domain may own corners on its faces, but has no cell in it.
  if (space.domain && !holds(*space.domain, brick)) return found;
  const BrickMask cells = stuffed_cells(lattice.warped, rules);
  found.finest = with_siblings(cells);
  found.surface = survey_surface(lattice.warped, found.stuffed);
  if (found.surface.sheet.any && !found.surface.sheet.one) {
    found.parts =
        std::make_unique<SurfaceParts>(find_surface_parts(lattice.warped, workspace.surface));
  }
  if (!space.domain) return found;
  found.fans = std::make_unique<FanMasks>(fans_within(*space.domain, brick, rules, lattice));
  found.surface.counts.add_fans(count_fans(*found.fans));
  found.at_domain_face = (cells & outermost_cells(*space.domain, brick)).any();
  return found;
}

/// Packs the geometry of one brick after another, as long as there is room for it.
class GeometryKeeper {
 public:
  /// `room` is what all keepers together may still take, bytes.
  explicit GeometryKeeper(std::atomic<std::int64_t>& room) : room_(room) {}

  void keep(const StuffedLattice& lattice, SurveyedBrick& found) {
    if (std::byte* const to = make_room(found)) pack_geometry(lattice, found.stuffed, to);
  }

  /// The same of a brick whose geometry was packed before.
  void keep_again(SurveyedBrick& found) {
    const std::byte* const packed = std::exchange(found.geometry, nullptr);
    if (packed == nullptr) return;
    if (std::byte* const to = make_room(found)) {
      std::copy_n(packed, GeometrySizes(found.stuffed).bytes(), to);
    }
  }

  /// Moves all of it to where it stays, and tells the bricks.
  std::shared_ptr<std::byte[]> take() {
    if (packed_.empty()) return nullptr;
    std::shared_ptr<std::byte[]> block =
        std::make_unique_for_overwrite<std::byte[]>(packed_.size());
    std::copy(packed_.begin(), packed_.end(), block.get());
    for (const auto& [found, begin] : kept_) found->geometry = block.get() + begin;
    return block;
  }

 private:
  /// Null where there is none.
  std::byte* make_room(SurveyedBrick& found) {
    const std::size_t size = GeometrySizes(found.stuffed).bytes();
    if (room_.fetch_sub(static_cast<std::int64_t>(size)) < static_cast<std::int64_t>(size)) {
      return nullptr;
    }
    const std::size_t begin = packed_.size();
    packed_.resize(begin + size);
    kept_.emplace_back(&found, begin);
    return packed_.data() + begin;
  }

  std::atomic<std::int64_t>& room_;
  std::vector<std::byte> packed_;
  std::vector<std::pair<SurveyedBrick*, std::size_t>> kept_;
};

/// Looks bricks up in an earlier survey. Not thread-safe: one per task.
class EarlierBricks {
 public:
  explicit EarlierBricks(const EarlierSurvey& earlier)
      : survey_(earlier.survey), asker_(earlier.difference) {}

  bool still_holds(BrickCoord brick) { return asker_.same_around(brick); }

  /// As it was found then; its geometry is the earlier survey's.
  std::optional<SurveyedBrick> find(BrickCoord brick) const {
    const auto found = std::ranges::lower_bound(survey_.bricks, brick);
    if (found == survey_.bricks.end() || *found != brick) return std::nullopt;
    const auto at = static_cast<std::size_t>(found - survey_.bricks.begin());
    SurveyedBrick before;
    before.stuffed = survey_.stuffed[at];
    before.finest = survey_.finest[at];
    before.surface = {survey_.counts[at], survey_.sheets[at]};
    before.geometry = survey_.geometry.of_brick[at];
    const auto parts = std::ranges::lower_bound(survey_.parts, at, {}, &PartsOfBrick::brick);
    if (parts != survey_.parts.end() && parts->brick == at) {
      before.parts = std::make_unique<SurfaceParts>(parts->parts);
    }
    return before;
  }

  ThinSpots thin_spots(BrickCoord brick) const {
    const auto thin = std::ranges::lower_bound(survey_.thin, brick, {}, &ThinBrick::brick);
    const bool any = thin != survey_.thin.end() && thin->brick == brick;
    return any ? thin->spots : ThinSpots{};
  }

 private:
  const Survey& survey_;
  FieldDifference::Asker asker_;
};

/// Gathers what was found, in the order of the bricks, and lets go of it.
Survey gather(const std::vector<BrickCoord>& candidates,
              std::vector<std::unique_ptr<SurveyedBrick>>& found,
              bool both_sides,
              const Cancellation& cancellation) {
  Survey survey;
  for (std::size_t i = 0; i < candidates.size() && !cancellation.requested(); ++i) {
    if (!found[i]) continue;
    survey.bricks.push_back(candidates[i]);
    survey.stuffed.push_back(found[i]->stuffed);
    survey.finest.push_back(found[i]->finest);
    survey.geometry.of_brick.push_back(found[i]->geometry);
    if (both_sides) survey.fans.push_back(found[i]->fans ? *found[i]->fans : FanMasks{});
    survey.counts.push_back(found[i]->surface.counts);
    if (found[i]->parts) {
      const auto at = static_cast<std::uint32_t>(survey.sheets.size());
      survey.parts.push_back({at, std::move(*found[i]->parts)});
    }
    survey.sheets.push_back(found[i]->surface.sheet);
    survey.box_cuts_surface = survey.box_cuts_surface || found[i]->at_domain_face;
    found[i] = nullptr;
  }
  return survey;
}

}  // namespace

bool stuff_brick(PhiSampler& sampler,
                 BrickCoord brick,
                 const StuffingRules& rules,
                 const RestoredNodes* restored,
                 StuffingWorkspace& workspace) noexcept {
  StuffedLattice& lattice = workspace.lattice;
  sampler.sample(brick, workspace.samples);
  find_signs(workspace.samples, lattice.cuts.signs);
  if (lattice.cuts.signs.one_sided()) return false;
  find_cut_points(workspace.samples, sampler, brick, lattice.cuts);
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
  return all_heap_bytes(bricks, stuffed, finest, fans, geometry.of_brick, geometry.blocks, thin,
                        counts, sheets, parts) +
         geometry.block_bytes;
}

bool can_reuse(const Survey& earlier, const MeshedSpace& space) noexcept {
  return earlier.restored == nullptr && !space.manifold && !space.domain;
}

absl::StatusOr<Survey> survey_bricks(const PhiField& field,
                                     const std::vector<BrickCoord>& candidates,
                                     const MeshedSpace& space,
                                     const Cancellation& cancellation,
                                     MeshProgress* progress,
                                     const EarlierSurvey* earlier) {
  if (progress != nullptr) progress->expect(candidates.size());
  std::shared_ptr<const RestoredNodes> restored;
  if (space.manifold) {
    auto nodes = find_nodes_to_restore(field, candidates, space.rules, cancellation);
    if (!nodes.ok()) return nodes.status();
    restored = *std::move(nodes);
  }
  // Most candidates have no part in the surface where the lattice is finer than the voxels.
  std::vector<std::unique_ptr<SurveyedBrick>> found(candidates.size());
  std::vector<std::unique_ptr<ThinSpots>> thin(candidates.size());  // null where there are none
  std::vector<std::shared_ptr<std::byte[]>> blocks(
      candidates.size());  // of ranges, where they begin
  std::atomic<std::int64_t> room{static_cast<std::int64_t>(space.kept_geometry_bytes)};
  for_each_range(candidates.size(), kBricksPerRange, [&](std::size_t begin, std::size_t end) {
    PhiSampler sampler(field);
    const auto workspace = std::make_unique_for_overwrite<SurveyWorkspace>();
    GeometryKeeper keeper(room);
    std::optional<EarlierBricks> before;
    if (earlier != nullptr) before.emplace(*earlier);
    ThinSpots spots;
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      const bool known = before && before->still_holds(candidates[i]);
      auto brick = known ? before->find(candidates[i])
                         : survey_brick(sampler, candidates[i], space, restored.get(),
                                        *workspace, spots);
      if (known) spots = before->thin_spots(candidates[i]);
      if (brick) found[i] = std::make_unique<SurveyedBrick>(*std::move(brick));
      if (found[i]) {
        known ? keeper.keep_again(*found[i])
              : keeper.keep(workspace->stuffing.lattice, *found[i]);
      }
      if (spots.any()) thin[i] = std::make_unique<ThinSpots>(spots);
      if (progress != nullptr) progress->done.fetch_add(1, std::memory_order_relaxed);
    }
    blocks[begin] = keeper.take();
  });
  if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;

  Survey survey = gather(candidates, found, space.rules.both_sides, cancellation);
  if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;
  survey.restored = std::move(restored);
  std::erase(blocks, nullptr);
  survey.geometry.blocks = std::move(blocks);
  survey.geometry.block_bytes =
      space.kept_geometry_bytes - static_cast<std::uint64_t>(std::max<std::int64_t>(room, 0));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (thin[i]) survey.thin.push_back({candidates[i], *thin[i]});
  }
  return survey;
}

}  // namespace tet
