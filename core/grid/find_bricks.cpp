#include "core/grid/find_bricks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <mutex>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"

namespace tet {
namespace {

/// Signs that occur in a brick. Exact zeros count as outside: they touch the surface either
/// way.
enum Signs : std::uint8_t { kNone = 0, kInside = 1, kOutside = 2, kBoth = 3 };

Signs signs_of(const PhiField& field, ValueRange range) noexcept {
  const float lowest = field.negated() ? field.phi(range.max) : field.phi(range.min);
  const float highest = field.negated() ? field.phi(range.min) : field.phi(range.max);
  return static_cast<Signs>((lowest < 0 ? kInside : kNone) | (highest < 0 ? kNone : kOutside));
}

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
    std::sort(regions.begin(), regions.end());
    regions.erase(std::unique(regions.begin(), regions.end()), regions.end());
  }
  std::sort(regions.begin(), regions.end());
  regions.erase(std::unique(regions.begin(), regions.end()), regions.end());
  return regions;
}

/// Signs of a region's 16^3 bricks with one more brick on every side.
class RegionSigns {
 public:
  static constexpr int kEdge = kRegionBricks + 2;

  void read(const PhiField& field, VolumeReader& reader, BrickCoord region) noexcept {
    // Part by part of the 27 regions that the halo reaches into: entering one is what costs.
    for (int part = 0; part < 27; ++part) {
      const Span x(part / 9 - 1), y(part / 3 % 3 - 1), z(part % 3 - 1);
      for_each_brick(
          {
              {x.first, y.first, z.first},
              { x.last,  y.last,  z.last}
      },
          [&](BrickCoord at) {
            const auto brick =
                reader.brick({region.x + at.x, region.y + at.y, region.z + at.z});
            own_[index(at.x, at.y, at.z)] = signs_of(field, brick.range);
          });
    }
    around_ = own_;
    for (const std::size_t step :
         {std::size_t{1}, std::size_t{kEdge}, std::size_t{kEdge * kEdge}}) {
      const auto before = around_;
      for (std::size_t i = step; i + step < around_.size(); ++i) {
        around_[i] = static_cast<std::uint8_t>(before[i - step] | before[i] | before[i + step]);
      }
    }
  }

  bool inside(int x, int y, int z) const noexcept {
    return (own_[index(x, y, z)] & kInside) != 0;
  }
  bool near_surface(int x, int y, int z) const noexcept {
    return around_[index(x, y, z)] == kBoth;
  }

 private:
  /// The bricks along one axis that lie in the region before (-1), itself (0) or the one after
  /// (1).
  struct Span {
    int first, last;
    explicit Span(int part)
        : first(part < 0 ? -1 : part * kRegionBricks),
          last(part == 0 ? kRegionBricks - 1 : first) {}
  };

  static std::size_t index(int x, int y, int z) noexcept {
    return static_cast<std::size_t>(((x + 1) * kEdge + y + 1) * kEdge + z + 1);
  }
  std::array<std::uint8_t, kEdge * kEdge * kEdge> own_, around_;
};

/// True when the region and the 26 around it hold nothing but one sign.
bool one_sign_around(const PhiField& field,
                     VolumeReader& reader,
                     BrickCoord region,
                     Signs& sign) {
  int seen = kNone;
  bool constant = true;
  for_each_region_around(region, [&](BrickCoord around) {
    float value = 0;
    constant = constant && reader.constant_region(around, value);
    seen |= signs_of(field, {value, value});
  });
  if (!constant) return false;
  sign = static_cast<Signs>(seen);
  return sign != kBoth;
}

void scan_region(const PhiField& field,
                 VolumeReader& reader,
                 RegionSigns& signs,
                 BrickCoord region,
                 FoundBricks& found) {
  Signs sign = kNone;
  if (one_sign_around(field, reader, region, sign)) {
    constexpr int kLast = kRegionBricks - 1;
    const BrickCoord last{region.x + kLast, region.y + kLast, region.z + kLast};
    if (sign == kInside) found.inside.push_back({region, last});
    return;
  }
  signs.read(field, reader, region);
  for (int x = 0; x < kRegionBricks; ++x) {
    for (int y = 0; y < kRegionBricks; ++y) {
      for (int z = 0; z < kRegionBricks; ++z) {
        const BrickCoord brick{region.x + x, region.y + y, region.z + z};
        if (signs.near_surface(x, y, z)) found.near_surface.push_back(brick);
        if (signs.inside(x, y, z)) found.inside.push_back({brick, brick});
      }
    }
  }
}

void sort_unique(std::vector<BrickCoord>& bricks) {
  std::sort(bricks.begin(), bricks.end());
  bricks.erase(std::unique(bricks.begin(), bricks.end()), bricks.end());
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

double cells_in(const PhiField& field, const std::vector<BrickBox>& voxel_bricks) {
  double bricks = 0;
  for (const BrickBox& box : voxel_bricks) bricks += std::pow(box.max.x - box.min.x + 1, 3);
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
  found.inside_cells = kBrickCells * (domain.max.x - domain.min.x + 1.0) *
                       (domain.max.y - domain.min.y + 1.0) *
                       (domain.max.z - domain.min.z + 1.0);
}

absl::StatusOr<FoundBricks> find_bricks(const PhiField& field) {
  const absl::StatusOr<std::vector<BrickCoord>> regions = regions_to_scan(field);
  if (!regions.ok()) return regions.status();

  FoundBricks found;
  std::mutex mutex;  // taken once a range; the order of arrival is sorted away
  for_each_range(regions->size(), 16, [&](std::size_t begin, std::size_t end) {
    VolumeReader reader(*field.volume);
    RegionSigns signs;
    FoundBricks mine;
    for (std::size_t i = begin; i < end; ++i) {
      scan_region(field, reader, signs, (*regions)[i], mine);
    }
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
