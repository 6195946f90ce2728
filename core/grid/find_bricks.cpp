#include "core/grid/find_bricks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <mutex>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/grid/region_signs.h"

namespace tet {
namespace {

/// Looking at a region costs microseconds; more than this many are a claim, not a grid.
constexpr std::size_t kMaxRegions = std::size_t{1} << 22;
constexpr int kRegionBricks = Region::kEdgeBricks;

/// Calls `visit` for a region and the 26 around it.
template <class Visit>
void for_each_region_around(BrickCoord region, const Visit& visit) {
  for_each_brick(
      {
          {-1, -1, -1},
          { 1,  1,  1}
  },
      [&](BrickCoord step) {
        visit(BrickCoord{region.x + kRegionBricks * step.x, region.y + kRegionBricks * step.y,
                         region.z + kRegionBricks * step.z});
      });
}

void sort_unique(std::vector<BrickCoord>& bricks) {
  std::sort(bricks.begin(), bricks.end());
  bricks.erase(std::unique(bricks.begin(), bricks.end()), bricks.end());
}

/// Every region with bricks or inside constants, and all that touch one; sorted, unique.
absl::StatusOr<std::vector<BrickCoord>> regions_to_scan(const PhiField& field) {
  std::vector<BrickCoord> regions;
  const auto add_with_neighbours = [&](BrickCoord region) {
    for_each_region_around(region, [&](BrickCoord around) { regions.push_back(around); });
  };
  for (const Region& region : field.volume->regions) add_with_neighbours(region.min);
  std::size_t cube_regions = 0;
  for (const ConstantCube& cube : field.volume->cubes) {
    const auto wide = static_cast<std::size_t>(cube.edge / 128);
    cube_regions += wide * wide * wide;
  }
  if (cube_regions > kMaxRegions) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "the grid's constant tiles cover %d regions of 128^3 voxels; at most %d can be meshed",
        cube_regions, kMaxRegions));
  }
  std::size_t most = std::size_t{1} << 20;
  for (const ConstantCube& cube : field.volume->cubes) {
    const std::int32_t last = cube.edge / (kRegionBricks * kBrickEdge) - 1;
    const BrickCoord min{cube.min.x / kBrickEdge, cube.min.y / kBrickEdge,
                         cube.min.z / kBrickEdge};
    for_each_brick(
        {
            {   0,    0,    0},
            {last, last, last}
    },
        [&](BrickCoord at) {
          add_with_neighbours({min.x + kRegionBricks * at.x, min.y + kRegionBricks * at.y,
                               min.z + kRegionBricks * at.z});
        });
    // Neighbours repeat 27 times; keep the list from growing with them.
    if (regions.size() < most) continue;
    sort_unique(regions);
    most = std::max(most, 2 * regions.size());
  }
  sort_unique(regions);
  return regions;
}

/// Adds the runs of bricks along z that a region's row has bits for.
void add_runs(BrickCoord row, unsigned bits, std::vector<BrickBox>& boxes) {
  while (bits != 0) {
    const int first = std::countr_zero(bits), end = first + std::countr_one(bits >> first);
    boxes.push_back({
        {row.x, row.y,   row.z + first},
        {row.x, row.y, row.z + end - 1}
    });
    bits &= ~0U << end;
  }
}

void scan_region(SignsAround& signs, BrickCoord region, FoundBricks& found) {
  signs.enter(region);
  if (signs.one_sign()) {
    constexpr int kLast = kRegionBricks - 1;
    const BrickCoord last{region.x + kLast, region.y + kLast, region.z + kLast};
    if (signs.inside()) found.inside.push_back({region, last});
    return;
  }
  const RegionRows near_surface = signs.near_surface();
  for (std::size_t i = 0; i < near_surface.size(); ++i) {
    const auto at = static_cast<std::int32_t>(i);
    const BrickCoord row{region.x + at / kRegionBricks, region.y + at % kRegionBricks,
                         region.z};
    for (unsigned bits = near_surface[i]; bits != 0; bits &= bits - 1) {
      found.near_surface.push_back({row.x, row.y, row.z + std::countr_zero(bits)});
    }
    add_runs(row, signs.inside_rows()[i], found.inside);
  }
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
  return {
      { low(box.min.x),  low(box.min.y),  low(box.min.z)},
      {high(box.max.x), high(box.max.y), high(box.max.z)}
  };
}

