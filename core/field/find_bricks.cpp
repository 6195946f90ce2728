#include "core/field/find_bricks.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/brick_sets.h"
#include "core/base/parallel.h"
#include "core/field/region_signs.h"
#include "core/field/regions_to_scan.h"
#include "core/scene/scene.h"

namespace tet {
namespace {

constexpr int kRegionBricks = Region::kEdgeBricks;

/// What is in both boxes.
std::optional<BrickBox> common_part(const BrickBox& a, const BrickBox& b) {
  const BrickBox part{
      {std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y), std::max(a.min.z, b.min.z)},
      {std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y), std::min(a.max.z, b.max.z)}};
  if (part.min.x > part.max.x || part.min.y > part.max.y || part.min.z > part.max.z) {
    return std::nullopt;
  }
  return part;
}

/// Adds the runs of bricks along z that a region's row has bits for.
void add_runs(BrickCoord row, unsigned bits, std::vector<BrickBox>& boxes) {
  while (bits != 0) {
    const int first = std::countr_zero(bits), end = first + std::countr_one(bits >> first);
    boxes.push_back({{row.x, row.y, row.z + first}, {row.x, row.y, row.z + end - 1}});
    bits &= ~0U << end;
  }
}

/// The bricks of a region that lie near the surface, a bit for each.
struct SurfaceRegion {
  BrickCoord min;
  RegionRows bricks;
};

/// What a few regions hold.
struct ScannedRegions {
  std::vector<SurfaceRegion> surface;
  std::size_t surface_bricks = 0;
  std::vector<BrickBox> inside;
};

/// What all regions hold. Bricks are listed only once it is known how many there are.
struct GatheredRegions {
  /// In blocks, which stay where they are: to copy all would take longer than may pass between
  /// two looks.
  std::vector<std::vector<SurfaceRegion>> surface;
  std::size_t surface_bricks = 0;
  std::vector<BrickBox> inside;
};

std::size_t count(const RegionRows& bricks) {
  std::size_t total = 0;
  for (const auto row : bricks) total += static_cast<std::size_t>(std::popcount(row));
  return total;
}

BrickCoord row_of(BrickCoord region, std::size_t i) {
  const auto at = static_cast<std::int32_t>(i);
  return {region.x + at / kRegionBricks, region.y + at % kRegionBricks, region.z};
}

void scan_region(SignsAround& signs, BrickCoord region, ScannedRegions& scanned) {
  signs.enter(region);
  if (signs.one_sign()) {
    constexpr int kLast = kRegionBricks - 1;
    const BrickCoord last{region.x + kLast, region.y + kLast, region.z + kLast};
    if (signs.inside()) scanned.inside.push_back({region, last});
    return;
  }
  const RegionRows near_surface = signs.near_surface();
  if (const std::size_t bricks = count(near_surface); bricks > 0) {
    scanned.surface.push_back({region, near_surface});
    scanned.surface_bricks += bricks;
  }
  for (std::size_t i = 0; i < near_surface.size(); ++i) {
    add_runs(row_of(region, i), signs.inside_rows()[i], scanned.inside);
  }
}

void add_surface_bricks(const SurfaceRegion& region, std::vector<BrickCoord>& bricks) {
  for (std::size_t i = 0; i < region.bricks.size(); ++i) {
    const BrickCoord row = row_of(region.min, i);
    for (unsigned bits = region.bricks[i]; bits != 0; bits &= bits - 1) {
      bricks.push_back({row.x, row.y, row.z + std::countr_zero(bits)});
    }
  }
}

/// The bricks themselves; some of them once cancelled.
std::vector<BrickCoord> surface_bricks(const GatheredRegions& scanned,
                                       const Cancellation& cancellation) {
  std::vector<BrickCoord> bricks;
  bricks.reserve(scanned.surface_bricks);
  for (const std::vector<SurfaceRegion>& block : scanned.surface) {
    for (const SurfaceRegion& region : block) {
      if (cancellation.requested()) return bricks;
      add_surface_bricks(region, bricks);
    }
  }
  return bricks;
}

/// Lattice bricks whose cells, reached out by `reach` cells, meet a box of voxel bricks.
BrickBox lattice_box(const PhiField& field, const BrickBox& box, int reach) {
  // Trilinear values mix a voxel with its neighbours, so a brick's signs reach one voxel
  // further.
  const auto low = [&](std::int32_t brick) {
    const double cell = std::floor((8.0 * brick - 1) / field.spacing_voxels) - reach;
    return static_cast<std::int32_t>(std::floor(cell / kBrickEdge));
  };
  const auto high = [&](std::int32_t brick) {
    const double cell = std::ceil((8.0 * (brick + 1) + 1) / field.spacing_voxels) + reach;
    return static_cast<std::int32_t>(std::floor(cell / kBrickEdge));
  };
  return {{low(box.min.x), low(box.min.y), low(box.min.z)},
          {high(box.max.x), high(box.max.y), high(box.max.z)}};
}

