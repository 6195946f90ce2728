#include "core/octree/surface_sizes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include "core/base/parallel.h"
#include "core/octree/surface_probe.h"

namespace tet {
namespace {

constexpr std::size_t kBricksPerRange = 8;

/// Returns the cells of a sampled brick whose corners are not all on one side.
BrickMask cells_at_surface(const BrickSamples& samples) noexcept {
  BrickMask cells;
  for_each_bit(BrickMask::all(), [&](int x, int y, int z) {
    int inside = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int at = halo_index(x + (corner >> 2), y + (corner >> 1 & 1), z + (corner & 1));
      inside += samples.corner[static_cast<std::size_t>(at)] < 0 ? 1 : 0;
    }
    if (inside != 0 && inside != 8) cells.set(x, y, z);
  });
  return cells;
}

/// How long leaves may be at places of the surface, finest spacings.
class AllowedLength {
 public:
  /// `longest` is what leaves may be where nothing asks for less.
  AllowedLength(const Sizing& sizing, SurfaceProbe probe, double spacing, double longest)
      : probe_(std::move(probe)),
        chord_error_(sizing.chord_error ? *sizing.chord_error / spacing : 0),
        leaves_across_(sizing.leaves_across),
        longest_(longest) {}

  double at(const VoxelPoint& place) noexcept {
    probe_.visit(place);
    double length = longest_;
    if (chord_error_ > 0) {
      // An arc of curvature k departs from a chord of length c by k * c^2 / 8.
      const double curvature = probe_.curvature();
      if (curvature > 0) length = std::min(length, std::sqrt(8 * chord_error_ / curvature));
    }
    if (leaves_across_ > 0) {
      length = std::min(length, probe_.thickness(leaves_across_ * length) / leaves_across_);
    }
    return length;
  }

 private:
  SurfaceProbe probe_;
  const double chord_error_;  ///< finest spacings; 0: any
  const int leaves_across_;
  const double longest_;
};

/// Cells of every level that are too long for some finest cell of one brick. That lies in one
/// brick of each level.
class TooLongCells {
 public:
  TooLongCells(BrickCoord brick, int levels)
      : brick_(brick), of_level_(static_cast<std::size_t>(levels) + 1) {}

  void add(int x, int y, int z, int level) {
    of_level_[static_cast<std::size_t>(level)].set(
        up(brick_.x, x, level) & 7, up(brick_.y, y, level) & 7, up(brick_.z, z, level) & 7);
  }

  void move_to(std::vector<CellSetBuilder>& cells) const {
    for (std::size_t l = 1; l < of_level_.size(); ++l) {
      if (!of_level_[l].any()) continue;
      const auto level = static_cast<int>(l);
      cells[l].add({up(brick_.x, 0, level) >> 3, up(brick_.y, 0, level) >> 3,
                    up(brick_.z, 0, level) >> 3},
                   of_level_[l]);
    }
  }

 private:
  static std::int32_t up(std::int32_t brick, int cell, int level) {
    return static_cast<std::int32_t>((std::int64_t{kBrickEdge} * brick + cell) >> level);
  }

  BrickCoord brick_;
  std::vector<BrickMask> of_level_;
};

/// How long leaves may be, finest spacings: in a domain lies no cell that is longer than it.
double longest_leaf(int levels, const std::optional<BrickBox>& domain) {
  const double longest = std::ldexp(1, levels);
  if (!domain) return longest;
  const auto& [min, max] = *domain;
  const double bricks =
      std::max({1.0 * max.x - min.x, 1.0 * max.y - min.y, 1.0 * max.z - min.z}) + 1;
  return std::min(longest, kBrickEdge * bricks);
}

}  // namespace

std::vector<CellSet> surface_cells_to_refine(const Sizing& sizing,
                                             const PhiField& field,
                                             const std::vector<BrickCoord>& bricks,
                                             const std::optional<BrickBox>& domain,
                                             int levels,
                                             const Cancellation& cancellation) {
  std::vector<std::vector<CellSetBuilder>> of_range(bricks.size());
  const std::optional<StoredExtent> extent = stored_extent_amid_inside(field);
  const double longest = longest_leaf(levels, domain);
  for_each_range(bricks.size(), kBricksPerRange, [&](std::size_t begin, std::size_t end) {
    PhiSampler sampler(field);
    SurfaceProbe probe(field, extent);
    probe.stop_when(cancellation);
    AllowedLength allowed(sizing, std::move(probe), field.lattice_transform().voxel_size,
                          longest);
    const auto samples = std::make_unique_for_overwrite<BrickSamples>();
    auto& cells = of_range[begin];
    cells.resize(static_cast<std::size_t>(levels) + 1);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      const BrickCoord b = bricks[i];
      sampler.sample(b, *samples);
      TooLongCells too_long(b, levels);
      for_each_bit(cells_at_surface(*samples), [&](int x, int y, int z) {
        const auto middle = [](std::int32_t brick, int cell) {
          return double{kBrickEdge} * brick + cell + 0.5;
        };
        const double length = allowed.at({middle(b.x, x), middle(b.y, y), middle(b.z, z)});
        if (length >= longest) return;
        // Leaves of level l are 2^l spacings long; what is longer follows by itself.
        const int level = length < 1 ? 1 : std::ilogb(length) + 1;
        if (level <= levels) too_long.add(x, y, z, level);
      });
      too_long.move_to(cells);
    }
  });
  std::vector<CellSet> sets(static_cast<std::size_t>(levels) + 1);
  for (int level = 1; level <= levels; ++level) {
    CellSetBuilder all;
    for (auto& cells : of_range) {
      if (!cells.empty()) all.add(std::move(cells[static_cast<std::size_t>(level)]));
    }
    sets[static_cast<std::size_t>(level)] = all.take();
  }
  return sets;
}

}  // namespace tet