/// A brick near the surface costs about 2 KiB until the mesh is made.
constexpr std::size_t kMaxSurfaceBricks = std::size_t{1} << 23;

absl::Status check_surface_bricks(double bricks) {
  if (bricks <= static_cast<double>(kMaxSurfaceBricks)) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "the surface would pass through about %.3g bricks of 8^3 cells; the limit is %d. Use a "
      "larger spacing",
      bricks, kMaxSurfaceBricks));
}

/// How many lattice bricks a voxel brick meets at most, reaching out by its halo.
double lattice_bricks_per_brick(const PhiField& field) {
  constexpr double kReach = 8 + 2;  // voxels, and as many cells
  const double along = (kReach / field.spacing_voxels + kReach) / kBrickEdge;
  return std::pow(std::max(1.0, along), 3);
}

/// Voxel bricks become the lattice bricks that see them.
FoundBricks at_lattice(const PhiField& field, const FoundBricks& voxel_bricks) {
  constexpr int kHaloReach = 3;
  FoundBricks found;
  for (const BrickCoord brick : voxel_bricks.near_surface) {
    for_each_brick(lattice_box(field, {brick, brick}, kHaloReach),
                   [&](BrickCoord seen) { found.near_surface.push_back(seen); });
  }
  for (const BrickBox& box : voxel_bricks.inside) {
    found.inside.push_back(lattice_box(field, box, 1));
  }
  return found;
}

double bricks_in(const BrickBox& box) {
  return (box.max.x - box.min.x + 1.0) * (box.max.y - box.min.y + 1.0) *
         (box.max.z - box.min.z + 1.0);
}

double cells_in(const PhiField& field, const std::vector<BrickBox>& voxel_bricks) {
  double bricks = 0;
  for (const BrickBox& box : voxel_bricks) bricks += bricks_in(box);
  return bricks * kBrickCells / std::pow(field.spacing_voxels, 3);
}

}  // namespace

absl::Status check_inside_ends(const PhiField& field) {
  if (!(field.phi(field.volume->background) < 0)) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrFormat(
      "the background value %g is inside at iso %g, so the inside has no end; choose another "
      "iso value, or mesh both sides within a box",
      field.volume->background, field.iso));
}

void keep_domain(const BrickBox& domain, FoundBricks& found) {
  std::erase_if(found.near_surface, [&](BrickCoord b) {
    return b.x < domain.min.x || b.y < domain.min.y || b.z < domain.min.z ||
           b.x > domain.max.x + 1 || b.y > domain.max.y + 1 || b.z > domain.max.z + 1;
  });
  found.inside = {domain};
  found.inside_cells = kBrickCells * bricks_in(domain);
}

absl::StatusOr<FoundBricks> find_bricks(const PhiField& field) {
  const absl::StatusOr<std::vector<BrickCoord>> regions = regions_to_scan(field);
  if (!regions.ok()) return regions.status();

  const std::vector<RegionSigns> of_regions = signs_of_regions(field);
  FoundBricks found;
  std::mutex mutex;  // taken once a range; the order of arrival is sorted away
  for_each_range(regions->size(), 16, [&](std::size_t begin, std::size_t end) {
    SignsAround signs(field, of_regions);
    FoundBricks mine;
    for (std::size_t i = begin; i < end; ++i) scan_region(signs, (*regions)[i], mine);
    const std::lock_guard lock(mutex);
    found.near_surface.insert(found.near_surface.end(), mine.near_surface.begin(),
                              mine.near_surface.end());
    found.inside.insert(found.inside.end(), mine.inside.begin(), mine.inside.end());
  });
  const double inside_cells = cells_in(field, found.inside);
  found.inside_cells = inside_cells;
  if (!field.at_voxels()) {
    const double seen = static_cast<double>(found.near_surface.size());
    if (auto status = check_surface_bricks(seen * lattice_bricks_per_brick(field));
        !status.ok()) {
      return status;
    }
    found = at_lattice(field, found);
    found.inside_cells = inside_cells;
  }
  sort_unique(found.near_surface);
  if (auto status = check_surface_bricks(static_cast<double>(found.near_surface.size()));
      !status.ok()) {
    return status;
  }
  return found;
}

}  // namespace tet