/// How many lattice bricks a voxel brick meets at most, reaching out by its halo.
double lattice_bricks_per_brick(const PhiField& field) {
  constexpr double kReach = 8 + 2;  // voxels, and as many cells
  const double along = (kReach / field.spacing_voxels + kReach) / kBrickEdge;
  return std::pow(std::max(1.0, along), 3);
}

/// Adds the bricks of a box, which is a slice of another where that is large. False once
/// cancelled.
bool add_bricks(const BrickBox& box,
                const Cancellation& cancellation,
                std::vector<BrickCoord>& bricks) {
  for (std::int32_t x = box.min.x; x <= box.max.x; ++x) {
    if (cancellation.requested()) return false;
    for_each_brick({{x, box.min.y, box.min.z}, {x, box.max.y, box.max.z}},
                   [&](BrickCoord seen) { bricks.push_back(seen); });
  }
  return true;
}

/// Voxel bricks become the lattice bricks that see them; each is seen by several. Gives up when
/// there are more than can be kept.
FoundBricks at_lattice(const PhiField& field,
                       const FoundBricks& voxel_bricks,
                       std::size_t most_bricks,
                       const Cancellation& cancellation) {
  constexpr int kHaloReach = 3;
  FoundBricks found;
  std::size_t unsorted_until = 2 * most_bricks;
  for (const BrickCoord brick : voxel_bricks.near_surface) {
    const BrickBox seen = lattice_box(field, {brick, brick}, kHaloReach);
    if (!add_bricks(seen, cancellation, found.near_surface)) return found;
    if (found.near_surface.size() < unsorted_until) continue;
    sort_unique(found.near_surface, cancellation);
    if (found.near_surface.size() > most_bricks) return found;
    unsorted_until = found.near_surface.size() + most_bricks;
  }
  for (const BrickBox& box : voxel_bricks.inside) {
    found.inside.push_back(lattice_box(field, box, 1));
  }
  return found;
}

double cells_in(const PhiField& field, const std::vector<BrickBox>& voxel_bricks) {
  double bricks = 0;
  for (const BrickBox& box : voxel_bricks) bricks += bricks_in(box);
  return bricks * kBrickCells / std::pow(field.spacing_voxels, 3);
}

/// What several threads find, each in a buffer that is filled again and again: the first touch
/// of fresh memory would take longer than the search.
class Gathering {
 public:
  ScannedRegions take_buffer() {
    const std::lock_guard lock(mutex_);
    if (spare_.empty()) return {};
    ScannedRegions buffer = std::move(spare_.back());
    spare_.pop_back();
    return buffer;
  }

  /// Empties the buffer. How many bricks near the surface there are now.
  std::size_t add(ScannedRegions& buffer) {
    const std::lock_guard lock(mutex_);
    add_surface(buffer.surface);
    found_.inside.insert(found_.inside.end(), buffer.inside.begin(), buffer.inside.end());
    found_.surface_bricks += std::exchange(buffer.surface_bricks, 0);
    buffer.surface.clear();
    buffer.inside.clear();
    return found_.surface_bricks;
  }

  void give_back(ScannedRegions buffer) {
    const std::lock_guard lock(mutex_);
    spare_.push_back(std::move(buffer));
  }

  GatheredRegions take() { return std::move(found_); }

 private:
  void add_surface(const std::vector<SurfaceRegion>& regions) {
    constexpr std::size_t kRegionsPerBlock = 1024;  // half a mebibyte
    std::vector<std::vector<SurfaceRegion>>& blocks = found_.surface;
    if (blocks.empty() || blocks.back().capacity() - blocks.back().size() < regions.size()) {
      blocks.emplace_back().reserve(std::max(kRegionsPerBlock, regions.size()));
    }
    blocks.back().insert(blocks.back().end(), regions.begin(), regions.end());
  }

  std::mutex mutex_;  // taken a few times a range; the order of arrival is sorted away
  GatheredRegions found_;
  std::vector<ScannedRegions> spare_;
};

