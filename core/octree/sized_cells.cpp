#include "core/octree/sized_cells.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/octree/cell_marker.h"
#include "core/octree/grid_marker.h"
#include "core/octree/region_shape.h"

namespace tet {
namespace {

constexpr double kChildren = 8;

absl::Status too_many_leaves(const std::string& who, double most) {
  return absl::ResourceExhaustedError(absl::StrFormat(
      "%s asks for more than %.3g leaves, the most there may be: use a larger size or a "
      "smaller region",
      who, most));
}

/// Cells by level, from one region after another.
class DemandedCells {
 public:
  DemandedCells(const PhiField& field,
                const OctreeCover& cover,
                double most,
                const Cancellation& cancellation)
      : lattice_(field.lattice_transform()),
        cover_(cover),
        left_(most),
        cancellation_(cancellation) {}

  /// False when there are too many.
  bool add(const SizingRegion& region, int level) {
    const RegionShape shape(region, lattice_);
    CellMarker marker(shape, level, left_, cancellation_);
    marker.mark(cover_.boxes);
    left_ -= marker.marked();
    if (left_ < 0) return false;
    of_level_.resize(std::max(of_level_.size(), static_cast<std::size_t>(level) + 1));
    of_level_[static_cast<std::size_t>(level)].add(marker.take());
    return true;
  }

  /// Adds the cells that a grid of sizes asks for. False when there are too many.
  bool add(const Volume& grid, int levels) {
    if (cover_.boxes.empty()) return true;
    GridMarker marker(lattice_, box_around(cover_.boxes), levels, left_, cancellation_);
    marker.mark(grid);
    left_ -= marker.marked();
    if (left_ < 0) return false;
    of_level_.resize(std::max(of_level_.size(), marker.cells().size()));
    for (std::size_t level = 0; level < marker.cells().size(); ++level) {
      of_level_[level].add(std::move(marker.cells()[level]));
    }
    return std::ranges::all_of(marker.large(), [&](const SizingRegion& region) {
      return add(region, level_of_size(region.size, lattice_.voxel_size, levels) + 1);
    });
  }

  std::vector<CellSet> take() {
    std::vector<CellSet> sets;
    for (CellSetBuilder& cells : of_level_) sets.push_back(cells.take());
    return sets;
  }

 private:
  const VoxelTransform lattice_;
  const OctreeCover& cover_;
  double left_;
  const Cancellation& cancellation_;
  std::vector<CellSetBuilder> of_level_;
};

}  // namespace

int levels_of(const Sizing& sizing, double spacing, int levels) noexcept {
  if (sizing.coarsest) levels = level_of_size(*sizing.coarsest, spacing, levels);
  const double background = sizing.grid ? sizing.grid->volume->background : 0;
  return background > 0 ? level_of_size(background, spacing, levels) : levels;
}

absl::StatusOr<LeafRules> leaf_rules(const Sizing& sizing,
                                     const PhiField& field,
                                     const OctreeCover& cover,
                                     int levels,
                                     double most_leaves,
                                     const Cancellation& cancellation) {
  LeafRules rules{.max_levels = levels};
  const double spacing = field.lattice_transform().voxel_size;
  constexpr double kRounding = 1e-9;
  rules.layers = static_cast<int>(std::ceil(1 / sizing.growth - kRounding));
  DemandedCells demanded(field, cover, most_leaves / kChildren, cancellation);
  for (std::size_t i = 0; i < sizing.regions.size(); ++i) {
    const SizingRegion& region = sizing.regions[i];
    const int level = level_of_size(region.size, spacing, levels) + 1;
    if (level > levels) continue;
    if (const auto* shell = std::get_if<ShellRegion>(&region.shape)) {
      rules.shells.push_back({level, shell->depth / spacing});
    } else if (!demanded.add(region, level)) {
      return too_many_leaves(absl::StrCat(kSizingField, ".regions[", i, "].size ", region.size),
                             most_leaves);
    }
  }
  if (sizing.grid && !demanded.add(*sizing.grid->volume, levels)) {
    return too_many_leaves(absl::StrCat(kSizingField, ".grid \"", sizing.grid->name, "\""),
                           most_leaves);
  }
  rules.refined = demanded.take();
  return rules;
}

}  // namespace tet