/// Looks at regions side by side, and gives up when there is more surface than can be kept.
GatheredRegions scan_regions(const PhiField& field,
                             const std::vector<BrickCoord>& regions,
                             std::size_t most_bricks,
                             const Cancellation& cancellation) {
  constexpr std::size_t kGatheredAtATime = 64;
  const std::vector<RegionSigns> of_regions = signs_of_regions(field);
  Gathering gathering;
  std::atomic<bool> too_many = false;
  for_each_range(regions.size(), 4, [&](std::size_t begin, std::size_t end) {
    // A refusal comes after all ranges, and each takes longer to begin than to look.
    if (cancellation.requested() || too_many) return;
    SignsAround signs(field, of_regions);
    ScannedRegions mine = gathering.take_buffer();
    for (std::size_t i = begin; i < end && !cancellation.requested() && !too_many; ++i) {
      scan_region(signs, regions[i], mine);
      const bool is_last =
          i + 1 == end || (i - begin) % kGatheredAtATime + 1 == kGatheredAtATime;
      if (is_last && gathering.add(mine) > most_bricks) too_many = true;
    }
    gathering.give_back(std::move(mine));
  });
  return gathering.take();
}

}  // namespace

absl::Status check_surface_bricks(double bricks, std::size_t most) {
  if (bricks <= static_cast<double>(most)) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrFormat("about %.3g bricks of 8^3 cells or more lie near the surface; the limit "
                      "is %d, as many as "
                      "the memory for counting a mesh holds. Use a larger spacing",
                      bricks, most));
}

absl::Status check_inside_ends(const PhiField& field) {
  if (field.volume == nullptr) return check_ends(*field.scene);
  if (!(field.phi(field.volume->background) < 0)) return absl::OkStatus();
  const Volume& volume = *field.volume;
  const InsideSide inside = inside_side(volume, field.inside);
  return absl::FailedPreconditionError(absl::StrFormat(
      "%s, so the inside has no end; choose another iso value, say that the inside is %s it "
      "(--inside), or mesh within a box",
      describe_inverted(volume, inside, field.iso),
      side_name(inside == InsideSide::kAbove ? InsideSide::kBelow : InsideSide::kAbove)));
}

void keep_domain(const BrickBox& domain, FoundBricks& found) {
  std::erase_if(found.near_surface, [&](BrickCoord b) {
    return b.x < domain.min.x || b.y < domain.min.y || b.z < domain.min.z ||
           b.x > domain.max.x + 1 || b.y > domain.max.y + 1 || b.z > domain.max.z + 1;
  });
  found.inside = {domain};
  found.inside_cells = kBrickCells * bricks_in(domain);
}

void keep_inside_of(const BrickBox& box, const PhiField& field, FoundBricks& found) {
  std::erase_if(found.near_surface, [&](BrickCoord b) {
    return !common_part(box, {b, b}).has_value();
  });
  // The boxes of an inside without an end do not cover it.
  if (!check_inside_ends(field).ok()) found.inside = {box};
  std::vector<BrickBox> inside;
  double cells = 0;
  for (const BrickBox& part : found.inside) {
    const std::optional<BrickBox> kept = common_part(box, part);
    if (!kept) continue;
    inside.push_back(*kept);
    cells += kBrickCells * bricks_in(*kept);
  }
  found.inside = std::move(inside);
  found.inside_cells = std::min(cells, kBrickCells * bricks_in(box));  // boxes may overlap
}

absl::StatusOr<FoundBricks> find_bricks(const PhiField& field,
                                        std::size_t most_bricks,
                                        const Cancellation& cancellation) {
  const absl::StatusOr<std::vector<BrickCoord>> regions = regions_to_scan(field, cancellation);
  if (!regions.ok()) return regions.status();
  // At other spacings a brick is counted as all lattice bricks that it may meet. These are more
  // than it does meet, so only the hard limit refuses by them.
  const std::size_t most_seen = field.at_voxels() ? most_bricks : kMaxSurfaceBricks;
  GatheredRegions scanned = scan_regions(field, *regions, most_seen, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;

  // How many there were when it gave up depends on who was first.
  if (scanned.surface_bricks > most_seen) {
    return absl::ResourceExhaustedError(
        absl::StrFormat("more bricks of 8^3 cells than can be kept lie near the surface; the "
                        "limit is %d, as many as the memory for counting a mesh holds. Use a "
                        "larger spacing",
                        most_seen));
  }
  const auto seen = static_cast<double>(scanned.surface_bricks);
  const double per_brick = field.at_voxels() ? 1 : lattice_bricks_per_brick(field);
  if (auto status = check_surface_bricks(seen * per_brick, most_seen); !status.ok())
    return status;
  FoundBricks found;
  found.near_surface = surface_bricks(scanned, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  found.inside = std::move(scanned.inside);
  for (const BrickBox& box : deep_inside(field)) found.inside.push_back(box);
  const double inside_cells = cells_in(field, found.inside);
  if (!field.at_voxels()) found = at_lattice(field, found, most_bricks, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  found.inside_cells = inside_cells;
  sort_unique(found.near_surface, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  const auto bricks = static_cast<double>(found.near_surface.size());
  if (auto status = check_surface_bricks(bricks, most_bricks); !status.ok()) return status;
  return found;
}

}  // namespace tet
